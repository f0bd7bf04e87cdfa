"""The scenes on which models are timed, the models, and the state from which their errors are counted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from itertools import pairwise

import numpy as np

import metafem as mf
from metafem.models.error import truncation
from metafem.models.model import Model
from validation.methods.resolved_areas import extrapolated_area
from validation.paper.surfaces import surfaces

MATERIAL = mf.Material(1.36)

ORDER_3 = "Interacting(order=3)"
MODELS: dict[str, dict[str, Model]] = {
    "Independent()": {"": mf.Independent()},
    "Interacting(order=1)": {"": mf.Interacting(order=1)},
    ORDER_3: {"": mf.Interacting(order=3)},
}
RESOLVED, AUTOMATIC = "BoundaryElements(cell)", "Automatic(tolerance)"

# Tolerances of the rule that chooses the model. A scene is not solved with tolerances at which its contacts
# would be resolved by more than a million cells, which takes from minutes to hours.
TOLERANCES = (0.1, 1e-2, 1e-3, 1e-4, 1e-5)

# Uncertainty at which the area of merged contacts is no longer refined.
MERGED_UNCERTAINTY = 1.5e-4


@dataclass(frozen=True)
class Scene:
    """A surface under a rescaled load [mm²].

    cells: of the resolved contacts that are timed [mm], coarsest first. finest: three cells, each half the
    one before, of the reference; none if order 3 is the reference. peer_cells: of the other codes.
    tolerances: of `Automatic`. merged: whether contacts overlap, so that order 3 has no solution.
    """

    title: str
    build: Callable[[], mf.Surface]
    load: float
    cells: tuple[float, ...]
    finest: tuple[float, ...]
    peer_cells: tuple[float, ...]
    tolerances: tuple[float, ...]
    merged: bool = False

    @property
    def surface(self) -> mf.Surface:
        """The surface, built once."""
        return self.build()

    @property
    def newtons(self) -> float:
        """The load [N]."""
        return self.load * self.surface.material.composite_modulus

    @property
    def lines(self) -> dict[str, dict[str, Model]]:
        """Models by line and setting."""
        resolved: dict[str, Model] = {f"{1e3 * cell:g} µm": mf.BoundaryElements(cell) for cell in self.cells}
        automatic: dict[str, Model] = {f"{value:g}": mf.Automatic(value) for value in self.tolerances}
        every = {**MODELS, AUTOMATIC: automatic, RESOLVED: resolved}
        return {
            line: found for line, found in every.items() if found and not (self.merged and line == ORDER_3)
        }


@dataclass(frozen=True)
class Reference:
    """A0 [mm²], separation [mm], and the relative uncertainties of A0 at the load and of P at the separation.

    stiffness: dP/dδ over P [1/mm].
    """

    area: float
    separation: float
    area_uncertainty: float
    load_uncertainty: float
    stiffness: float


def heights(count: int | tuple[int, ...]) -> np.ndarray:
    """Return 0.12 mm minus random depths, exponential with scale 0.036 mm and at most 0.12 mm."""
    return 0.12 - np.minimum(np.random.default_rng(0).exponential(0.036, count), 0.12)


@cache
def dense() -> mf.Surface:
    """Return 64 asperities on a lattice of pitch 0.8 mm."""
    return mf.Surface.square_lattice(heights(64), (8, 8), 0.8, radius=0.526, material=MATERIAL)


@cache
def sparse() -> mf.Surface:
    """Return 64 asperities on a lattice of pitch 20 mm: contact radii are a hundredth of it."""
    return mf.Surface.square_lattice(heights(64), (8, 8), 20.0, radius=0.526, material=MATERIAL)


@cache
def merged() -> mf.Surface:
    """Return four asperities on a lattice of pitch 0.2 mm, so high that the base plane does not touch."""
    return mf.Surface.square_lattice(0.1 + heights(4), (2, 2), 0.2, radius=0.526, material=MATERIAL)


def scattered(count: int) -> mf.Surface:
    """Return asperities at random sites within two thirds of each cell of a lattice of 1.5 mm."""
    columns = round(np.sqrt(count))
    corner = 1.5 * np.column_stack([np.arange(count) % columns, np.arange(count) // columns])
    shift = np.random.default_rng(1).uniform(-0.5, 0.5, (count, 2))
    return mf.Surface(corner + shift, heights(count), 0.526, MATERIAL)


SCENES = {
    "sparse": Scene(
        "lattice of 20 mm, 64 asperities", sparse, 0.6,
        (0.02, 0.01, 0.005), (0.01, 0.005, 0.0025), (), TOLERANCES,
    ),
    "paper": Scene(
        "Fig. 4 red, 64 asperities", lambda: surfaces()["Fig. 4 red"], 0.6,
        (0.04, 0.02, 0.01, 0.005), (0.01, 0.005, 0.0025), (0.04, 0.028, 0.02, 0.014, 0.01), TOLERANCES[:-1],
    ),
    "dense": Scene(
        "lattice of 0.8 mm, 64 asperities", dense, 0.75,
        (0.02, 0.01), (0.02, 0.01, 0.005), (0.04, 0.02), TOLERANCES[:-2],
    ),
    "merged": Scene(
        "merged contacts, 4 asperities", merged, 0.08,
        (0.02, 0.01, 0.005, 0.0025), (0.01, 0.005, 0.0025), (0.02, 0.01, 0.005), TOLERANCES[:-2], merged=True,
    ),
    "several": Scene(
        "400 scattered asperities", cache(partial(scattered, 400)), 1.2,
        (0.02, 0.01), (), (0.08, 0.056, 0.04), TOLERANCES[:-1],
    ),
    "many": Scene(
        "10,000 scattered asperities", cache(partial(scattered, 10_000)), 30.0, (), (), (), TOLERANCES
    ),
}  # fmt: skip


@cache
def state(scene: str, model: Model) -> mf.ContactState:
    """Return the equilibrium under the load of a scene."""
    return mf.equilibrium(SCENES[scene].surface, model, load=SCENES[scene].newtons)


@cache
def reference(scene: str) -> Reference:
    """Return the state from which errors are counted.

    Where contacts can be resolved, it is extrapolated from the two finest cells, and its uncertainty is the
    larger of the change from the extrapolation before and the change from the finest cells. The area of
    merged contacts scatters more from cell to cell: it is fitted to more cells. For many asperities the
    reference is order 3 with its own estimate of the error of A0.
    """
    known = SCENES[scene]
    if not known.finest:
        found = state(scene, mf.Interacting())
        error = truncation(known.surface, found.asperity_area, mf.HalfSpace())
        # the load at a fixed separation has a third of the error of the area at a fixed load, or less
        return Reference(found.area, found.separation, error, error, found.stiffness / known.newtons)
    states = [state(scene, mf.BoundaryElements(cell)) for cell in known.finest]
    stiffness = states[-1].stiffness / known.newtons
    separation, change = extrapolated([each.separation for each in states])
    if known.merged:
        area, relative = extrapolated_area(known.surface, known.newtons, MERGED_UNCERTAINTY)
        return Reference(area, separation, relative, stiffness * change, stiffness)
    area, area_change = extrapolated([each.area for each in states])
    return Reference(area, separation, area_change / area, stiffness * change, stiffness)


def errors(scene: str, model: Model) -> tuple[float, float]:
    """Return the relative errors of a model: A0 at the load, and P at the separation of the reference."""
    known, exact = SCENES[scene], reference(scene)
    other = mf.equilibrium(known.surface, model, separation=exact.separation)
    return abs(state(scene, model).area / exact.area - 1.0), abs(other.load / known.newtons - 1.0)


def extrapolated(values: list[float]) -> tuple[float, float]:
    """Return the limit of a sequence whose error falls to a quarter in each step, and its uncertainty."""
    before, last = ((4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(values))
    return last, max(abs(last - before), abs(last - values[-1]))
