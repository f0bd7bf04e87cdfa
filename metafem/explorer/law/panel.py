"""The panel of the law."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.law.law_data import band_data, law_data
from metafem.explorer.law.law_plot import LawPlot
from metafem.explorer.law.reach import Reach
from metafem.explorer.law.shown import Units
from metafem.explorer.law.stand_in import handles, moved
from metafem.files import Specification

if TYPE_CHECKING:
    from metafem.explorer.page import Page

STYLE = Path(__file__).with_name("law.css")


def law_panel(page: Page) -> None:
    """Make the plot of the law."""
    ui.add_css(STYLE.read_text("utf-8"))
    LawPanel(page)


class LawPanel:
    """The plot of one page: its events become edits, and answers are drawn."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.plot = LawPlot(drag=self.drag, add=self.add, remove=self.remove, cursor=self.cursor)
        self.reach = Reach()
        self.band_shown: Any = None
        # numbers of the page's requests, and of the plot's that they belong to
        self.requests: dict[int, int] = {}
        # the text of a specification and what it says: that of a drag's first text is needed at every step
        self.read: tuple[str, Specification] | None = None
        page.listen(self.show)

    def show(self, answer: Answer) -> None:
        """Draw an answer."""
        of_plot = [number for number in self.requests if number <= answer.number]
        request = max((self.requests.pop(number) for number in of_plot), default=None)
        specification, text = answer.specification, answer.state.text
        points = () if specification is None else handles(text, specification, answer.design)
        data = law_data(answer, points, request)
        if specification is not None:
            units = Units.of(answer, answer.state.newtons)
            band = self.reach.of(specification)
            if (self.reach.key, units) != self.band_shown:
                self.band_shown = self.reach.key, units
                data["band"] = band_data(band, units)
        self.plot.draw(data)

    def drag(self, event: dict[str, Any]) -> None:
        """Move a handle."""
        number = int(event["number"])
        try:
            text = self.page.state.text
            if not event.get("back"):
                load, friction = self._place(event)
                text = moved(
                    text, self._specification(), self.page.answer.design, event["id"], load, friction
                )
        except InvalidInput as error:
            self.plot.refuse(number, str(error))
            return
        self.requests[self.page.edit(text, released=bool(event["released"]))] = number

    def add(self, event: dict[str, Any]) -> None:
        """Add a point."""

    def remove(self, event: dict[str, Any]) -> None:
        """Remove a point."""

    def cursor(self, event: dict[str, Any]) -> None:
        """Show the contacts at another load."""
        load, _ = self._units().rescaled(float(event["x"]), 0.0)
        if math.isfinite(load) and load > 0.0:
            self.page.look(load=load)

    def _units(self) -> Units:
        return Units.of(self.page.answer, self.page.state.newtons)

    def _place(self, event: dict[str, Any]) -> tuple[float, float]:
        return self._units().rescaled(float(event["x"]), float(event["y"]))

    def _specification(self) -> Specification:
        """Return what the text of the shown state says."""
        text = self.page.state.text
        if self.read is None or self.read[0] != text:
            self.read = text, specification_of(self.page.state)
        return self.read[1]
