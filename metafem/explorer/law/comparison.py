"""The table that compares the design, B, with the one that is pinned, A."""

from __future__ import annotations

from html import escape

from nicegui import ui

from metafem._values import three_digits
from metafem.explorer.answer import Answer, pinned_answer
from metafem.explorer.certainty.figures import MISFIT, MODEL_ERROR, SCATTER, figures
from metafem.explorer.control import Control, Panel

# Name of the tab.
COMPARED = "A and B"

# Rows of the table, each with the quantity of the figure that it shows.
FIGURES = {
    "Misfit": MISFIT,
    "Scatter of the law of made surfaces": SCATTER,
    "Estimated error of the model": MODEL_ERROR,
}

NOTHING = "Nothing is pinned. “Pin as A” in the legend of the law keeps the law that is shown for comparison."


def comparison(answer: Answer) -> list[tuple[str, str, str]]:
    """Return the rows of the table: the name of a number, and its values for A and for B."""
    pinned = pinned_answer(answer.state.pinned)
    if pinned is None or answer.design is None:
        return []
    before, now = _numbers(pinned), _numbers(answer)
    return [(name, before[name], now[name]) for name in before]


def _numbers(answer: Answer) -> dict[str, str]:
    """Return the numbers of one column by their names."""
    assert answer.design is not None
    surface = answer.design.surface
    known = {figure.quantity: figure.value for figure in reversed(figures(answer))}  # the first of each
    values = {name: known[quantity] for name, quantity in FIGURES.items()}
    volume = float(surface.cap.volume(surface.height, surface.radius).sum())
    values["Largest load"] = f"{three_digits(answer.design.law.load[-1])} N"
    return values | {"Volume of the caps": f"{three_digits(volume)} mm³"}


def _as_html(rows: list[tuple[str, str, str]]) -> str:
    """Return the table, or what to do for one."""
    lines = (
        f'<tr><th scope="row">{escape(name)}</th><td class="number">{escape(before)}</td>'
        f'<td class="number">{escape(now)}</td></tr>'
        for name, before, now in rows
    )
    head = "<thead><tr><th></th><th>A, pinned</th><th>B, as shown</th></tr></thead>"
    return f'<table class="figure-table">{head}<tbody>{"".join(lines)}</tbody></table>' if rows else NOTHING


class Comparison(Panel):
    """The table; it follows the answers while its tab is open."""

    pace = 0.3

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.table = ui.html(NOTHING, sanitize=False)

    def prepare(self, answer: Answer) -> str:
        """Return the table of an answer; while the tab is closed, the last one."""
        return _as_html(comparison(answer)) if self.open else self.table.content

    def show(self, answer: Answer, data: str) -> None:
        """Show the table."""
        self.table.content = data
