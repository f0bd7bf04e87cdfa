"""Drawing of plain arrays: figures, axes, colours and marks. The only package that uses matplotlib."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from io import StringIO
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem._values import MICROMETRES

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import EllipseCollection
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]

# Colours of the target, of the achieved law, of secondary lines, and of the points of two measured laws.
TARGET, ACHIEVED, QUIET = "#c8553d", "#1b6f8a", "#8a8f98"
MEASURED, MEASURED_BESIDE = "#2b2d33", "#b07a1e"

# Diameter of the largest marker over the mean distance between summits.
LARGEST_DOT = 0.8

# Largest number of marks that are drawn as vectors; more marks are drawn as pixels. Resolution [pixels per
# inch].
MANY, RESOLUTION = 1000, 200

# Margins of a figure on the left, on the right, below and above [inch]. On the left and below there is room
# for the label of an axis and numbers of at most seven characters.
MARGINS = (0.9, 0.2, 0.6, 0.2)

# Fixed salt of the hashes by which matplotlib names the elements of an SVG: the names are equal in every run.
SALT = "metafem"


def new_figure(
    width: float, height: float, margins: tuple[float, float, float, float] | None = None
) -> Figure:
    """Return an empty figure of a given size [inch], independent of pyplot's state.

    The margins on the left, on the right, below and above [inch] leave room for the labels of the axes.
    Without margins, matplotlib measures the labels, which takes as long as drawing the figure.
    """
    from matplotlib.figure import Figure

    if margins is None:
        return Figure(figsize=(width, height), layout="constrained")
    figure = Figure(figsize=(width, height))
    left, right, below, above = margins
    figure.subplots_adjust(left / width, below / height, 1.0 - right / width, 1.0 - above / height)
    return figure


def axes(ax: Axes | None, width: float = 5.0, height: float = 3.6) -> Axes:
    """Return `ax`, or if it is None the axes of a new pyplot figure of a width and height [inch]."""
    if ax is None:
        from matplotlib import pyplot

        return pyplot.figure(figsize=(width, height), layout="constrained").add_subplot()
    return ax


def svg(figure: Figure, title: str) -> str:
    """Return a figure as an inline SVG element, with a title for screen readers.

    Figures of equal data give the same text, byte for byte.
    """
    from matplotlib import rc_context

    buffer = StringIO()
    style: dict[Any, Any] = {
        "svg.hashsalt": SALT + title,
        "svg.fonttype": "none",
        "font.sans-serif": ["DejaVu Sans"],  # or each text names ten fonts
    }
    with rc_context(style):
        metadata = dict.fromkeys(("Date", "Creator", "Format", "Type"))
        figure.savefig(buffer, format="svg", metadata=metadata, dpi=RESOLUTION)
    text = buffer.getvalue()
    start = text.index(">", text.index("<svg")) + 1
    return f"{text[text.index('<svg') : start]}<title>{escape(title)}</title>{text[start:]}"


def finished(figure: Figure) -> Figure:
    """Remove the frame lines at the top and right, add missing legends, and return the figure."""
    for ax in figure.axes:
        ax.spines[["top", "right"]].set_visible(False)
        if ax.get_legend() is None and ax.get_legend_handles_labels()[1]:
            ax.legend(frameon=False)
    return figure


def law(ax: Axes, load: FloatArray, friction: FloatArray, *, forces: bool, **style: Any) -> None:
    """Draw a friction law from the origin: forces [N], or rescaled load and friction [mm^2]."""
    ax.plot(np.append(0.0, load), np.append(0.0, friction), **{"color": ACHIEVED, "lw": 1.8, **style})
    name_law(ax, forces=forces)


def name_law(ax: Axes, *, forces: bool) -> None:
    """Label the axes of a friction law, and let them begin at zero."""
    ax.set(xlabel="rescaled load  P/E* [mm²]", ylabel="rescaled friction  F/(σB) [mm²]")
    if forces:
        ax.set(xlabel="load  P [N]", ylabel="friction force  F [N]")
    ax.set(xlim=(0.0, None), ylim=(0.0, None))


def summits(ax: Axes, position: FloatArray, height: FloatArray, radius: FloatArray) -> None:
    """Draw summits at their positions (n, 2) [mm] as circles, coloured by height [mm].

    The diameters are proportional to the radii [mm].
    """
    dots = circles(
        ax, position, LARGEST_DOT * spacing(position) * radius / radius.max(), height * MICROMETRES
    )
    label = "summit height [µm]"
    if np.ptp(radius) > 0.0:
        low, high = MICROMETRES * radius.min(), MICROMETRES * radius.max()
        label += f"; diameters in proportion to R = {low:.4g} to {high:.4g} µm"
    ax.figure.colorbar(dots, ax=ax, label=label, shrink=0.85)


def spacing(position: FloatArray) -> float:
    """Return the approximate distance [mm] between neighbouring points (n, 2); 1 for a single point."""
    extent = np.ptp(position, axis=0)
    count = len(position)
    return max(float(np.sqrt(extent.prod() / count)), float(extent.max()) / count) or 1.0


def rings(ax: Axes, position: FloatArray, diameter: float) -> None:
    """Draw rings of a diameter [mm] around points (m, 2) [mm]."""
    drawn = circles(ax, position, np.full(len(position), diameter))
    drawn.set(facecolor="none", edgecolor=QUIET, linewidth=0.8 if len(position) <= MANY else 0.2)


def circles(
    ax: Axes, position: FloatArray, diameter: FloatArray, value: FloatArray | None = None
) -> EllipseCollection:
    """Draw filled circles to scale: centres (n, 2) and diameters (n,) [mm], coloured by values (n,)."""
    from matplotlib.collections import EllipseCollection

    dots = EllipseCollection(
        diameter,
        diameter,
        np.zeros_like(diameter),
        units="xy",
        offsets=position,
        offset_transform=ax.transData,
        facecolors=ACHIEVED,
        rasterized=len(position) > MANY,
    )
    if value is not None:
        dots.set_array(value)
    ax.add_collection(dots)
    ax.update_datalim(
        np.concatenate([position - 0.5 * diameter[:, None], position + 0.5 * diameter[:, None]])
    )
    return dots


def grids(ax: Axes, corner: FloatArray, cell: float, values: list[FloatArray], label: str) -> None:
    """Draw the non-zero values on the square cells of rectangles.

    `corner` (m, 2) holds the centre of the first cell of each rectangle [mm], and `cell` is the side of a
    cell [mm]. `values` has one array for each rectangle, with x along the first axis of the array.
    """
    highest = max((float(value.max()) for value in values), default=0.0)
    for (x, y), value in zip(corner - 0.5 * cell, values, strict=True):
        rows, columns = value.shape
        image = ax.imshow(
            np.ma.masked_equal(value.T, 0.0), origin="lower", vmin=0.0, vmax=highest, cmap="viridis",
            extent=(x, x + rows * cell, y, y + columns * cell),
        )  # fmt: skip
    if values:
        ax.figure.colorbar(image, ax=ax, label=label, shrink=0.85)


def scaling(factor: float) -> tuple[Callable[[ArrayLike], ArrayLike], Callable[[ArrayLike], ArrayLike]]:
    """Return the functions that multiply and divide by a factor, for a second axis."""
    return (lambda value: np.asarray(value) * factor), (lambda value: np.asarray(value) / factor)


def outline(ax: Axes, width: float, length: float) -> None:
    """Draw the edges of a block, centred on the origin, from its width and length [mm]."""
    from matplotlib.patches import Rectangle

    corner = (-0.5 * width, -0.5 * length)
    ax.add_patch(Rectangle(corner, width, length, fill=False, ec=QUIET, lw=0.8))


def plan(ax: Axes) -> None:
    """Make the axes a plan view, with x and y [mm] on the same scale."""
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.08)
    ax.set(xlabel="x [mm]", ylabel="y [mm]")
