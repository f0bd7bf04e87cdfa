"""Figures of claims as functions of their axes."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

from metafem.drawing import new_figure


def panels(
    width: float, height: float, rows: int = 1, columns: int = 1, **options: Any
) -> Callable[[Callable[..., None]], Callable[..., Any]]:
    """Make a function that draws into axes one that returns a figure [inch] with them.

    The axes are its last arguments, row by row; matplotlib's `subplots` takes the options. They have no frame
    on the right and above, and legends unless the function has made one.
    """

    def decorate(draw: Callable[..., None]) -> Callable[..., Any]:
        @wraps(draw)
        def drawn(*given: Any) -> Any:
            figure = new_figure(width, height)
            axes = figure.subplots(rows, columns, squeeze=False, **options).ravel()
            draw(*given, *axes)
            chosen = figure.legends or any(ax.get_legend() for ax in axes)
            for ax in axes:
                ax.spines[["top", "right"]].set_visible(False)
                named = [each.get_label() for each in (*ax.lines, *ax.patches, *ax.containers)]
                if not chosen and any(name and name[0] != "_" for name in named):
                    ax.legend(frameon=False, fontsize=8)
            return figure

        return drawn

    return decorate
