"""The page: its layout, and what its panels are connected to."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from functools import partial
from pathlib import Path

from nicegui import ui
from nicegui.element import Element

from metafem.explorer.certainty import Certainty, PlaceWarnings
from metafem.explorer.control import Control, Panel
from metafem.explorer.editor import Specification
from metafem.explorer.files import Taking
from metafem.explorer.form import Workshop
from metafem.explorer.header import Header
from metafem.explorer.history import State
from metafem.explorer.law import LawPanel
from metafem.explorer.surface import SurfacePanel


def build(first: State) -> Inspector:
    """Create the elements of a page that begins with a state; return its inspector."""
    ui.add_css(Path(__file__).parent / "static" / "page.css")
    page = Control(first)
    Header(page)
    with ui.element().classes("explorer"):
        with _part("law", "Law"):
            LawPanel(page)
            PlaceWarnings(page, "law")
        with _part("surface", "Surface"):
            SurfacePanel(page)
            PlaceWarnings(page, "surface")
        with _part("inspector", "Inspector"):
            return Inspector(page)


def _part(name: str, label: str) -> Element:
    """Return a section of the page that can receive the keyboard focus from a skip link."""
    return ui.element("section").classes(name).props(f'aria-label="{label}" tabindex=-1')


class Inspector(Panel):
    """The tabs; what a tab holds is created when it is first opened."""

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.late: dict[str, Callable[[], Panel]] = {
            "Workshop": partial(Workshop, page),
            "Specification": partial(Specification, page),
            "How sure": Certainty(page).create,
            "Take it": partial(Taking, page),
        }
        self.made: dict[str, Panel] = {}
        look = 'dense no-caps align=left outside-arrows mobile-arrows aria-label="Inspector"'
        with ui.tabs().props(look) as self.tabs:
            for name in self.late:
                ui.tab(name)
        with ui.tab_panels(self.tabs, value="Workshop", animated=False).props("keep-alive").classes("panels"):
            self.places = {name: ui.tab_panel(name) for name in self.late}
        self.turned("Workshop")
        self.tabs.on_value_change(lambda event: self.turned(event.value))

    def turned(self, name: str) -> Coroutine[object, object, None] | None:
        """Open the panel of a tab, and close the others."""
        if name in self.late:
            with self.places[name]:
                self.made[name] = self.late.pop(name)()
        for each, panel in self.made.items():
            panel.open = each == name
        # before the first request nothing is known, and its answer follows
        return self.page.renew(self.made[name]) if self.page.number else None
