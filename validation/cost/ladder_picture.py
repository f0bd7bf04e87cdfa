"""The picture of the ladder of models: seconds against error, from sparse to merged contacts."""

from __future__ import annotations

from itertools import groupby

from metafem.drawing import MEASURED, QUIET, new_figure
from validation.cost.measured import PEER, Point, models, peers
from validation.numbers import powers
from validation.scenes.costs import AUTOMATIC, MODELS, ORDER_3, RESOLVED, SCENES, reference

# The scenes: 64 asperities from sparse to crowded, merged contacts, and more asperities.
SHOWN = ("sparse", "paper", "dense", "merged", "several", "many")
ROWS, COLUMNS = 2, 3

# Colour and marker of each line; all can be told apart in grey, on white and on black.
STYLES = {
    "Independent()": ("#8a8f98", "o"),
    "Interacting(order=1)": ("#7fb069", "^"),
    ORDER_3: ("#1b6f8a", "D"),
    AUTOMATIC: ("#8d6fc0", "*"),
    RESOLVED: ("#c8553d", "v"),
    PEER: (MEASURED, "X"),
    f"{PEER}, second moments": (MEASURED, "x"),
}

# Lines of the picture: the models and another code, with the two readings of its area.
LINES = (*MODELS, RESOLVED, PEER, f"{PEER}, second moments")

CHOSEN = f"{AUTOMATIC}, tolerance above"


def ladder_picture():
    """Seconds for one load of a new surface against the error of A0, one panel for each scene. Lines join
    finer cells or smaller tolerances; rings are what Automatic chose, with its tolerances. Dotted line: the
    uncertainty of the reference; smaller errors are drawn on it.
    """
    figure = new_figure(9.6, 6.6)
    panels = figure.subplots(ROWS, COLUMNS, sharex=True, sharey=True)
    for ax, scene in zip(panels.ravel(), SHOWN, strict=True):
        _panel(ax, scene)
    for ax in panels[-1]:
        ax.set_xlabel("seconds for one load of a new surface")
    for ax in panels[:, 0]:
        ax.set_ylabel("relative error of A0")
    handles = {}
    for ax in panels.ravel():
        handles |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    shown = [label for label in (*LINES, CHOSEN) if label in handles]
    figure.legend([handles[label] for label in shown], shown, frameon=False, fontsize=9, ncols=4,
                  loc="outside lower center")  # fmt: skip
    return figure


def _panel(ax, scene: str) -> None:
    """Draw one scene; errors below the uncertainty of its reference are drawn at the uncertainty."""
    least = reference(scene).area_uncertainty
    every = (*models(scene), *peers(scene))

    def places(points: list[Point]) -> tuple[list[float], list[float]]:
        return [each.cold for each in points], [max(each.area_error, least) for each in points]

    cheapest = [each for line in MODELS for each in every if each.line == line]
    ax.plot(*places(cheapest), color=QUIET, lw=1, zorder=1)
    for line in LINES:
        if points := [each for each in every if each.line == line]:
            colour, marker = STYLES[line]
            ax.plot(*places(points), marker=marker, ms=6, lw=1, color=colour, label=line)
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
    ax.set_title(SCENES[scene].title, fontsize=10)
    ax.spines[["top", "right"]].set_visible(False)
    ax.loglog()
