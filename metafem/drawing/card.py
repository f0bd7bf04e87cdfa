"""Display of a result in a notebook: a table of facts and a picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from metafem.drawing import ACHIEVED, FloatArray, new_figure, svg
from metafem.drawing.inline import themed

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Width and height of the picture [inch].
WIDTH, HEIGHT = 4.4, 3.0

# Largest number of points of a line; the picture is less than this number of pixels wide.
MOST_POINTS = 1000

# Smallest number of values for a histogram, and number of bars of a histogram.
FEWEST, BARS = 10, 24

# The colours of the notebook: letters and axes have its text colour, and the background is transparent.
COLOURS = (
    "fill: currentColor; --ink: currentColor; --measured: currentColor; --paper: none; --line: #8a8f9880"
)
BOX = f"display: flex; flex-wrap: wrap; gap: 1.5em; align-items: flex-start; {COLOURS}"
CELL = "text-align: left; vertical-align: top; padding: .1em 1em .1em 0; font-weight: normal"
NAME = CELL + "; white-space: nowrap; opacity: .75"


def card(title: str, facts: Mapping[str, str], draw: Callable[[Axes], object] | None = None) -> str:
    """Return a title, a table of facts and a picture as an HTML element in the colours of its page.

    The element has no scripts. `draw` draws the picture on given axes; default: no picture.

    Examples
    --------
    >>> print(card("Spring", {"stiffness": "2 N/mm"})[-44:])
    2 N/mm</td></tr></tbody></table></div></div>
    """
    rows = "".join(
        f'<tr style="background: none"><th style="{NAME}">{escape(name)}</th>'
        f'<td style="{CELL}">{escape(value).replace("mm^2", "mm²")}</td></tr>'
        for name, value in facts.items()
    )
    table = f'<table style="border: none; margin: .3em 0"><tbody>{rows}</tbody></table>'
    picture = "" if draw is None else f"<div>{_picture(title, draw)}</div>"
    words = f'<div style="max-width: 36em"><strong>{escape(title)}</strong>{table}</div>'
    return f'<div style="{BOX}">{words}{picture}</div>'


def _picture(title: str, draw: Callable[[Axes], object]) -> str:
    figure = new_figure(WIDTH, HEIGHT)
    draw(figure.add_subplot())
    figure.patch.set_alpha(0.0)
    for ax in figure.axes:
        ax.patch.set_alpha(0.0)
    return themed(svg(figure, title))


def thinned(*arrays: FloatArray) -> tuple[FloatArray, ...]:
    """Return at most 1,000 evenly spaced entries of arrays of equal length, the last entry included."""
    count = len(arrays[0])
    kept = np.unique(np.linspace(0, count - 1, min(count, MOST_POINTS)).astype(np.int64))
    return tuple(array[kept] for array in arrays)


def distribution(ax: Axes, values: FloatArray, label: str) -> None:
    """Draw the histogram of a quantity over the asperities, (n,)."""
    ax.hist(values, BARS, color=ACHIEVED)
    ax.set_xlabel(label)
    ax.set_ylabel("asperities")
