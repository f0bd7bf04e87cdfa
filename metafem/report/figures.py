"""Figures of a design: its law, its friction coefficient, its heights and its contacts."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import drawing
from metafem._values import three_digits
from metafem.drawing import ACHIEVED, LARGEST_DOT, MARGINS, QUIET, TARGET, finished, new_figure, scaling
from metafem.inversion import Design
from metafem.inversion.result import draw_target, few
from metafem.prediction import Onset, equilibrium
from metafem.studies.summary import SHOWN_LOADS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

    from metafem.surface import Friction

# Width and height of a figure that stands beside a table or words [inch].
BESIDE_TEXT = 5.2, 2.7

# Diameter of the rings that mark open summits, and smallest drawn diameter of contacts, over the distance
# between summits. Smaller circles would be invisible.
RING, LEAST_DOT = 0.3, 0.1


def beside_text(draw: Callable[..., None]) -> Callable[..., Figure]:
    """Return the function that draws on the axes of a new figure, which stands beside a table or words."""

    @wraps(draw)
    def drawn(*given: Any) -> Figure:
        figure = new_figure(*BESIDE_TEXT, MARGINS)
        draw(figure.add_subplot(), *given)
        return finished(figure)

    return drawn


def law_figure(design: Design) -> Figure:
    """Draw target and achieved law, and below them the relative difference that defines the misfit."""
    figure = new_figure(5.6, 4.7, (0.85, 0.8, 0.6, 0.6))
    ax, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1], gridspec_kw={"hspace": 0.08})
    design.plot(ax)
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
    ax.set_ylabel("difference [%]")
    if np.abs(difference).max() < 1e-9:
        ax.set_ylim(-1.0, 1.0)  # not the rounding errors of exact points


def _force_axes(design: Design, ax: Axes) -> None:
    """Add axes with the load [N] at the top and, with a Friction, the friction force [N] on the right."""
    friction, modulus = design.surface.friction, design.surface.material.composite_modulus
    ax.secondary_xaxis("top", functions=scaling(modulus)).set_xlabel("load P [N]")
    ax.spines["right"].set_visible(friction is not None)
    if friction is not None:
        right = ax.secondary_yaxis("right", functions=scaling(friction.stress))
        right.set_ylabel("friction F [N]")


@beside_text
def coefficient_figure(ax: Axes, design: Design, friction: Friction) -> None:
    """Draw the friction coefficient F/P against the load [N], with the target unless it is a density's."""
    law, target = design.law, design.target_law
    ratio = friction.stress / law.material.composite_modulus
    ax.plot(law.load, law.friction_coefficient, color=ACHIEVED, lw=1.8, label="achieved")
    load = target.load * law.material.composite_modulus
    if design.density is None:
        draw_target(design, ax, load, ratio * target.law(design.target_area) / target.load)
    ax.set(xlabel="load  P [N]", ylabel="friction coefficient  μ = F/P", xlim=(0.0, None), ylim=(0.0, None))


@beside_text
def onset_figure(ax: Axes, sliding: Onset) -> None:
    """Draw the friction force against the tangential displacement."""
    sliding.plot(ax)


@beside_text
def interaction_figure(ax: Axes, models: Dataset) -> None:
    """Draw the change of A0 from that of independent asperities, in percent, against the load."""
    ax.axhline(0.0, color=QUIET, lw=0.8)
    changes = 100.0 * models["area_change"].values[1:]
    for name, change, style in zip(models["model"].values[1:], changes, cycle(("-", "--", ":", "-."))):
        ax.plot(models["rescaled_load"], change, style, color=ACHIEVED, label=str(name))
    ax.set(xlabel="rescaled load  P/E* [mm²]", ylabel="change of A0 [%]", xlim=(0.0, None))


def height_figure(design: Design) -> Figure:
    """Draw the heights at their sites, with diameters proportional to the radii; empty sites as rings."""
    figure = new_figure(4.8, 3.2, (0.7, 0.4, 0.6, 0.3))
    ax = figure.add_subplot()
    sites = design.template.position
    empty = np.setdiff1d(np.arange(len(sites)), design.sites)
    drawing.rings(ax, sites[empty], LARGEST_DOT * drawing.spacing(sites))
    design.surface.plot(ax)
    if empty.size:
        ax.set_title(f"{empty.size} sites stay empty (rings)", fontsize=10, color=QUIET)
    return figure


def contact_figure(design: Design) -> Figure:
    """Draw top views at three loads: contacts as discs to scale, summits that are not in contact as rings."""
    figure = new_figure(9.6, 3.7, (0.7, 0.1, 0.6, 0.6))
    axes = figure.subplots(1, len(SHOWN_LOADS), sharex=True, sharey=True, gridspec_kw={"wspace": 0.05})
    position = design.surface.position
    distance = drawing.spacing(position)
    for ax, fraction in zip(axes, SHOWN_LOADS, strict=True):
        state = equilibrium(design.surface, design.law.model, load=fraction * float(design.law.load[-1]))
        closed = state.asperity_area > 0.0
        diameter = 2.0 * np.sqrt(state.asperity_area[closed] / np.pi)
        drawing.rings(ax, position[~closed], RING * distance)
        drawing.circles(ax, position[closed], np.maximum(diameter, LEAST_DOT * distance))
        drawing.plan(ax)
        words = f"{closed.sum()} of {design.surface.count} in contact, {state.area:.3g} mm²"
        ax.set_title(f"P = {three_digits(state.load)} N\n{words}", fontsize=10)
        ax.label_outer()
    return figure
