"""Seconds and errors of every model, and of tamaas, on six surfaces from sparse to merged contacts."""

from __future__ import annotations

import math
import os
import statistics
from collections.abc import Iterator
from functools import cache
from importlib.metadata import version
from itertools import pairwise
from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem.models.error import truncation
from metafem.models.model import Model
from validation.cost.peers import Grid, installed, solve_with_tamaas
from validation.methods.resolved_areas import extrapolated_area
from validation.paper.surfaces import surfaces
from validation.timing import timed

MATERIAL = mf.Material(1.36)

INDEPENDENT, ORDER_1, ORDER_3 = "Independent()", "Interacting(order=1)", "Interacting(order=3)"
AUTOMATIC, RESOLVED = "Automatic(tolerance)", "BoundaryElements(cell)"
PEER = "tamaas"

ASPERITIES: dict[str, Model] = {
    INDEPENDENT: mf.Independent(), ORDER_1: mf.Interacting(order=1), ORDER_3: mf.Interacting()
}  # fmt: skip

# Uncertainty at which the area of merged contacts is no longer refined.
MERGED_UNCERTAINTY = 1.5e-4

# Relative error of A0 with which the grid of another code is not refined any further, and the time after
# which it is not, whatever the error [s].
PEER_ERROR, PATIENCE = 1e-3, 2.0

# Loads of a curve, on the surface whose curves are timed, and the longest time of one load of such a model
# [s]: others resolve the contacts.
LOADS, CURVES, RESOLVING = 100, "paper", 0.1


class Scene(NamedTuple):
    """A surface under a load [N].

    cells: of the resolved contacts that are timed [mm]. finest: three cells, each half the one before, of the
    reference; none if order 3 is the reference. peer_cells: of tamaas. tolerances: of `Automatic`; smaller
    ones would resolve the contacts by more than a million cells. merged: order 3 has no solution.
    """

    title: str
    surface: mf.Surface
    load: float
    cells: tuple[float, ...] = ()
    finest: tuple[float, ...] = ()
    peer_cells: tuple[float, ...] = ()
    tolerances: tuple[float, ...] = (0.1, 1e-2, 1e-3)
    merged: bool = False


class Reference(NamedTuple):
    """A0 [mm²], separation [mm], relative uncertainties of A0 and of P there, and dP/dδ over P [1/mm]."""

    area: float
    separation: float
    area_uncertainty: float
    load_uncertainty: float
    stiffness: float


class Point(NamedTuple):
    """A model or another code with one setting on a scene: seconds and relative errors.

    cold: one load of a new surface; per_load: each load of a curve, nan where it is not measured. The errors
    are those of A0 at the load of the scene, and of P at the separation of the reference.
    """

    line: str
    setting: str
    cold: float
    per_load: float
    area_error: float
    load_error: float


def heights(count: int | tuple[int, ...]) -> np.ndarray:
    """Return 0.12 mm minus random depths, exponential with scale 0.036 mm and at most 0.12 mm."""
    return 0.12 - np.minimum(np.random.default_rng(0).exponential(0.036, count), 0.12)


def lattice(side: int, pitch: float, lift: float = 0.0) -> mf.Surface:
    """Return side × side asperities of such heights on a lattice [mm]."""
    height = lift + heights(side**2)
    return mf.Surface.square_lattice(height, (side, side), pitch, radius=0.526, material=MATERIAL)


