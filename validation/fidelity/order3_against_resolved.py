"""Interaction by point loads and to third order against resolved contacts.

Resolved contacts are pressures on cells, without a law for a single contact. Loads and areas on several cells
are extrapolated to vanishing ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from scipy.optimize import brentq

import metafem as mf
from metafem.drawing import QUIET
from validation.check import Check, Claim, Picture, Result, above, below, near, reported
from validation.figures import panels
from validation.methods import point_load_error
from validation.scenes.models import CAP_ERROR, CAP_LOAD_ERROR, FEW_ERROR, LOAD_ERROR
from validation.sources import second_method

# The tests of this claim carry the mark "slow".
SLOW = True

# Radius of the caps and pitch of the lattice of the paper [mm].
RADIUS, PITCH = 0.526, 1.5

# Approaches [mm] of the 3 x 3 lattice: contact radii from 0.10 to 0.22 of the pitch.
APPROACHES = (0.05, 0.1, 0.15, 0.2, 0.3)
CAPS = {"sphere": mf.Elastic(mf.Sphere()), "quartic cap": mf.Elastic(mf.Power(4.0))}
CAP_APPROACH = 0.1

# Nine crowded contacts: largest radius over the pitch and over R, at the ends of the documented ranges, where
# the caps overlap on the base. The approach is that at which order 3 has this radius.
CROWDED, WIDTH = 0.319, 0.5
SHAPES = {
    "paraboloid": mf.Hertz(),
    "sphere": mf.Elastic(mf.Sphere()),
    "power 3": mf.Elastic(mf.Power(3.0)),
    "power 4": mf.Elastic(mf.Power(4.0)),
}

CROWDED_SCENE = f"3 x 3, a/r = {CROWDED:g}, {{}}"
CROWDED_CAPS = [CROWDED_SCENE.format(shape) for shape in list(SHAPES)[1:]]

# Cells per contact radius. Errors fall as the inverse square; those of neighbouring cells scatter, and the
# scatter of four about the line is the uncertainty of the extrapolated value.
CELLS = (24, 32, 42, 56)

# Least ratio of the errors of A0, a requirement of this check.
LEAST_GAIN = 4.0

# The next terms of the expansion are (a/r)² of the leading ones: 6 % at a/r = 0.24.
NEXT = 0.06

RESOLVED = second_method(mf.BoundaryElements, "resolved contacts, extrapolated to vanishing cells")
LEADING = second_method(point_load_error.area_error, "curvature of the field of point loads")
CUBIC = second_method(point_load_error.area_error, "error of point loads in proportion to (a/r)³")


@dataclass(frozen=True)
class Scene:
    """Asperities with a cap on a substrate, at an approach [mm]."""

    surface: mf.Surface
    approach: float
    contact: mf.Contact = field(default_factory=mf.Hertz)
    substrate: mf.HalfSpace | mf.BondedLayer = field(default_factory=mf.HalfSpace)

    def state(self, model: mf.Model, load: float | None = None) -> mf.ContactState:
        """Return the equilibrium at the scene's approach, or at a load."""
        given = {"approach": self.approach} if load is None else {"load": load}
        return mf.equilibrium(self.surface, model, **given)

    def expansion(self, order: int) -> mf.Interacting:
        """Return the model of an order."""
        return mf.Interacting(order, self.substrate, self.contact)


@dataclass(frozen=True)
class Errors:
    """Relative errors of load at fixed approach and of A0 at fixed load, and the uncertainty of each.

    radius: mean contact radius [mm]; ratio: largest contact radius over the distance of the nearest asperity.
    """

    load: float
    area: float
    uncertain: np.ndarray
    radius: float
    ratio: float


def lattice(approach: float, **options) -> Scene:
    """Return nine equal asperities on the paper's lattice."""
    return Scene(_nine(PITCH), approach, **options)


def _nine(pitch: float) -> mf.Surface:
    part = {"radius": RADIUS, "material": mf.Material(1.0), "block": mf.Block(20.0, 20.0, 7.2)}
    return mf.Surface.square_lattice(0.2, (3, 3), pitch, **part)


