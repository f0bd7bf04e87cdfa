"""Figures of laws."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from metafem.drawing import ACHIEVED, QUIET, TARGET, finished, new_figure, scaling
from metafem.inversion import Design, feasible_region
from metafem.inversion.result import draw_laws, draw_target, few
from metafem.models.model import contact_of
from metafem.report.comparison import Comparison
from metafem.report.names import model_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from metafem.surface import Friction

# Approximate number of loads at which sensitivities are drawn; a law usually has a hundred loads.
SENSITIVITY_LOADS = 33

# Margins on the left, on the right, below and above [inch]. On the left and below there are labels, and
# numbers of at most seven characters.
MARGINS = (0.9, 0.2, 0.6, 0.2)


def law_figure(design: Design) -> Figure:
    """Draw target and achieved law, and below them the relative difference that defines the misfit."""
    figure = new_figure(7.0, 5.6, (0.9, 0.8, 0.6, 0.6))
    ax, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1], gridspec_kw={"hspace": 0.08})
    _draw_reach(design, ax)
    draw_laws(design, ax, "achieved: " + model_words(design.law.model))
    _draw_difference(design, below)
    for branch, _ in design.fits:
        below.axvspan(*branch.load_range, color=TARGET, alpha=0.06, lw=0)
    below.set_xlabel(ax.get_xlabel())
    ax.set_xlabel("")
    _force_axes(design, ax)
    return figure


def _draw_difference(design: Design, ax: Axes) -> None:
    """Draw the relative difference between law and target, which defines `design.misfit`."""
    target = design.target_law
    difference = target.difference(design.target_area)
    ax.axhline(0.0, color=QUIET, lw=0.8)
    ax.plot(target.load, 100.0 * difference, "o" if few(target) else "-", color=ACHIEVED)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_ylabel(f"A0 against\n{'the target' if design.density is None else 'density law'} [%]")
    if np.abs(difference).max() < 1e-9:
        ax.set_ylim(-1.0, 1.0)
        ax.annotate("all points are met to 1e-9", (0.02, 0.75), xycoords="axes fraction", color=QUIET)


def _draw_reach(design: Design, ax: Axes) -> None:
    """Draw the region of laws that independent asperities can reach, if the target is a curve."""
    target = design.target_law
    if design.density is not None or few(target):
        return
    bounds = np.linspace(0.0, float(target.load[-1]), 200)[1:]
    low, high = feasible_region(
        design.template, bounds, design.limits, design.tools, contact_of(design.law.model)
    )
    if np.isinf(high).any():  # no bound is proven
        return
    ax.fill_between(
        bounds, low, high, color=QUIET, alpha=0.12, lw=0, label="achievable with independent asperities"
    )
    ax.set_ylim(top=1.5 * float(design.law.rescaled_friction[-1]))


def force_figure(design: Design, friction: Friction) -> Figure:
    """Draw the friction force and the friction coefficient F/P against the load [N], with the target."""
    law, target = design.law, design.target_law
    modulus, strength = law.material.composite_modulus, friction.stress
    figure = new_figure(9.0, 3.2, MARGINS)
    left, right = figure.subplots(1, 2, gridspec_kw={"wspace": 0.25})
    law.plot(left, units="N", label="achieved")
    right.plot(law.load, law.friction_coefficient, color=ACHIEVED, lw=1.8, label="achieved")
    if design.density is None:
        load = target.load * modulus
        force = strength * target.law(design.target_area)
        draw_target(design, left, load, force)
        draw_target(design, right, load, force / load)
    label = "target slope dF/dP"
    for branch, _ in design.fits if design.density is not None else ():
        ends, slope = modulus * np.array(branch.load_range), branch.slope * strength / modulus
        right.plot(ends, [slope, slope], color=TARGET, label=label)
        label = "_nolegend_"
    right.set(xlabel="load  P [N]", ylabel="friction coefficient  μ = F/P")
    right.set_xlim(left=0.0)
    right.set_ylim(bottom=0.0)
    return finished(figure)


def comparison_figure(comparisons: tuple[Comparison, ...]) -> Figure:
    """Draw the change of A0 by elastic interaction, in percent of the independent law, against the load."""
    figure = new_figure(7.0, 3.0, MARGINS)
    ax = figure.add_subplot()
    ax.axhline(0.0, color=QUIET, lw=0.8)
    for comparison, style in zip(comparisons, cycle(("-", "--", ":")), strict=False):
        load, change = comparison.law.rescaled_load, 100.0 * comparison.difference
        ax.plot(load, change, style, color=ACHIEVED, label=comparison.name)
    ax.set(xlabel="rescaled load  P/E* [mm²]", ylabel="change of A0 [%]")
    ax.set_xlim(left=0.0)
    return finished(figure)


def sensitivity_figure(design: Design) -> Figure:
    """Draw the derivative of the friction, dA0/dh, of each asperity, the tallest first, against the load."""
    model = design.law.model.gradient_model
    load = design.law.rescaled_load[:: max(1, len(design.law.load) // SENSITIVITY_LOADS)]
    gradient = model.sensitivity(design.surface, load).gradient[:, np.argsort(-design.surface.height)]
    largest = float(np.abs(gradient).max())
    figure = new_figure(7.0, 3.2, MARGINS)
    ax = figure.add_subplot()
    picture = ax.pcolormesh(
        np.arange(design.surface.count) + 1, load, gradient, cmap="RdBu_r", vmin=-largest, vmax=largest,
        rasterized=True, shading="nearest",
    )  # fmt: skip
    figure.colorbar(picture, label="dA0/dh [mm]")
    ax.set(xlabel="asperity, the tallest first", ylabel="rescaled load  P/E* [mm²]")
    return figure


def _force_axes(design: Design, ax: Axes) -> None:
    """Add axes with the load [N] at the top and, with a Friction, the friction force [N] on the right."""
    friction, modulus = design.surface.friction, design.surface.material.composite_modulus
    top = ax.secondary_xaxis("top", functions=scaling(modulus))
    top.set_xlabel("load P [N]")
    ax.spines["right"].set_visible(friction is not None)
    if friction is not None:
        right = ax.secondary_yaxis("right", functions=scaling(friction.stress))
        right.set_ylabel("friction F [N]")
