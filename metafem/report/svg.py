"""A matplotlib figure as SVG text that is the same, to the byte, for the same data."""

from __future__ import annotations

from html import escape
from io import StringIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Fixed salt: element names must not change from run to run.
SALT = "metafem"


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of a size [inch] that shares the reports' style and no global state."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def svg(figure: Figure, title: str) -> str:
    """Return the figure as an inline SVG element with a title for readers that do not see it."""
    from matplotlib import rc_context

    buffer = StringIO()
    style: dict[Any, Any] = {
        "svg.hashsalt": SALT + title,
        "svg.fonttype": "none",
        "font.family": "sans-serif",
    }
    with rc_context(style):
        figure.savefig(buffer, format="svg", metadata=dict.fromkeys(("Date", "Creator", "Format", "Type")))
    text = buffer.getvalue()
    start = text.index(">", text.index("<svg")) + 1
    return f"{text[text.index('<svg') : start]}<title>{escape(title)}</title>{text[start:]}"
