"""The panel of the law: what hands do becomes edits, and answers are drawn."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.law.beside import Beside
from metafem.explorer.law.dropped import Measured, as_target, read_points
from metafem.explorer.law.kinds import with_kind
from metafem.explorer.law.law_data import band_data, law_data
from metafem.explorer.law.law_plot import LawPlot
from metafem.explorer.law.nearest import with_nearest
from metafem.explorer.law.reach import Reach
from metafem.explorer.law.shown import Units
from metafem.explorer.law.tools import tools_data
from metafem.explorer.text.handles import added, handles, moved, removed
from metafem.files import Specification
from metafem.inversion import Design

if TYPE_CHECKING:
    from metafem.explorer.page import Page

STYLE = Path(__file__).with_name("law.css")

Event = dict[str, Any]


def law_panel(page: Page) -> None:
    """Make the plot of the law."""
    ui.add_css(STYLE.read_text("utf-8"))
    LawPanel(page)


def telling(handler: Callable[[LawPanel, Event], None]) -> Callable[[LawPanel, Event], None]:
    """Return an event handler that says below the plot why an event changed nothing."""

    @wraps(handler)
    def handle(panel: LawPanel, event: Event) -> None:
        try:
            handler(panel, event)
        except InvalidInput as error:
            panel.plot.say(str(error), wrong=True)

    return handle


class LawPanel:
    """The plot of one page."""

    def __init__(self, page: Page) -> None:
        self.page = page
        events = (
            "drag",
            "add",
            "remove",
            "cursor",
            "nearest",
            "kind",
            "axes",
            "model",
            "block",
            "dropped",
            "measured",
        )
        self.plot = LawPlot(**{name: getattr(self, f"on_{name}") for name in events})
        self.reach = Reach()
        self.band_shown: Any = None
        self.measured = Measured()
        self.beside = Beside(page.tasks, self.plot.more)
        # numbers of the page's requests, and of the plot's that they belong to
        self.requests: dict[int, int] = {}
        # what the text of the shown state says, with its design: every step of a drag begins from them
        self.base: tuple[str, Specification, Design | None] | None = None
        self.refused: Answer | None = None
        page.listen(self.show)
        page.listen_late(self.beside.put)

    def show(self, answer: Answer) -> None:
        """Draw an answer."""
        of_plot = [number for number in self.requests if number <= answer.number]
        request = max((self.requests.pop(number) for number in of_plot), default=None)
        specification, text = answer.specification, answer.state.text
        if specification is not None and text == self.page.state.text:
            self.base = text, specification, answer.design
        if answer.nearest_target is not None:
            self.refused = answer
        points = handles(text, specification, answer.design)
        data = law_data(answer, points, request)
        units = Units.of(answer, answer.state.newtons)
        data["tools"] = tools_data(answer, self.beside.block)
        data["measured"] = self.measured.data(answer, units)
        if specification is not None:
            band = self.reach.of(specification)
            if (self.reach.key, units) != self.band_shown:
                self.band_shown = self.reach.key, units
                data["band"] = None if band is None else band_data(band, units)
        self.plot.draw(data)
        if self.measured.problem:
            self.plot.say(self.measured.problem, wrong=True)
        self.beside.put(answer)

    def on_drag(self, event: Event) -> None:
        """Move a handle."""
        number = int(event["number"])
        try:
            text = self.page.state.text
            if not event.get("back"):
                _, specification, design = self._base()
                text = moved(text, specification, design, event["id"], *self._place(event))
        except InvalidInput as error:
            self.plot.refuse(number, str(error))
            return
        self.requests[self.page.edit(text, released=bool(event["released"]))] = number

    @telling
    def on_add(self, event: Event) -> None:
        """Add a point."""
        text, specification, _ = self._base()
        self.page.edit(added(text, specification, *self._place(event)))

    @telling
    def on_remove(self, event: Event) -> None:
        """Remove a point."""
        text, specification, _ = self._base()
        self.page.edit(removed(text, specification, event["id"]))

    def on_cursor(self, event: Event) -> None:
        """Show the contacts at another load."""
        load, _ = self._units().rescaled(float(event["x"]), 0.0)
        if math.isfinite(load) and load > 0.0:
            self.page.look(load=load)

    @telling
    def on_nearest(self, event: Event) -> None:
        """Take the nearest law of the last refusal as the target."""
        if self.refused is not None:
            self.page.edit(with_nearest(self.refused))

    @telling
    def on_kind(self, event: Event) -> None:
        """Take a target of another kind."""
        answer = self.page.answer
        # after a drag that was not released, the text is still that of the state
        self.page.edit(with_kind(replace(answer, state=self.page.state), event["kind"]))

    def on_axes(self, event: Event) -> None:
        """Show newtons or rescaled values."""
        self.page.look(newtons=bool(event["newtons"]))

    def on_model(self, event: Event) -> None:
        """Show the law under another model, or no longer."""
        rest = tuple(name for name in self.page.state.models if name != event["name"])
        self.page.look(models=(*rest, str(event["name"])) if event["on"] else rest)

    @telling
    def on_block(self, event: Event) -> None:
        """Start the law under the block, or stop or hide it."""
        design = self.page.answer.design
        if event["on"] and design is not None:
            self.beside.block.start(design)
        else:
            self.beside.block.stop()

    @telling
    def on_dropped(self, event: Event) -> None:
        """Show the points of a table."""
        design = self.page.answer.design
        if design is None:
            raise InvalidInput("measured points can be shown once the specification has a design")
        name, text = str(event["name"]), str(event["text"])
        found = read_points(name, text, design.template.material, design.template.friction)
        self.page.change(measured=text, measured_name=name)
        self.plot.say(" ".join([f"{len(found.load)} points of {name} are shown.", *found.remarks]))

    @telling
    def on_measured(self, event: Event) -> None:
        """Take the measured points as the target, or remove them."""
        if event["action"] == "remove":
            self.page.change(measured="", measured_name="")
        elif self.measured.points is not None:
            answer = replace(self.page.answer, state=self.page.state)
            self.page.edit(as_target(answer, self.measured.points))

    def _units(self) -> Units:
        return Units.of(self.page.answer, self.page.state.newtons)

    def _place(self, event: Event) -> tuple[float, float]:
        return self._units().rescaled(float(event["x"]), float(event["y"]))

    def _base(self) -> tuple[str, Specification, Design | None]:
        """Return the text of the shown state, what it says, and the design from which a drag begins."""
        state = self.page.state
        if self.base is None or self.base[0] != state.text:
            self.base = state.text, specification_of(state), self.page.answer.design
        return self.base