@cache
def irregular() -> Scene:
    """Return six unequal asperities at irregular distances."""
    position = [[0.0, 0.0], [0.9, 0.1], [0.3, 1.0], [-0.8, 0.5], [1.4, 1.2], [-0.3, -1.1]]
    height = [0.20, 0.17, 0.19, 0.16, 0.20, 0.18]
    radius = [0.526, 0.4, 0.6, 0.526, 0.45, 0.526]
    return Scene(mf.Surface(position, height, radius, mf.Material(1.0)), 0.1)


@cache
def crowded(shape: str) -> Scene:
    """Return nine equal asperities of a shape at the approach of the crowded contacts."""
    surface = _nine(WIDTH * RADIUS / CROWDED)
    model = mf.Interacting(contact=SHAPES[shape])

    def beyond(approach: float) -> float:
        state = mf.equilibrium(surface, model, approach=approach)
        return float(np.sqrt(state.asperity_area.max() / np.pi)) - WIDTH * RADIUS

    return Scene(surface, brentq(beyond, 0.01, 0.3, xtol=1e-9), SHAPES[shape])


@cache
def scenes() -> dict[str, Scene]:
    """Return the scenes in the order of the report."""
    found = {f"3 x 3, approach {1e3 * d:g} µm": lattice(d) for d in APPROACHES}
    found["3 x 3 on the layer, approach 200 µm"] = lattice(0.2, substrate=mf.BondedLayer())
    found["six unequal asperities"] = irregular()
    for name, cap in CAPS.items():
        found[f"3 x 3 of a {name}, approach {1e3 * CAP_APPROACH:g} µm"] = lattice(CAP_APPROACH, contact=cap)
    found |= {CROWDED_SCENE.format(shape): crowded(shape) for shape in SHAPES}
    return found


