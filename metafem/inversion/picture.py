"""Figure of the law of a design beside its target."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem.drawing import TARGET
from metafem.inversion.targets.wanted import Wanted
from metafem.prediction import friction_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from metafem.inversion.design import Design

# Up to this many loads of a target are marked one by one.
MOST_MARKED = 10


def few(wanted: Wanted) -> bool:
    """Whether each load of a target is marked."""
    return len(wanted.load) <= MOST_MARKED


def target_law(design: Design) -> FloatArray:
    """Return the target's friction at the loads of `design.wanted`, (k,) [mm^2].

    Parameters that the target leaves open are fitted to the law of the design.
    """
    wanted = design.wanted
    if not wanted.free.shape[1]:
        return wanted.base
    load = wanted.load * design.surface.material.composite_modulus
    return wanted.law(friction_law(design.surface, design.law.model, load=load).area)


def draw_laws(design: Design, ax: Axes, label: str = "achieved") -> None:
    """Draw the achieved law with its label, and the target or the law of its height density."""
    design.law.plot(ax, label=label)
    (_draw_target if design.density is None else _draw_density)(design, ax)
    for branch, _ in design.fits:
        ax.axvspan(*branch.load_range, color=TARGET, alpha=0.06, lw=0)
    ax.legend(frameon=False, loc="upper left")


def _draw_target(design: Design, ax: Axes) -> None:
    draw_target(design, ax, design.wanted.load, target_law(design))


def draw_target(design: Design, ax: Axes, load: FloatArray, friction: FloatArray) -> None:
    """Draw a target given at the loads of `design.wanted`: marks where they are few, else a line per branch.

    `load` and `friction`, (k,), may have any units.
    """
    wanted = design.wanted
    if few(wanted):
        ax.plot(load, friction, "o", ms=7, color=TARGET, label="target", zorder=3)
        return
    ends = [branch.load_range for branch, _ in design.fits] or [(wanted.load[0], wanted.load[-1])]
    for i, (low, high) in enumerate(ends):
        on = (wanted.load >= low) & (wanted.load <= high)
        label = "target" if i == 0 else None
        ax.plot(load[on], friction[on], "--", lw=1.8, color=TARGET, label=label, zorder=3)


def _draw_density(design: Design, ax: Axes) -> None:
    """Draw the law of the height density, and straight lines with the target slopes along its branches."""
    density = design.wanted
    ax.plot(
        density.load, density.base, color="black", ls=(0, (2, 3)), lw=1.0, label="law of the height density"
    )
    for i, (branch, fit) in enumerate(design.fits):
        load = np.array(branch.load_range)
        middle = fit.intercept + fit.slope * load.mean()
        through = middle - branch.slope * load.mean() if branch.intercept is None else branch.intercept
        label = "target slope" + (", asymptote" if branch.intercept is not None else "") if i == 0 else None
        wide = np.array([0.0 if branch.intercept is not None else load[0], load[1]])
        ax.plot(wide, through + branch.slope * wide, color=TARGET, lw=1.4, label=label)
    for branch, _ in design.fits[:-1]:
        ax.axvline(branch.load_range[1], color=TARGET, ls=":", lw=1.2, label="target crossover")
