"""Seconds against error in A0(P) and P(δ), for every model on six surfaces, and for tamaas."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Iterator
from importlib.metadata import version
from itertools import groupby
from pathlib import Path

import numpy as np

import metafem as mf
from metafem.drawing import MEASURED, QUIET
from validation.check import Claim, Picture, Row, below, reported
from validation.cost.peers import installed
from validation.cost.points import (
    ASPERITIES,
    AUTOMATIC,
    CURVES,
    LOADS,
    ORDER_3,
    PEER,
    RESOLVED,
    Point,
    points,
    reference,
    scenes,
)
from validation.figures import panels
from validation.numbers import powers
from validation.scenes.models import AREA_ERROR, LOAD_ERROR
from validation.sources import second_method

# It measures times, and runs alone.
TIMED = True

# Largest uncertainty of the reference.
UNCERTAINTY = 2e-4

TIMES = "median of repeated runs, rounded to 1, 2 or 5"

# Settings of the models in the table and in the rows; the others are in the picture.
SHOWN = ("", "0.001", "10 µm")

# Colour and marker of each line; all can be told apart in grey, on white and on black.
COLOURS = ("#8a8f98", "#7fb069", "#1b6f8a", "#8d6fc0", "#c8553d", MEASURED)
STYLES = dict(zip((*ASPERITIES, AUTOMATIC, RESOLVED, PEER), zip(COLOURS, "o^D*vX", strict=True), strict=True))
CHOSEN = f"{AUTOMATIC}, tolerance above"


def claim() -> Claim:
    """Errors are counted from resolved contacts on a half-space, extrapolated from three cells, for merged
    contacts from up to thirteen. For 400 and 10,000 asperities there is no such reference: the error of
    order 3 is its own estimate, and the errors of the other models are counted from order 3. tamaas is
    measured where it is installed (extra `peers`): the time is that of its solver alone, the area that which
    it reports. Measured on {cores} processor cores with {versions}.
    """
    versions = [f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", *[PEER] * installed())]
    values = {"cores": os.cpu_count(), "versions": ", ".join(versions)}
    rows = [row for scene in scenes() for row in _rows(scene)]
    return Claim("Seconds against error", rows, {"seconds against error": Picture(picture)}, values)


def _rows(scene: str) -> Iterator[Row]:
    """Compare the errors on one scene with those that the models state, and report what they cost."""
    known, exact = scenes()[scene], reference(scene)
    title = known.title
    if known.finest:
        cells = "seven to thirteen cells" if known.merged else "three cells"
        resolved = second_method(mf.BoundaryElements, f"resolved contacts extrapolated from {cells}")
        uncertain = exact.area_uncertainty
        yield below(f"{title}: uncertainty of A0 of the reference", uncertain, UNCERTAINTY, resolved)
        for each in points(scene):
            if each.line == ORDER_3:
                yield below(f"{title}: error of order 3, A0(P)", each.area_error, AREA_ERROR, resolved)
                yield below(f"{title}: error of order 3, P(δ)", each.load_error, LOAD_ERROR, resolved)
            if each.line == AUTOMATIC:  # an error below the uncertainty of the reference cannot be seen
                name = f"{title}: error of Automatic({each.setting}), A0(P)"
                yield below(name, each.area_error, max(float(each.setting), uncertain), resolved)
    for each in points(scene):
        if each.line == ORDER_3 or (scene == CURVES and each.setting in SHOWN):
            name = f"{title}: {each.line}{f', {each.setting}' * bool(each.setting)}"
            yield reported(f"{name}, one load [s]", rounded(each.cold), TIMES)
            if math.isfinite(each.per_load):
                yield reported(f"{name}, each load of a curve [s]", rounded(each.per_load), TIMES)
            own = "relative to the reference" if known.finest else "the model's own estimate"
            yield reported(f"{name}, error of A0(P)", each.area_error, own)
            yield reported(f"{name}, error of P(δ)", each.load_error, own)


def table() -> str:
    """Return the table of the models in Markdown: what each assumes, what it costs, how exact it is."""
    exact, title = reference(CURVES), scenes()[CURVES].title.partition(",")[0]
    listed = tomllib.loads(Path(__file__).with_name("models.toml").read_text("utf-8"))["model"]
    lines = [
        f"| model | assumes | one load, {scenes()[CURVES].surface.count} asperities | each of {LOADS} loads "
        f"| error in A0(P), {title} | error in P(δ) | range |",
        "|---|---|---|---|---|---|---|",
    ]
    found = {(each.line, each.setting): each for each in points(CURVES)}
    for each in listed:
        point = found[each["line"], each["setting"]]
        times = in_words(point.cold), in_words(point.per_load) if math.isfinite(point.per_load) else "–"
        unsure = exact.area_uncertainty, exact.load_uncertainty
        errors = map(percent, (point.area_error, point.load_error), unsure)
        cells = (f"`{each['name']}`", each["assumes"], *times, *errors, each["range"])
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def rounded(value: float) -> float:
    """Return a number rounded to 1, 2 or 5 times a power of ten, so that it seldom changes between runs."""
    steps = 10.0 ** np.floor(np.log10(value)) * np.array([1.0, 2.0, 5.0, 10.0])
    return float(steps[np.abs(np.log(steps / value)).argmin()])


def percent(value: float, unsure: float) -> str:
    """Return a percentage to two digits, without an exponent, or that it is below its uncertainty."""
    shown = f"{float(f'{100.0 * max(value, unsure):.2g}'):.10f}".rstrip("0").rstrip(".")
    return f"{'below ' * (value <= unsure)}{shown} %"


def in_words(seconds: float) -> str:
    """Return a time rounded to 1, 2 or 5 with its unit."""
    micro = round(1e6 * rounded(seconds), 3)
    for scale, unit in ((1e6, "s"), (1e3, "ms")):
        if micro >= scale:
            return f"{micro / scale:.0f} {unit}"
    return f"{micro:g} µs"


@panels(9.6, 6.6, 2, 3, sharex=True, sharey=True)
def picture(*axes):
    """Seconds for one load of a new surface against the error of A0, one panel for each scene. Lines join
    finer cells or smaller tolerances; rings are what Automatic chose, with its tolerances. Dotted line: the
    uncertainty of the reference; smaller errors are drawn on it.
    """
    handles = {}
    for ax, scene in zip(axes, scenes(), strict=True):
        _panel(ax, scene)
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    for ax in axes[3:]:
        ax.set_xlabel("seconds for one load of a new surface")
    for ax in axes[::3]:
        ax.set_ylabel("relative error of A0")
    shown = [label for label in (*STYLES, CHOSEN) if label in handles]
    place = {"frameon": False, "fontsize": 9, "ncols": 4, "loc": "outside lower center"}
    axes[0].figure.legend([handles[label] for label in shown], shown, **place)


def _panel(ax, scene: str) -> None:
    """Draw one scene; errors below the uncertainty of its reference are drawn at the uncertainty."""
    least, every = reference(scene).area_uncertainty, points(scene)

    def places(of: list[Point]) -> tuple[list[float], list[float]]:
        return [each.cold for each in of], [max(each.area_error, least) for each in of]

    ax.plot(*places([each for each in every if each.line in ASPERITIES]), color=QUIET, lw=1, zorder=1)
    for line, (colour, marker) in STYLES.items():
        if of := [each for each in every if each.line == line]:
            ax.plot(*places(of), marker=marker, ms=6, lw=1, color=colour, label=line)
    colour, marker = STYLES[AUTOMATIC]
    chosen_by = [each for each in every if each.line == AUTOMATIC]
    for _, group in groupby(chosen_by, key=lambda each: each.solved):
        chosen = list(group)
        x, y = places(chosen)
        ax.plot(x, y, marker=marker, ms=12, mew=1.3, lw=0, mfc="none", color=colour, label=CHOSEN)
        ends = dict.fromkeys(powers(f"{float(each.setting):.0e}") for each in (chosen[0], chosen[-1]))
        side = "left" if len(ends) == 1 or max(x) < 1.0 else "right"  # where the panel has room
        ax.annotate(" … ".join(ends), (max(x), max(y)), (0, 8), textcoords="offset points", fontsize=8.5,
                    ha=side, color=colour)  # fmt: skip
    ax.axhline(least, color="grey", lw=0.8, ls=":")
    ax.set_title(scenes()[scene].title, fontsize=10)
    ax.loglog()
