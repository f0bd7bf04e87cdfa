"""Where order 3 holds, where contacts are resolved, and where there is a refusal: maps over the scenes.

The errors are those of A0 at a given load against resolved contacts without cells, of the same scene.
"""

from __future__ import annotations

import math

import numpy as np

from metafem.drawing import QUIET
from metafem.prediction.validity import BOUND, STATED
from validation.check import Check, Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods.resolved_areas import extrapolated_area
from validation.scenes import stability_points as points
from validation.scenes.models import AREA_ERROR, FEW_ERROR, LAYER_ERROR
from validation.sources import known_input, self_consistency

# Three quarters of a minute of one core.
SLOW = True

# Part of the tolerance from which an error is compared with its estimate; smaller ones are uncertain.
CERTAIN = 0.2

# Margin of the estimate over the errors that were seen: the quarter of `metafem.models.error`.
MARGIN = 1.25

# Beginnings of the two warnings of `metafem.prediction.validity`.
OVERLAP = "contacts overlap: …"
TOO_WIDE = "the contacts are too wide for their distances or their layer: …"

# Ticks of a colour bar [%].
PERCENTS = (0.001, 0.01, 0.1, 1.0)

RESOLVED = self_consistency(extrapolated_area, "resolved contacts, extrapolated to vanishing cells")
ANNOUNCED = known_input(f"requirement: an error above {100 * BOUND:g} % is announced by a warning")


def claim() -> Claim:
    """Order 3 holds while contacts are narrow compared with their distances and with the thickness of a
    layer. Automatic estimates the errors of independent asperities, of order 1 and of order 3 from their
    contacts, takes the first within the tolerance, and resolves the contacts by cells where none is, where
    contacts overlap, and where order 3 refuses. Errors are those of A0 at a given load. Order 3 warns where
    contacts overlap (“{overlap}”) and where its estimated error exceeds {bound:g} % (“{wide}”), and notes an
    error above {stated:g} %. For a smaller tolerance use Automatic.{refusal}
    """
    pairs = [points.crowded(width, spread) for spread in points.SPREADS for width in points.WIDTHS]
    layers = [points.on_layer(width, ratio) for ratio in points.RATIOS for width in points.LAYERS]
    every = [*pairs, *layers, *(points.unequal(ratio) for ratio in points.RADII), points.equal()]
    refusals = [
        f" On a layer thinner than the contacts order 3 refuses: “{p.refusal}”." for p in every if p.refusal
    ]
    figures = {
        "crowded contacts": Picture(_crowded_figure),
    }
    values = {
        "overlap": OVERLAP, "wide": TOO_WIDE, "bound": 100.0 * BOUND, "stated": 100.0 * STATED,
        "refusal": next(iter(refusals), ""),
    }  # fmt: skip
    title = "Maps of the errors: where order 3 holds, and what Automatic chooses"
    return Claim(title, [*_checks(every, pairs), *_results(every)], figures, values)


def _checks(every: list[points.Point], pairs: list[points.Point]) -> list[Check]:
    """Compare the errors with those that the models state."""
    solved = [point for point in every if not point.refusal]
    inside = [point for point in pairs if point.ratio <= points.COMPARED]
    narrow = [points.on_layer(width, ratio) for width in points.LAYERS if width <= 0.3
              for ratio in points.RATIOS]  # fmt: skip
    least = CERTAIN * points.TOLERANCE
    known = [p for p in solved if math.isfinite(p.estimate) and _beyond(p.third, p) > least]
    silent = [point for point in solved if abs(point.third) > BOUND and not point.warned]
    return [
        below(f"Automatic({points.TOLERANCE:g}): largest error of A0",
              max(_beyond(point.automatic, point) for point in every), points.TOLERANCE, RESOLVED),
        below(f"order 3 up to a/r = {points.COMPARED:g} on the half-space, nine contacts: error of A0",
              max(_beyond(point.third, point) for point in inside), FEW_ERROR, RESOLVED),
        below(f"order 3, {points.SIDE**2} equal contacts at a/r = {points.equal().ratio:.2g}: error of A0",
              _beyond(points.equal().third, points.equal()), AREA_ERROR, RESOLVED),
        below("order 3 up to a/t = 0.3 on a layer: largest error of A0",
              max(_beyond(point.third, point) for point in narrow), LAYER_ERROR, RESOLVED),
        below(f"order 3: largest error of A0 over its estimate, of errors above {1e2 * least:.2g} %",
              max((_beyond(p.third, p) / p.estimate for p in known), default=0.0), 1.0 / MARGIN, RESOLVED),
        near(f"order 3: scenes with an error above {100 * BOUND:g} % and no warning",
             len(silent), 0, 0, ANNOUNCED),
    ]  # fmt: skip