def scattered(count: int) -> mf.Surface:
    """Return asperities at random sites within two thirds of each cell of a lattice of 1.5 mm."""
    columns = round(np.sqrt(count))
    corner = 1.5 * np.column_stack([np.arange(count) % columns, np.arange(count) // columns])
    shift = np.random.default_rng(1).uniform(-0.5, 0.5, (count, 2))
    return mf.Surface(corner + shift, heights(count), 0.526, MATERIAL)


FINEST = (0.01, 0.005, 0.0025)


@cache
def scenes() -> dict[str, Scene]:
    """Return the scenes from sparse to merged contacts, and those of many asperities."""
    unit = MATERIAL.composite_modulus
    return {
        "sparse": Scene(
            "lattice of 20 mm, 64 asperities", lattice(8, 20.0), 0.6 * unit, (0.02, 0.01), FINEST
        ),
        "paper": Scene(
            "Fig. 4 red, 64 asperities", surfaces()["Fig. 4 red"], 0.6 * unit, (0.04, 0.02, 0.01), FINEST,
            (0.04, 0.028, 0.02, 0.014, 0.01), (0.1, 1e-2, 1e-3, 1e-4),
        ),
        "dense": Scene(
            "lattice of 0.8 mm, 64 asperities", lattice(8, 0.8), 0.75 * unit, (0.02, 0.01),
            (0.02, 0.01, 0.005), (0.04, 0.02),
        ),
        # so high that the base plane does not touch
        "merged": Scene(
            "merged contacts, 4 asperities", lattice(2, 0.2, 0.1), 0.08 * unit, (0.02, 0.01, 0.005), FINEST,
            (0.02, 0.01, 0.005), merged=True,
        ),
        "several": Scene("400 scattered asperities", scattered(400), 1.2 * unit, (0.02,), (), (0.08, 0.056)),
        "many": Scene("10,000 scattered asperities", scattered(10_000), 30.0 * unit),
    }  # fmt: skip


@cache
def reference(scene: str) -> Reference:
    """Return the state from which errors are counted.

    Where contacts can be resolved, it is extrapolated from the two finest cells, and its uncertainty is the
    larger of the change from the extrapolation before and the change from the finest cells. The area of
    merged contacts scatters more from cell to cell: it is fitted to more cells. For many asperities the
    reference is order 3 with its own estimate of the error of A0.
    """
    known = scenes()[scene]
    load = {"load": known.load}
    if not known.finest:
        found = mf.equilibrium(known.surface, mf.Interacting(), **load)
        error = truncation(known.surface, found.asperity_area, mf.HalfSpace())
        # the load at a fixed separation has a third of the error of the area at a fixed load, or less
        return Reference(found.area, found.separation, error, error, found.stiffness / known.load)
    states = [mf.equilibrium(known.surface, mf.BoundaryElements(cell), **load) for cell in known.finest]
    stiffness = states[-1].stiffness / known.load
    separation, change = _extrapolated([each.separation for each in states])
    area, area_change = _extrapolated([each.area for each in states])
    relative = area_change / area
    if known.merged:
        area, relative = extrapolated_area(known.surface, known.load, MERGED_UNCERTAINTY)
    return Reference(area, separation, relative, stiffness * change, stiffness)


def _extrapolated(values: list[float]) -> tuple[float, float]:
    """Return the limit of a sequence whose error falls to a quarter in each step, and its uncertainty."""
    before, last = ((4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(values))
    return last, max(abs(last - before), abs(last - values[-1]))


@cache
def points(scene: str) -> tuple[Point, ...]:
    """Measure every model on a scene, and tamaas if it is installed."""
    known, models = scenes()[scene], {(line, ""): model for line, model in ASPERITIES.items()}
    if known.merged:
        del models[ORDER_3, ""]
    models |= {(AUTOMATIC, f"{each:g}"): mf.Automatic(each) for each in known.tolerances}
    models |= {(RESOLVED, f"{1e3 * cell:g} µm"): mf.BoundaryElements(cell) for cell in known.cells}
    found = [_measured(scene, *names, model) for names, model in models.items()]
    return (*found, *_peer(scene)) if installed() else tuple(found)


def machine() -> str:
    """Return what the times depend on."""
    versions = [f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", *[PEER] * installed())]
    return f"{os.cpu_count()} processor cores with {', '.join(versions)}"


def _renewed(surface: mf.Surface, run: int) -> mf.Surface:
    """Return the surface with sites moved by parts in 10⁹, for which nothing is kept from other calls."""
    return surface.replaced(position=surface.position * (1.0 + 1e-9 * (run + 1)))


def _measured(scene: str, line: str, setting: str, model: Model) -> Point:
    known, exact = scenes()[scene], reference(scene)
    surface, load = known.surface, known.load
    # the first call, which is not timed, may compile
    other = mf.equilibrium(surface, model, separation=exact.separation) if line in ASPERITIES else None
    cold, (*_, found) = timed(lambda run: mf.equilibrium(_renewed(surface, run), model, load=load))
    per_load = math.nan
    if scene == CURVES and cold < RESOLVING:
        loads = load * np.arange(1, LOADS + 1) / LOADS
        mf.friction_law(surface, model, load=loads[-2:])
        per_load = timed(lambda _: mf.friction_law(surface, model, load=loads))[0] / LOADS
    area_error = abs(found.area / exact.area - 1.0)
    if other is not None:
        load_error = abs(other.load / load - 1.0)
    else:  # linear in the separation: the change is a few micrometres at most
        load_error = abs(exact.stiffness * (found.separation - exact.separation))
    if not known.finest:
        # the reference is the state of order 3, whose own estimates stand for its errors
        area_error = max(area_error, exact.area_uncertainty)
        load_error = max(load_error, exact.load_uncertainty)
    return Point(line, setting, cold, per_load, area_error, load_error)


def _peer(scene: str) -> Iterator[Point]:
    """Measure the solver of tamaas until its own area is within the error, or for too long."""
    known, exact = scenes()[scene], reference(scene)
    for cell in known.peer_cells:
        grid = Grid(known.surface, cell)
        _, answers = timed(lambda _, grid=grid: solve_with_tamaas(grid, known.load))
        seconds, answer = statistics.median(each.seconds for each in answers), answers[-1]
        load_error = abs(exact.stiffness * (answer.separation - exact.separation))
        error = abs(answer.area / exact.area - 1.0)
        yield Point(PEER, f"{1e3 * cell:g} µm", seconds, math.nan, error, load_error)
        if error <= PEER_ERROR or seconds > PATIENCE:
            break
