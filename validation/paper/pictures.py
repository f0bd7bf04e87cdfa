"""Laws with their slopes, and the numbers of the paper in the same axes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import metafem as mf
from metafem.drawing import ACHIEVED, MEASURED, MEASURED_BESIDE, TARGET, new_figure
from metafem.inversion.result import draw_laws

# Colours of the three levels and operating points of Fig. 3 in the paper.
LEVELS = ("tab:green", "tab:blue", "tab:red")

# Colours of the five surfaces: blue ones are blue and red ones red, those of Fig. 5 lighter.
INKS = {
    "Fig. 3": MEASURED,
    "Fig. 4 blue": "tab:blue",
    "Fig. 4 red": "tab:red",
    "Fig. 5 blue": "#5fb4ee",
    "Fig. 5 red": "#f58a86",
}

# The drawn laws end at this multiple of the load at the foot of the density.
END = 1.1

LOADS = 400


def inked(figure: Figure, colours: Mapping[str, str]) -> None:
    """Draw lines, bars and marks of some colours in others."""
    changed = {to_rgb(old): new for old, new in colours.items()}
    for line in figure.findobj(Line2D):
        line.set_color(changed.get(to_rgb(line.get_color()), line.get_color()))
    for bars in figure.findobj(LineCollection):
        if len(bars.get_color()):
            bars.set_color(changed.get(to_rgb(bars.get_color()[0]), bars.get_color()[0]))


def law_and_slopes(name: str, designs: Mapping[str, mf.Design]) -> tuple[Figure, Axes, Axes]:
    """Draw the law of a density's heights with its target, and beside it the local slopes dA0/d(P/E*).

    The surface has its colour, and the axes are those of all the designs, by their names.
    """
    design = designs[name]
    figure = new_figure(9.0, 3.8)
    left, right = figure.subplots(1, 2)
    draw_laws(design, left)
    ends = [END * other.fits[-1][0].load_range[1] for other in designs.values()]
    laws = [other.law for other in designs.values()]
    highest = max(np.interp(x, law.rescaled_load, law.area) for x, law in zip(ends, laws, strict=True))
    end = max(ends)
    left.set(xlim=(0.0, end), ylim=(0.0, 1.1 * highest))
    load = np.linspace(0.0, end, LOADS + 1)[1:]
    area = mf.friction_law(design.surface, load=load * design.surface.material.composite_modulus).area
    middle = 0.5 * (load[1:] + load[:-1])
    right.plot(middle, np.diff(area) / np.diff(load), color=ACHIEVED, lw=0.8, label="64 asperities")
    target = design.target_law
    right.plot(
        0.5 * (target.load[1:] + target.load[:-1]), np.diff(target.middle) / np.diff(target.load),
        color="black", ls=(0, (2, 3)), lw=1.2, label="height density",
    )  # fmt: skip
    for i, (branch, fit) in enumerate(design.fits):
        ends = branch.load_range
        words = ("fitted to 64 asperities", "target slope") if i == 0 else (None, None)
        right.plot(ends, [fit.slope] * 2, color=ACHIEVED, lw=2.0, label=words[0])
        right.plot(ends, [branch.slope] * 2, "--", color=TARGET, lw=1.4, label=words[1])
    steepest = max(branch.slope for other in designs.values() for branch, _ in other.fits)
    right.set(xlim=(0.0, end), ylim=(0.0, 1.35 * steepest))
    right.set(xlabel="rescaled load  P/E* [mm²]", ylabel="slope of the law")
    inked(figure, {ACHIEVED: INKS[name], TARGET: MEASURED})
    for ax in (left, right):
        ax.spines[["top", "right"]].set_visible(False)
    return figure, left, right


def slope_band(ax: Axes, load: tuple[float, float], slope: float, error: float, label: str | None) -> None:
    """Draw a slope ± error over a range of loads [mm²] as a band."""
    ax.fill_between(load, slope - error, slope + error, color=MEASURED_BESIDE, alpha=0.3, lw=0, label=label)


def load_band(ax: Axes, load: float, error: float, label: str | None) -> None:
    """Draw a measured load ± error [mm²] as a band."""
    ax.axvspan(load - error, load + error, color=MEASURED_BESIDE, alpha=0.3, lw=0, label=label)
