"""Views of a surface: heights and contacts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from metafem import drawing
from metafem._validate import FloatArray
from metafem._values import three_digits
from metafem.drawing import QUIET, new_figure
from metafem.inversion import Design
from metafem.material import Block
from metafem.prediction import equilibrium
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# The three loads of the contact views, as fractions of the largest load of the law.
VIEWED_LOADS = (0.1, 0.4, 1.0)

# Diameter of the rings that mark open summits, and smallest drawn diameter of contacts, over the distance
# between summits. Smaller circles would be invisible.
RING, LEAST_DOT = 0.3, 0.1

# Largest number of summits in the view of the contacts; of more summits, those around the tallest are shown.
MOST_SHAPED = 400


def height_figure(design: Design) -> Figure:
    """Draw the heights at their sites, with diameters proportional to the radii; empty sites as rings."""
    figure = new_figure(5.0, 4.2, (0.7, 0.4, 0.8, 0.3))
    ax = figure.add_subplot()
    empty = np.setdiff1d(np.arange(design.template.count), design.sites)
    drawing.empty_sites(ax, design.template.position[empty])
    design.surface.plot(ax)
    if empty.size:
        ax.set_title(f"{empty.size} sites stay empty (rings)", fontsize=10, color=QUIET)
    return figure


def contact_figure(design: Design) -> Figure:
    """Draw top views at three loads: contacts as discs to scale, summits that are not in contact as rings.

    Of many summits, only those around the tallest are shown.
    """
    figure = new_figure(9.6, 4.0, (0.7, 0.1, 0.6, 0.6))
    axes = figure.subplots(1, len(VIEWED_LOADS), sharex=True, sharey=True, gridspec_kw={"wspace": 0.05})
    corners, shown = _shown(design.surface)
    position = design.surface.position[shown]
    distance = drawing.spacing(position)
    for ax, fraction in zip(axes, VIEWED_LOADS, strict=True):
        load = fraction * float(design.law.load[-1])
        state = equilibrium(design.surface, design.law.model, load=load)
        closed = state.asperity_area[shown] > 0.0
        diameter = 2.0 * np.sqrt(state.asperity_area[shown][closed] / np.pi)
        drawing.rings(ax, position[~closed], RING * distance)
        drawing.circles(ax, position[closed], np.maximum(diameter, LEAST_DOT * distance))
        drawing.plan(ax)
        ax.set(xlim=corners[:, 0], ylim=corners[:, 1])
        count = int((state.asperity_area > 0.0).sum())
        words = f"{count} of {design.surface.count} in contact, {state.area:.3g} mm²"
        ax.set_title(f"P = {three_digits(load)} N\n{words}", fontsize=10)
        ax.label_outer()
    return figure


def _shown(surface: Surface) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return two opposite corners (2, 2) [mm] of the part that is shown, and a mask (n,) of its summits.

    The part extends beyond the outer summits by half the distance between summits, but not beyond the block.
    """
    position = surface.position
    distance = drawing.spacing(position)
    low, high = position.min(axis=0), position.max(axis=0)
    if surface.count > MOST_SHAPED:
        half = 0.5 * distance * math.sqrt(MOST_SHAPED)
        centre = np.clip(position[surface.height.argmax()], low + half, np.maximum(high - half, low + half))
        low, high = np.maximum(low, centre - half), np.minimum(high, centre + half)
    corners = np.array([low - 0.5 * distance, high + 0.5 * distance])
    if surface.block is not None:
        corners = np.clip(corners, *_corners(surface.block))
    return corners, ((position >= corners[0]) & (position <= corners[1])).all(axis=1)


def _corners(block: Block) -> FloatArray:
    """Return the left front and the right back corner of a block, (2, 2) [mm]."""
    edge = 0.5 * np.array([block.width, block.length])
    return np.array([-edge, edge])
