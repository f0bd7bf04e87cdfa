"""Figures of a size in millimetres with small type, as SVG or PDF files for a paper."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

from metafem.drawing import new_figure, scaling, svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# One inch [mm].
INCH = 25.4

# Size of all type [points]; journals ask for 5 to 8 points in print.
TYPE = 7.0

# Width of the first of two parts beside each other over the width of the second.
FIRST = 1.25

# Width of a column of the legend, for about 25 characters; height of the letter, the numbers and names below
# the axes and the legend [mm].
COLUMN, NAMES = 40.0, 25.0


def two_parts(width: float, height: float) -> tuple[Figure, Axes, Axes, str]:
    """Return a figure of a size [mm] with two axes, and the side for a scale of the second, see `summits`.

    The axes are beside each other in a wide figure, otherwise one above the other.
    """
    figure = new_figure(width / INCH, height / INCH)
    if width < height:
        first, second = figure.subplots(2, 1)
        side = "right"
    else:
        first, second = figure.subplots(1, 2, width_ratios=(FIRST, 1.0))
        side = "bottom" if width < (1.0 + FIRST) * (height - NAMES) else "right"
    for ax, letter in ((first, "a"), (second, "b")):
        ax.set_title(letter, loc="left", weight="bold")
    return figure, first, second, side


def scaled_axes(ax: Axes, x: tuple[float, str], y: tuple[float, str]) -> None:
    """Replace the numbers and names of both axes: each is a factor of the numbers and the new name."""
    ax.tick_params(left=False, labelleft=False, bottom=False, labelbottom=False)
    ax.set(xlabel="", ylabel="")
    ax.secondary_xaxis("bottom", functions=scaling(x[0])).set_xlabel(x[1])
    ax.secondary_yaxis("left", functions=scaling(y[0])).set_ylabel(y[1])


def saved(figure: Figure, title: str, kind: str) -> bytes:
    """Return the content of an "svg" or "pdf" file, in which one legend is below all axes.

    Figures of equal data give equal files.
    """
    for ax in figure.axes:
        if (legend := ax.get_legend()) is not None:
            legend.remove()
    columns = max(1, int(INCH * figure.get_figwidth() / COLUMN))
    figure.legend(loc="outside lower center", ncols=columns, frameon=False, fontsize=TYPE)
    for text in figure.findobj(lambda artist: hasattr(artist, "set_fontsize")):
        text.set_fontsize(TYPE)  # type: ignore[attr-defined]
    for part in figure.findobj(lambda artist: hasattr(artist, "tick_params")):
        part.tick_params(labelsize=TYPE)  # type: ignore[attr-defined]
    if kind == "svg":
        return (svg(figure, title) + "\n").encode("utf-8")
    content = BytesIO()
    figure.savefig(content, format=kind, metadata={"Title": title, "CreationDate": None})
    return content.getvalue()
