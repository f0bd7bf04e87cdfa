"""Figure of the law of a design and its target."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem.drawing import TARGET
from metafem.inversion.search.target_law import TargetLaw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from metafem.inversion.result import Design

# Maximum number of loads of a target that are marked individually.
MOST_MARKED = 10


def few(law: TargetLaw) -> bool:
    """Whether each load of a target is marked."""
    return len(law.load) <= MOST_MARKED


def draw_laws(design: Design, ax: Axes, label: str = "achieved") -> None:
    """Draw the achieved law with its label, and the target or the law of its height density."""
    design.law.plot(ax, label=label)
    if design.density is None:
        law = design.target_law
        draw_target(design, ax, law.load, law.law(design.target_area) if law.is_open else law.base)
    else:
        _draw_density(design, ax)
    for branch, _ in design.fits:
        ax.axvspan(*branch.load_range, color=TARGET, alpha=0.06, lw=0)
    ax.legend(frameon=False, loc="upper left")


def draw_target(design: Design, ax: Axes, load: FloatArray, friction: FloatArray) -> None:
    """Draw a target: marks if it has few loads, otherwise a line for each branch.

    `load` and `friction`, (k,), are those of `design.target_law` in any units.
    """
    law = design.target_law
    if few(law):
        ax.plot(load, friction, "o", ms=7, color=TARGET, label="target", zorder=3)
        return
    ends = [branch.load_range for branch, _ in design.fits] or [(law.load[0], law.load[-1])]
    for i, (low, high) in enumerate(ends):
        on = (law.load >= low) & (law.load <= high)
        label = "target" if i == 0 else None
        ax.plot(load[on], friction[on], "--", lw=1.8, color=TARGET, label=label, zorder=3)


def _draw_density(design: Design, ax: Axes) -> None:
    """Draw the law of the height density, and straight lines with the target slopes along its branches."""
    law, words = design.target_law, "law of the height density"
    ax.plot(law.load, law.base, color="black", ls=(0, (2, 3)), lw=1.0, label=words)
    for i, (branch, fit) in enumerate(design.fits):
        load = np.array(branch.load_range)
        middle = fit.intercept + fit.slope * load.mean()
        through = middle - branch.slope * load.mean() if branch.intercept is None else branch.intercept
        label = "target slope" + (", asymptote" if branch.intercept is not None else "") if i == 0 else None
        wide = np.array([0.0 if branch.intercept is not None else load[0], load[1]])
        ax.plot(wide, through + branch.slope * wide, color=TARGET, lw=1.4, label=label)
    for branch, _ in design.fits[:-1]:
        ax.axvline(branch.load_range[1], color=TARGET, ls=":", lw=1.2, label="target crossover")
