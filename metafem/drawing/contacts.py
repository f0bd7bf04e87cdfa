"""Drawing of the contacts found in an image."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem.drawing import FloatArray, circles, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Colours of measured contacts, of contacts without a measured area, and of regions without a site; of open
# sites.
COLOURS, OPEN = {"measured": "#00b4d8", "cut or merged": "#e63946", "of no site": "#ffb703"}, "#7b2cbf"

# Largest number of pixels that are drawn along a side of an image.
MOST_DRAWN = 1600

# Largest width or height of the picture, and height of the heading [inch].
SIDE, HEADING = 8.0, 0.7


def picture_figure(width: float, height: float) -> Figure:
    """Return a figure for an image and its heading; width and height of the image may have any unit."""
    scale = SIDE / max(width, height)
    return new_figure(max(scale * width, 0.6 * SIDE), scale * height + HEADING)


def picture(ax: Axes, image: NDArray[Any], pixel_size: float) -> None:
    """Draw the grey values of an image on axes in mm, with its lower left corner at the origin."""
    rows, columns = image.shape
    step = -(-max(rows, columns) // MOST_DRAWN)
    means = image
    if step > 1:
        cut = image[: rows - rows % step, : columns - columns % step].astype(np.float32)
        means = cut.reshape(rows // step, step, columns // step, step).mean(axis=(1, 3))
    low, high = np.percentile(means, [0.5, 99.5]).tolist()
    width, height = (step * count * pixel_size for count in means.shape[::-1])
    top = rows * pixel_size
    extent = (0.0, width, top - height, top)
    ax.imshow(means, cmap="gray", extent=extent, vmin=low, vmax=high, interpolation="nearest")
    ax.set(xlim=(0.0, columns * pixel_size), ylim=(0.0, top), xlabel="x [mm]", ylabel="y [mm]")
    ax.set_aspect("equal")


def outlines(
    ax: Axes, centre: FloatArray, axes: FloatArray, angle: FloatArray, colour: str, label: str
) -> None:
    """Draw ellipses with centres (n, 2) [mm], semi-axes (n, 2) [mm] and directions (n,) [rad]."""
    if not len(centre):
        return
    drawn = circles(ax, centre, 2.0 * axes[:, 0])
    drawn.set_heights(2.0 * axes[:, 1])
    drawn.set_angles(np.degrees(angle))
    drawn.set(facecolor="none", edgecolor=colour, linewidth=1.0)
    ax.plot([], [], "o", mfc="none", mec=colour, label=f"{len(centre)} {label}")


def crosses(ax: Axes, position: FloatArray, label: str) -> None:
    """Draw crosses at open sites (n, 2) [mm]."""
    if len(position):
        ax.plot(*position.T, "x", color=OPEN, ms=5.0, mew=1.0, label=f"{len(position)} {label}", ls="none")


def numbers(ax: Axes, position: FloatArray, names: Sequence[str], colour: str) -> None:
    """Write names to the lower right of points (n, 2) [mm]."""
    behind = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.75}
    for (x, y), name in zip(position, names, strict=True):
        ax.annotate(
            name, (x, y), xytext=(2.0, -2.0), textcoords="offset points", fontsize=7.0, color=colour,
            ha="left", va="top", clip_on=True, bbox=behind,
        )  # fmt: skip


def heading(ax: Axes, text: str) -> None:
    """Write the name of an image above it, with a legend of the colours."""
    if ax.get_legend_handles_labels()[0]:
        ax.legend(
            loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False, fontsize=8,
            handletextpad=0.3, borderaxespad=0.2, columnspacing=1.2,
        )  # fmt: skip
    ax.set_title(text, fontsize=10, loc="left", pad=24.0)
