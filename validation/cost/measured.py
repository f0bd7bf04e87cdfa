"""Seconds and errors of every model, and of tamaas, on the scenes."""

from __future__ import annotations

import math
import statistics
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.models.model import Model
from validation.cost.peers import Answer, Grid, installed, solve_with_tamaas
from validation.cost.times import renewed, timed
from validation.scenes.costs import MODELS, SCENES, reference, scattered

PEER = "tamaas"

# Relative errors of A0 at which times are compared with those of other codes. With the last one the grid of
# another code is not refined any further.
PEER_ERRORS = (5e-3, 1e-3)

# Time after which it is not refined any further, whatever the error [s].
PATIENCE = 5.0

# Loads of a curve; fewer above this number of asperities, where each load takes seconds.
LOADS, FEW_LOADS, MANY = 100, 3, 2000

# Models that take longer for one load [s] resolve the contacts: their curves are not timed.
RESOLVING = 0.1


@dataclass(frozen=True)
class Point:
    """A model or another code with one setting on a scene: two times [s] and two relative errors.

    cold: one load of a new surface; per_load: each load of a curve, nan where it is not measured. The errors
    are those of A0 at the load of the scene, and of P at the separation of the reference; nan where they are
    not measured. cell: of the grid of another code [mm]. solved: the model that was solved.
    """

    line: str
    setting: str
    cold: float
    per_load: float
    area_error: float
    load_error: float
    cell: float = 0.0
    solved: Model | None = None


@cache
def models(scene: str) -> tuple[Point, ...]:
    """Measure every model on a scene."""
    _compile(scene)
    return tuple(
        _measured(scene, line, setting, model)
        for line, choices in SCENES[scene].lines.items()
        for setting, model in choices.items()
    )


@cache
def peers(scene: str) -> tuple[Point, ...]:
    """Measure tamaas, if it is installed, on finer and finer grids."""
    return tuple(_refined(scene)) if installed() else ()


def fastest_within(found: tuple[Point, ...], line: str, error: float) -> Point | None:
    """Return the fastest point of a line with at most an error of A0, if there is one."""
    chosen = [each for each in found if each.line == line and each.area_error <= error]
    return min(chosen, key=lambda each: each.cold, default=None)


def _compile(scene: str) -> None:
    """Solve a scene of the same kind that is not timed, so that everything is compiled."""
    surface = SCENES[scene].surface
    other = scattered(MANY + 500) if surface.count > MANY else surface.replaced(height=surface.height + 1e-6)
    load = SCENES[scene].newtons * other.count / surface.count
    for choices in SCENES[scene].lines.values():
        model = next(iter(choices.values()))
        found = mf.equilibrium(other, model, load=load)
        mf.equilibrium(other, model, separation=found.separation)
        if not isinstance(model, mf.BoundaryElements):
            mf.friction_law(other, model, load=load * np.array([0.5, 1.0]))


def _measured(scene: str, line: str, setting: str, model: Model) -> Point:
    known, exact = SCENES[scene], reference(scene)
    surface, load = known.surface, known.newtons
    cold, found = timed(lambda run: mf.equilibrium(renewed(surface, run), model, load=load))
    load_error = per_load = math.nan
    if known.finest or line in MODELS:
        other = mf.equilibrium(surface, model, separation=exact.separation)
        load_error = abs(other.load / load - 1.0)
    solved = found.model
    resolved = isinstance(solved, mf.BoundaryElements)
    if (line in MODELS and surface.count > MANY) or (not resolved and cold < RESOLVING):
        count = FEW_LOADS if surface.count > MANY else LOADS
        loads = load * np.arange(1, count + 1) / count
        per_load = timed(lambda _: mf.friction_law(surface, model, load=loads))[0] / count
    area_error = abs(found.area / exact.area - 1.0)
    if not known.finest:
        # the reference is the state of order 3, whose own estimates stand for its errors
        area_error = max(area_error, exact.area_uncertainty)
        load_error = max(load_error, exact.load_uncertainty)
    return Point(line, setting, cold, per_load, area_error, load_error, solved=solved)


def _refined(scene: str) -> list[Point]:
    """Measure tamaas until its own area is within the error, or for too long.

    The time is that of its solver alone. The area by second moments, which this project computes from its
    pressures, is a line of its own with the same times. Merged contacts have no such moments.
    """
    known, exact = SCENES[scene], reference(scene)
    found: list[Point] = []
    for cell in known.peer_cells:
        grid = Grid(known.surface, cell)
        answers: list[Answer] = []
        timed(lambda _, grid=grid, to=answers: to.append(solve_with_tamaas(grid, known.newtons)))
        seconds, answer = statistics.median(each.seconds for each in answers), answers[-1]
        # linear in the separation: the change is a few micrometres at most
        load_error = abs(exact.stiffness * (answer.separation - exact.separation))
        readings = {PEER: answer.area, f"{PEER}, second moments": answer.moments}
        errors = {line: abs(area / exact.area - 1.0) for line, area in readings.items()}
        for line, error in [*errors.items()][: 1 if known.merged else 2]:
            setting = f"{1e3 * cell:g} µm"
            found.append(Point(line, setting, seconds, math.nan, error, load_error, cell))
        if errors[PEER] <= PEER_ERRORS[-1] or seconds > PATIENCE:
            break
    return found
