"""The equations of third order, solved a second time in numpy and scipy."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.models.interacting.elastic import DENSE_LIMIT
from validation.check import Claim, Picture, Row, below
from validation.figures import panels
from validation.methods import third_order
from validation.sources import second_method

MODULUS, RATIO, LOAD = 1.36, 0.5, 0.25

# A layer so thin that its self terms count [mm].
THIN = 1.0

# Rounding of two solutions; the kernel's tables replace the slope term of the lightest loads of other caps,
# which is infinite at a flat summit; and the tolerance of fast sums.
ROUNDING, TABLES, FAST = 1e-10, 1e-5, 1e-8

SOLVED = second_method(third_order.solved, "the equations in numpy, by the root finder of scipy")


@dataclass(frozen=True)
class Scene:
    """Nine asperities, or nine high ones among many, anywhere or on a lattice, with a cap and a substrate."""

    exponent: float = 2.0
    layer: bool = False
    many: bool = False
    lattice: bool = False

    @property
    def limit(self) -> float:
        """Largest relative difference that is allowed."""
        return FAST if self.many else TABLES if self.exponent != 2.0 else ROUNDING

    @property
    def surface(self) -> mf.Surface:
        """Sites within 0.2 mm of a lattice, heights within 20 µm, and radii within a tenth of the paper's."""
        rng = np.random.default_rng(0)
        site = 1.5 * np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0)), axis=-1).reshape(-1, 2)
        position, height = site + rng.uniform(-0.2, 0.2, (9, 2)), 0.1 + rng.uniform(0.0, 0.02, 9)
        radius = 0.526 * rng.uniform(0.9, 1.1, 9)
        if self.many:  # the others stay open
            side = int(np.sqrt(DENSE_LIMIT)) + 2
            grid = np.stack(np.meshgrid(*[np.arange(float(side))] * 2), axis=-1).reshape(-1, 2)
            rest = np.flatnonzero((grid > 2.0).any(axis=1))
            beside = rng.uniform(-0.2, 0.2, (len(rest), 2))
            position = np.concatenate([position, 1.5 * grid[rest] + beside])
            if self.lattice:
                position = 1.5 * np.rint(position / 1.5)
            height = np.append(height, np.full(len(rest), -0.1))
            radius = np.append(radius, np.full(len(rest), 0.526))
        material = mf.Material(MODULUS, RATIO)
        return mf.Surface(position, height, radius, material, block=mf.Block(20.0, 20.0, THIN))

    @property
    def model(self) -> mf.Interacting:
        """Interaction of third order with the cap and the substrate."""
        law = mf.Hertz() if self.exponent == 2.0 else mf.Elastic(mf.Power(self.exponent))
        return mf.Interacting(3, mf.BondedLayer() if self.layer else mf.HalfSpace(), law)

    def second(self) -> tuple[float, np.ndarray]:
        """Return approach [mm] and roots of A/pi (9,) [mm] by the second method."""
        surface = self.surface
        caps = third_order.Caps(surface.radius[:9], self.exponent)
        on = third_order.fields(surface.position[:9], (THIN, RATIO) if self.layer else None)
        return third_order.solved(caps, on, surface.gap[:9], LOAD / MODULUS)


SCENES = {
    "paraboloids": Scene(),
    "paraboloids, layer": Scene(layer=True),
    "quartic caps": Scene(4.0),
    "quartic caps, layer": Scene(4.0, layer=True),
    "paraboloids on a lattice of 2,116 sites": Scene(many=True, lattice=True),
    "paraboloids at 2,116 irregular sites": Scene(many=True),
}


@cache
def state(name: str) -> mf.ContactState:
    """Return the equilibrium by the package."""
    scene = SCENES[name]
    return mf.equilibrium(scene.surface, scene.model, load=LOAD)


def claim() -> Claim:
    """Interaction of third order adds to the displacement by point loads the size of each contact, the
    curvature and the slope of its neighbours' field. These equations are written out a second time without
    the package: fields of point loads and of the layer's Hankel integral by quadrature, caps as sums of flat
    punches, and a general root finder. Paraboloids and quartic caps of unequal radii at irregular places are
    compared on a half-space and on a thin layer, and some high asperities among 2,000 low ones, for which the
    package takes its fast sums. This judges the solution of the equations; resolved contacts judge the
    equations.
    """
    rows: list[Row] = []
    for name, scene in SCENES.items():
        found, (approach, radius) = state(name), scene.second()
        area = np.abs(found.asperity_area[:9] / (np.pi * radius**2) - 1.0).max()
        depth = abs(found.approach / approach - 1.0)
        rows += [
            below(f"{name}: largest relative difference of an area", float(area), scene.limit, SOLVED),
            below(f"{name}: relative difference of the approach", depth, scene.limit, SOLVED),
        ]  # fmt: skip
    return Claim("Equations of third order, solved twice", rows, {"Areas": Picture(_figure)})


@panels(7.0, 3.2, columns=2, sharey=True)
def _figure(*axes):
    """Change of the area of each of nine contacts against independent ones at the same load [%], over its
    place in the list: by metafem (circles) and by the second solution (dots), on a half-space and on a layer
    of 1 mm. Each dot lies within its circle.
    """
    for ax, name in zip(axes, list(SCENES)[:2], strict=True):
        scene = SCENES[name]
        alone = mf.equilibrium(scene.surface, load=LOAD).asperity_area
        place = np.arange(1, 10)
        change = 1e2 * (state(name).asperity_area / alone - 1.0)
        ax.plot(place, change, "o", mfc="none", ms=8, label="metafem")
        ax.plot(place, 1e2 * (np.pi * scene.second()[1] ** 2 / alone - 1.0), "k.", label="second solution")
        ax.set(xlabel="contact", title=name)
    axes[0].set_ylabel("change of the area [%]")
    axes[0].legend(frameon=False)
