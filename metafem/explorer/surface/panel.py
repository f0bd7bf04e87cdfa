"""The panel that shows the surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from metafem.explorer.answer import Answer, pinned_answer
from metafem.explorer.newest import Newest
from metafem.explorer.session import State
from metafem.explorer.surface.contact_data import contact_data
from metafem.explorer.surface.edits import edited
from metafem.explorer.surface.surface_data import (
    difference,
    layout_data,
    message_data,
    same_layout,
    site_data,
)
from metafem.explorer.surface.surface_view import SurfaceView
from metafem.inversion import Design
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.explorer.page import Page

STYLE = Path(__file__).with_name("surface.css")


class Views:
    """The pictures of the surface: sends changed data to the browser, heights first and contacts second."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.view = SurfaceView()
        self.contacts: Newest[Answer, dict[str, Any]] = Newest(
            self._contacts, self.view.contact, page.not_shown
        )
        self.template: Surface | None = None
        self.shown: tuple[Design | None, str] = (None, "")
        self.sensitive = False
        self.view.on_event("sites", self._edit)
        self.view.on_event("colour", self._colour)
        page.listen_prepared(self.prepared, self.show)

    def prepared(self, answer: Answer) -> dict[str, Any]:
        """Return the surface data of an answer that differ from the data shown."""
        shown = answer.design, answer.state.text
        again = all(one is other for one, other in zip(shown, self.shown, strict=True))
        data = message_data(answer) if again else site_data(answer)
        design = answer.design
        if design is not None and (self.template is None or not same_layout(self.template, design.template)):
            data["layout"] = layout_data(design)
        return data

    def show(self, answer: Answer, data: dict[str, Any]) -> None:
        """Show the surface of an answer."""
        if answer.design is not None:
            self.template = answer.design.template
            self.contacts.put(answer)
        self.shown = answer.design, answer.state.text
        self.view.show(data)

    def _contacts(self, answer: Answer) -> dict[str, Any]:
        assert answer.design is not None
        pinned = pinned_answer(answer.state.pinned)
        found = contact_data(answer.design, answer.state.load, self.sensitive)
        return found | {"difference": difference(answer.design, None if pinned is None else pinned.design)}

    async def _edit(self, given: Any) -> None:
        """Fix, empty or release sites, as chosen in the menu."""

        def change(state: State) -> str:
            return edited(state.text, self.page.answer.design, given)

        await self.page.told(self.page.make(change))

    def _colour(self, given: Any) -> None:
        self.sensitive = given == "sensitivity"
        if self.sensitive and self.page.answer.design is not None:
            self.contacts.put(self.page.answer)


def surface_panel(page: Page) -> None:
    """Create the map and the three-dimensional picture."""
    ui.add_css(STYLE.read_text("utf-8"))
    Views(page)