@cache
def truth(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return load [N] and A0 [mm²] of resolved contacts without cells, and their relative uncertainties."""
    scene = scenes()[name]
    widest = np.sqrt(scene.state(scene.expansion(3)).asperity_area.max() / np.pi)
    models = (mf.BoundaryElements(widest / cells, scene.substrate, scene.contact) for cells in CELLS)
    states = [scene.state(model) for model in models]
    return extrapolated(np.array([(each.load, each.area) for each in states]), CELLS)


def extrapolated(values: np.ndarray, cells: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Fit values (k, m) as a line over the squares of the cells; return its value at 0 and the scatter."""
    terms = np.column_stack([np.ones(len(cells)), np.array(cells, dtype=float) ** -2])
    line, squares, *_ = np.linalg.lstsq(terms, values / values[-1], rcond=None)
    return line[0] * values[-1], np.sqrt(squares / (len(cells) - 2))


@cache
def errors(name: str, order: int) -> Errors:
    """Return the errors of an order on a scene."""
    scene, (value, uncertain) = scenes()[name], truth(name)
    model = scene.expansion(order)
    under = scene.state(model, load=float(value[0]))
    radius = float(np.sqrt(under.asperity_area.mean() / np.pi))
    apart = np.linalg.norm(scene.surface.position[:, None] - scene.surface.position, axis=2)
    np.fill_diagonal(apart, np.inf)
    ratio = float((np.sqrt(under.asperity_area / np.pi) / apart.min(axis=1)).max())
    load, area = scene.state(model).load / value[0] - 1.0, under.area / value[1] - 1.0
    return Errors(load, area, uncertain, radius, ratio)


def claim() -> Claim:
    """Order 1 represents the neighbours of a contact by point loads, as the paper does; order 3 adds the size
    of the contacts and the curvature and slope of their fields. Resolved contacts assume nothing of this. The
    error of order 1 in A0 grows as the cube of contact radius over distance and reaches half a percent, as
    much as interaction itself changes A0(P) of some of the paper's surfaces. Order 3 is the default. Its
    error for crowded spheres and power caps is about that of paraboloids.
    """
    rows = [*_scenes(), *_rates()]
    figures = {"errors": Picture(_errors_figure)}
    return Claim("Interaction to third order against resolved contacts", rows, figures)


def _scenes() -> Iterator[Check | Result]:
    for name in scenes():
        first, third = errors(name, 1), errors(name, 3)
        crowded_caps = name in CROWDED_CAPS
        load, area = (CAP_LOAD_ERROR, CAP_ERROR) if crowded_caps else (LOAD_ERROR, FEW_ERROR)
        yield below(f"{name}, order 3: error of the load", abs(third.load), load, RESOLVED)
        yield below(f"{name}, order 3: error of A0", abs(third.area), area, RESOLVED)
        yield above(f"{name}: error of A0, order 1 over order 3",
                    abs(first.area / third.area), LEAST_GAIN, RESOLVED)  # fmt: skip
        yield reported(f"{name}, order 1: error of the load [%]", 1e2 * first.load, str(RESOLVED))
        yield reported(f"{name}, order 1: error of A0 [%]", 1e2 * first.area, str(RESOLVED))
        yield reported(f"{name}: largest a/r", third.ratio,
                       "contact radius over the distance of the nearest asperity, order 3")  # fmt: skip
        yield reported(f"{name}: uncertainty of the resolved A0 [%]", 1e2 * float(third.uncertain[1]),
                       f"scatter of {len(CELLS)} cells about a line")  # fmt: skip


def _rates() -> list[Check | Result]:
    """Compare the error of order 1 with its closed form, and fit its exponent."""
    names = list(scenes())[: len(APPROACHES)]
    found = [errors(name, 1) for name in names]
    rate = np.polyfit(np.log([each.radius for each in found]), np.log([each.area for each in found]), 1)[0]
    label = "order 1: error of A0 over its leading term"
    return [
        *(
            near(f"{name}, {label}", each.area / _leading(name), 1.0, NEXT, LEADING)
            for name, each in zip(names, found, strict=True)
        ),
        near("order 1: exponent of the error of A0 over a/r", float(rate), 3.0, 0.15, CUBIC),
    ]


@cache
def _leading(name: str) -> float:
    scene = scenes()[name]
    state = scene.state(scene.expansion(1), load=float(truth(name)[0][0]))
    apart = scene.surface.position[:, None] - scene.surface.position
    return point_load_error.area_error(np.sqrt(state.asperity_area / np.pi), np.linalg.norm(apart, axis=2))


@panels(7.0, 4.0)
def _errors_figure(ax):
    """Relative error of A0 at a given load on the 3 x 3 lattice. Order 1 (circles) follows the line, the
    closed form of its leading error with slope 3; order 3 (squares) is far below it. The bars are the
    uncertainty of the resolved contacts.
    """
    names = list(scenes())[: len(APPROACHES)]
    ratio = np.array([errors(name, 1).radius for name in names]) / PITCH
    leading = np.array([_leading(name) for name in names])
    ax.loglog(ratio, 100.0 * leading, color=QUIET, label="leading error of point loads, slope 3")
    for order, mark, colour in ((1, "o", "C1"), (3, "s", "C0")):
        area = np.array([abs(errors(name, order).area) for name in names])
        bar = np.array([errors(name, order).uncertain[1] for name in names])
        low = np.minimum(bar, 0.9 * area)  # a bar to zero has no end on a logarithmic axis
        style = {"fmt": mark, "color": colour, "label": f"order {order}"}
        ax.errorbar(ratio, 100.0 * area, 100.0 * np.array([low, bar]), **style)
    ax.set(xlabel="contact radius over pitch  a/L", ylabel="error of A0 at a given load [%]")
    ax.set_ylim(1e-4, 2.0)
    _plain_ticks(ax, (0.1, 0.15, 0.2))
    ax.legend(frameon=False, loc="lower right")


def _plain_ticks(ax, ticks: Sequence[float]) -> None:
    """Write the ticks of a logarithmic axis as plain numbers."""
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.set_xticks([], minor=True)
