"""The panel of the law."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.explorer.answer import Answer
from metafem.explorer.law.law_data import law_data
from metafem.explorer.law.law_plot import LawPlot

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def law_panel(page: Page) -> None:
    """Make the plot of the law."""
    plot = LawPlot()

    def show(answer: Answer) -> None:
        plot.show(law_data(answer))

    page.listen(show)
