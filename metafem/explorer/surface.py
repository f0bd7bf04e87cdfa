"""The panel that shows the surface."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from metafem.explorer.answer import Answer
from metafem.explorer.contact_data import contact_data, press_data
from metafem.explorer.control import Control, Panel, Widget
from metafem.explorer.history import State
from metafem.explorer.queue import Queue
from metafem.explorer.surface_data import edited, layout_data, message_data, site_data
from metafem.explorer.table import Table
from metafem.inversion import Design

# An answer, and whether its contacts at all loads are computed, or those at the load of its state.
Request = tuple[Answer, bool]


class SurfaceView(Widget, component="static/surface_view.js"):
    """Draws the data of `site_data`, `contact_data` and `press_data`."""


class SurfacePanel(Panel):
    """The pictures of the surface: sends changed data to the browser, heights first and contacts second."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.view = SurfaceView(sites=self._edit, colour=self._colour)
        self.contacts: Queue[Request, Callable[[], None]] = Queue(
            self._contacts, lambda show: show(), lambda _, error: page.wrong(error), better=self._pressed_of
        )
        self.pressed: Design | None = None
        self.layout: dict[str, Any] = {}
        self.shown: tuple[Design | None, str] = (None, "")
        self.sensitive = False

    def prepare(self, answer: Answer) -> dict[str, Any]:
        """Return the surface data of an answer that differ from the data shown."""
        shown = answer.design, answer.state.text
        again = all(one is other for one, other in zip(shown, self.shown, strict=True))
        data = message_data(answer) if again else site_data(answer)
        design = answer.design
        layout = {} if design is None else layout_data(design)
        if layout and layout != self.layout:
            data["layout"] = layout
        return data

    def show(self, answer: Answer, data: dict[str, Any]) -> None:
        """Show the surface of an answer."""
        if "height" in data:
            self.pressed = None
        self.layout = data.get("layout", self.layout)
        if answer.design is not None:
            self.contacts.put((answer, False))
        self.shown = answer.design, answer.state.text
        self.view.call("show", data)

    def _contacts(self, request: Request) -> Callable[[], None]:
        """Return a function that shows the contacts of a request."""
        answer, pressed = request
        design = answer.design
        assert design is not None
        if pressed:
            return partial(self._press, design, press_data(design))
        return partial(self.view.call, "contact", contact_data(design, answer.state.load, self.sensitive))

    def _press(self, design: Design, data: dict[str, Any]) -> None:
        if design is self.shown[0]:
            self.pressed = design
            self.view.call("pressed", data)

    def _pressed_of(self, request: Request) -> Request | None:
        """Return the request for the contacts at all loads, which follows when the surface stays as it is."""
        answer, pressed = request
        return None if pressed or answer.draft or answer.design is self.pressed else (answer, True)

    async def _edit(self, given: Any) -> None:
        """Fix, empty or release sites, as chosen in the menu."""

        def change(state: State) -> Table:
            return edited(state.table, self.page.answer.design, given)

        await self.page.told(self.page.make(change))

    def _colour(self, given: Any) -> None:
        self.sensitive = given == "sensitivity"
        if self.sensitive and self.page.answer.design is not None:
            self.contacts.put((self.page.answer, False))
