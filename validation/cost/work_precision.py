"""Seconds against error in A0(P) and P(δ), for every model on six surfaces, and for tamaas."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

import metafem as mf
from metafem.drawing import MEASURED, QUIET
from validation.check import Claim, Picture, Row, below, reported
from validation.cost.points import (
    ASPERITIES,
    AUTOMATIC,
    CURVES,
    ORDER_3,
    PEER,
    RESOLVED,
    machine,
    points,
    reference,
    scenes,
)
from validation.figures import panels
from validation.numbers import rounded
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


def claim() -> Claim:
    """Errors are counted from resolved contacts on a half-space, extrapolated from three cells, for merged
    contacts from up to thirteen. For 400 and 10,000 asperities there is no such reference: the error of
    order 3 is its own estimate, and the errors of the other models are counted from order 3. tamaas is
    measured where it is installed (extra `peers`): the time is that of its solver alone, the area that which
    it reports. Measured on {machine}.
    """
    rows = [row for scene in scenes() for row in _rows(scene)]
    return Claim(
        "Seconds against error", rows, {"seconds against error": Picture(picture)}, {"machine": machine()}
    )


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


@panels(9.6, 6.6, 2, 3, sharex=True, sharey=True)
def picture(*axes):
    """Seconds for one load of a new surface against the error of A0, one panel for each scene. Lines join
    finer cells; stars are what Automatic chose for tolerances of 0.1, 0.01 and 0.001, on the surface of Fig.
    4 also 0.0001. Dotted line: the uncertainty of the reference; smaller errors are drawn on it.
    """
    for ax, scene in zip(axes, scenes(), strict=True):
        _panel(ax, scene)
    for ax in axes[3:]:
        ax.set_xlabel("seconds for one load of a new surface")
    for ax in axes[::3]:
        ax.set_ylabel("relative error of A0")
    found = {label: line for ax in axes for line, label in zip(*ax.get_legend_handles_labels(), strict=True)}
    place = {"frameon": False, "fontsize": 9, "ncols": 4, "loc": "outside lower center"}
    axes[0].figure.legend(found.values(), found, **place)


def _panel(ax, scene: str) -> None:
    """Draw one scene; errors below the uncertainty of its reference are drawn at the uncertainty."""
    least, every = reference(scene).area_uncertainty, pd.DataFrame(points(scene))
    every["shown"] = every.area_error.clip(lower=least)
    joined = every[every.line.isin(ASPERITIES)]
    ax.plot(joined.cold, joined.shown, color=QUIET, lw=1, zorder=1)
    for line, (colour, marker) in STYLES.items():
        of = every[every.line == line]
        size = {"ms": 12, "mfc": "none", "lw": 0} if line == AUTOMATIC else {"ms": 6, "lw": 1}
        if len(of):
            ax.plot(of.cold, of.shown, marker=marker, color=colour, label=line, **size)
    ax.axhline(least, color="grey", lw=0.8, ls=":")
    ax.set_title(scenes()[scene].title, fontsize=10)
    ax.loglog()