def _beyond(error: float, point: points.Point) -> float:
    """Return the size of an error without the uncertainty of the resolved contacts."""
    return max(abs(error) - point.uncertainty, 0.0)


def _results(every: list[points.Point]) -> list[Row]:
    resolved = sum(point.resolved for point in every)
    refused = sum(bool(point.refusal) for point in every)
    return [
        reported("scenes", len(every),
                 "9 or 64 contacts on a half-space, one on a layer, two of unequal radii"),
        reported(f"order 3, {points.SIDE**2} equal contacts: error of A0 [%]", 1e2 * points.equal().third,
                 f"uncertainty {1e2 * points.equal().uncertainty:.2g} %"),
        reported("scenes in which Automatic chose resolved contacts", resolved, "in the others asperities"),
        reported("scenes that order 3 refuses", refused, "Automatic resolves the contacts there"),
        reported("largest uncertainty of the resolved contacts", max(point.uncertainty for point in every),
                 "95 % confidence interval of a fit over five to seven sizes of the cells"),
        *(
            reported(f"two radii, 1 to {r:g}: error of order 3", points.unequal(r).third, str(RESOLVED))
            for r in points.RADII
        ),
    ]  # fmt: skip


def _percent(error: float) -> float:
    """Return the size of an error in percent, at least the smallest one that is shown."""
    return max(1e2 * abs(error), PERCENTS[0])


@panels(9.0, 3.6, columns=2)
def _crowded_figure(left, right):
    """Left: error of A0 by order 3 for nine contacts on a half-space; a/L is the radius of the tallest
    contact without interaction over the pitch of the lattice, and the spread of the heights is that over the
    indentation of the tallest. Errors below 0.001 % are shown as 0.001 %. A: Automatic takes an asperity
    model; R: it resolves the contacts. Right: the error of what Automatic chose stays below its tolerance
    (line), also where contacts merge (a/L above 0.5). In the text above, a/r is the radius of a contact in
    equilibrium over the distance r of a neighbour.
    """
    rows = [[points.crowded(width, spread) for width in points.WIDTHS] for spread in points.SPREADS]
    error = np.array([[_percent(point.third) for point in row] for row in rows])
    drawn = left.pcolormesh(
        error, cmap="viridis", norm="log", vmin=PERCENTS[0], vmax=PERCENTS[-1], edgecolors="white",
        label="error of order 3 [%]",
    )  # fmt: skip
    for i, row in enumerate(rows):
        for j, point in enumerate(row):
            mark = f"{error[i, j]:.2g} %\n{'R' if point.resolved else 'A'}"
            colour = "black" if error[i, j] > 0.1 else "white"
            left.text(j + 0.5, i + 0.5, mark, ha="center", va="center", fontsize=7, color=colour)
    left.set_xticks(np.arange(len(points.WIDTHS)) + 0.5, [f"{width:g}" for width in points.WIDTHS])
    left.set_yticks(np.arange(len(points.SPREADS)) + 0.5, [f"{spread:g}" for spread in points.SPREADS])
    left.set(xlabel="a/L", ylabel="spread of the heights over the indentation")
    bar = left.figure.colorbar(drawn, ax=left, label="error of order 3 [%]", extend="max")
    bar.set_ticks(PERCENTS, labels=[f"{each:g}" for each in PERCENTS])
    bar.minorticks_off()
    for row, spread, mark in zip(rows, points.SPREADS, "os^", strict=True):
        size = [_percent(point.automatic) for point in row]
        right.semilogy(points.WIDTHS, size, mark, ls="-", ms=5, label=f"spread {spread:g}")
    right.axhline(1e2 * points.TOLERANCE, color=QUIET, lw=1.0, label="tolerance")
    right.set(xlabel="a/L", ylabel="error of Automatic [%]")
