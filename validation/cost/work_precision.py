"""Seconds against error in A0(P) and P(δ), for every model on seven surfaces, and for tamaas."""

from __future__ import annotations

import math
from collections.abc import Iterator

import metafem as mf
from metafem._kernels.newton import ON_CURVE as RESIDUAL
from validation.check import Claim, Picture, Row, below, reported
from validation.cost.ladder_picture import ladder_picture
from validation.cost.measured import PEER, PEER_ERRORS, Point, fastest_within, models, peers
from validation.cost.peers import (
    BEFORE,
    TAMAAS_TOLERANCE,
    THREADS,
    Grid,
    installed,
    next_load_with_tamaas,
)
from validation.cost.times import machine, rounded
from validation.scenes.costs import AUTOMATIC, ORDER_3, RESOLVED, SCENES, reference
from validation.scenes.models import AREA_ERROR, LOAD_ERROR
from validation.sources import second_method

# Largest uncertainty of the reference.
UNCERTAINTY = 2e-4

# The scene of the table of the models.
TABLE_SCENE = "paper"

# What stands for the errors of order 3 on a scene without a reference of its own.
OWN = "the model's own estimate; nothing independent"

RUN = "both measured in the same run"
SOLVED_BY = f"tolerance {TAMAAS_TOLERANCE:g} of tamaas, threads: {THREADS}"
WARM = f"tamaas from the pressures of {BEFORE:g} of the load, order 3 from its load before"
EXTRAPOLATED = "resolved contacts extrapolated from three cells"
MERGED = "resolved contacts extrapolated from seven to thirteen cells"
TIMES = "median of repeated runs, rounded to 1, 2 or 5"
SMALLER = "the uncertainty of the reference of this scene; the error is smaller"

# Settings of the models whose numbers are rows; the others are in the pictures.
SHOWN = ("", "0.001", "10 µm")


def measure() -> Claim:
    """Errors are counted from resolved contacts on a half-space, extrapolated from three cells, for merged
    contacts from up to thirteen. For 400 and 10,000 asperities there is no such reference: the error of
    order 3 is its own estimate, and the errors of the other models are counted from order 3.{conditions}
    {machine}
    """
    rows: list[Row] = [row for scene in SCENES for row in _errors(scene)]
    figures = {"seconds against error": Picture(ladder_picture)}
    values = {"conditions": _conditions(), "machine": machine(*[PEER] * installed())}
    return Claim("Seconds against error", [*_ratios(), *rows], figures, values)


def _errors(scene: str) -> Iterator[Row]:
    """Compare the errors on one scene with those that the models state, and report what they cost."""
    known, exact, found = SCENES[scene], reference(scene), models(scene)
    title = known.title
    order_3 = next((each for each in found if each.line == ORDER_3), None)
    if known.finest:
        resolved = second_method(mf.BoundaryElements, MERGED if known.merged else EXTRAPOLATED)
        yield below(f"{title}: uncertainty of A0 of the reference",
                    exact.area_uncertainty, UNCERTAINTY, resolved)  # fmt: skip
        if order_3:
            yield below(f"{title}: error of order 3, A0(P)", order_3.area_error, AREA_ERROR, resolved)
            yield below(f"{title}: error of order 3, P(δ)", order_3.load_error, LOAD_ERROR, resolved)
        # a smaller error than the uncertainty of the reference cannot be seen
        yield from (
            below(f"{title}: error of Automatic({value:g}), A0(P)",
                  each.area_error, max(value, exact.area_uncertainty), resolved)
            for value in known.tolerances
            for each in found
            if (each.line, each.setting) == (AUTOMATIC, f"{value:g}")
        )  # fmt: skip
    for each in found:
        if each is order_3 or (scene == TABLE_SCENE and each.setting in SHOWN):
            yield from _results(scene, each)


def _results(scene: str, point: Point) -> list[Row]:
    """Report times and errors of one model on a scene."""
    known, exact = SCENES[scene], reference(scene)
    name = f"{known.title}: {_named(point)}"
    method = "relative to the reference of this scene" if known.finest else OWN
    rows: list[Row] = [reported(f"{name}, one load [s]", rounded(point.cold), TIMES)]
    for what, error, uncertainty in (
        ("A0(P)", point.area_error, exact.area_uncertainty),
        ("P(δ)", point.load_error, exact.load_uncertainty),
    ):
        if known.finest and error <= uncertainty:
            rows.append(reported(f"{name}, error of {what}: below", uncertainty, SMALLER))
        else:
            rows.append(reported(f"{name}, error of {what}", error, method))
    if math.isfinite(point.per_load):
        rows.insert(1, reported(f"{name}, each load of a curve [s]", rounded(point.per_load), TIMES))
    return rows


def _named(point: Point) -> str:
    """Return the line of a point with its setting in place of the argument."""
    return f"{point.line}, {point.setting}" if point.setting else point.line


def _ratios() -> list[Row]:
    """Report the times of tamaas over those of metafem on the surface of the paper, at equal error."""
    every = peers(TABLE_SCENE)
    return [
        row
        for line in (PEER, f"{PEER}, second moments")
        for error in PEER_ERRORS
        if (point := fastest_within(every, line, error))
        for row in _compared(point, error)
    ]


def _compared(point: Point, error: float) -> Iterator[Row]:
    """Report the times of a grid of another code over those of models with at most the same error of A0."""
    found = models(TABLE_SCENE)
    name = f"{SCENES[TABLE_SCENE].title}: A0 to {100.0 * error:g} %, time of {point.line} over that of"
    grid = f"cells of {1e3 * point.cell:g} µm, error {100.0 * point.area_error:.2g} %"
    method = f"{RUN}; {grid}, {SOLVED_BY}"
    for line in (ORDER_3, RESOLVED):
        if known := fastest_within(found, line, error):
            words = f"{name} {_named(known)}, one load of a new surface"
            yield reported(words, rounded(point.cold / known.cold, down=True), method)
    order_3 = fastest_within(found, ORDER_3, error)
    if order_3:
        grid = Grid(SCENES[TABLE_SCENE].surface, point.cell)
        seconds = next_load_with_tamaas(grid, SCENES[TABLE_SCENE].newtons)
        words = f"{name} {ORDER_3}, each load of a curve"
        yield reported(words, rounded(seconds / order_3.per_load, down=True), f"{method}; {WARM}")


def _conditions() -> str:
    """Return what holds for tamaas."""
    if not installed():
        return " tamaas is not installed, and therefore absent."
    return (
        " The area that tamaas reports is that of its cells in contact, corrected for the length of their "
        "edges; a second line shows the area that this project computes from the second moments of the same "
        "pressures. The time is that of its solver alone, at a tolerance with which it is fast: a tolerance "
        "a hundred times smaller changes the area by less than 0.2 %. "
        f"tamaas uses {THREADS} thread{'s' if THREADS > 1 else ''}, and order 3, whose residual is at "
        f"most {RESIDUAL:g}, one. Times are compared where both have at most the same error of A0: one "
        "load of a new surface with one of a new surface, and the next load of a curve with the next one."
    )
