"""The panel of the surface."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.newest import Newest, in_words
from metafem.explorer.surface.contact_data import contact_data
from metafem.explorer.surface.edits import edited
from metafem.explorer.surface.surface_data import layout_data, message, same_layout, site_data
from metafem.explorer.surface.surface_view import SurfaceView
from metafem.inversion import Design
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.explorer.page import Page

STYLE = Path(__file__).with_name("surface.css")


class Views:
    """The pictures of a page's surface: sends what has changed, the contacts after the heights."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.view = SurfaceView()
        self.contacts: Newest[Answer, dict[str, Any]] = Newest(
            self._contacts, self.view.contact, self._failed
        )
        self.template: Surface | None = None
        self.shown: tuple[Design | None, str] = (None, "")
        self.sensitive = False
        self.view.on_event("sites", self._edit)
        self.view.on_event("colour", self._colour)
        page.listen(self.show)

    def show(self, answer: Answer) -> None:
        """Show the surface of an answer."""
        shown = answer.design, answer.state.text
        again = all(one is other for one, other in zip(shown, self.shown, strict=True))
        data = {"number": answer.number, "message": message(answer)} if again else site_data(answer)
        if answer.design is not None:
            if self.template is None or not same_layout(self.template, answer.design.template):
                data["layout"] = layout_data(answer.design)
            self.template = answer.design.template
            self.contacts.put(answer)
        self.shown = shown
        self.view.show(data)

    def _contacts(self, answer: Answer) -> dict[str, Any]:
        assert answer.design is not None
        return contact_data(answer.design, answer.state.load, self.sensitive)

    def _failed(self, answer: Answer, error: Exception) -> None:
        """Say that the contacts are not known."""
        with self.view:
            ui.notify(in_words(error), type="negative", multi_line=True, close_button="Close", timeout=0)

    def _edit(self, given: Any) -> None:
        """Keep heights or empty sites, as the menu says."""
        try:
            self.page.edit(edited(self.page.state.text, self.page.answer.design, given))
        except InvalidInput as error:
            ui.notify(str(error), type="warning")

    def _colour(self, given: Any) -> None:
        self.sensitive = given == "sensitivity"
        if self.sensitive and self.page.answer.design is not None:
            self.contacts.put(self.page.answer)


def surface_panel(page: Page) -> None:
    """Make the map and the picture in three dimensions."""
    ui.add_css(STYLE.read_text("utf-8"))
    Views(page)
