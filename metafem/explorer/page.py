"""The page: its layout, and what its panels are connected to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from nicegui import ui
from nicegui.element import Element

from metafem.explorer.certainty import Certainty, place_warnings
from metafem.explorer.control import Control, Panel
from metafem.explorer.editor import Specification, uploader
from metafem.explorer.files import Taking
from metafem.explorer.form import Workshop
from metafem.explorer.header import Header
from metafem.explorer.history import State
from metafem.explorer.law import LawPanel
from metafem.explorer.surface import SurfacePanel

# The tabs beside the pictures.
TABS: Mapping[str, Callable[[Control], Panel]] = {
    "Workshop": Workshop,
    "Specification": Specification,
    "How sure": Certainty,
    "Take it": Taking,
}


def build(first: State) -> None:
    """Create the elements of a page that begins with a state."""
    ui.add_css(Path(__file__).parent / "static" / "page.css")
    page = Control(first)
    Header(page)
    uploader(page)
    with ui.element().classes("explorer"):
        with _part("law", "Law"):
            LawPanel(page)
            place_warnings(page, "law")
        with _part("surface", "Surface"):
            SurfacePanel(page)
            place_warnings(page, "surface")
        with _part("inspector", "Inspector"):
            look = 'dense no-caps align=left outside-arrows mobile-arrows aria-label="Inspector"'
            with ui.tabs().props(look) as tabs:
                for name in TABS:
                    ui.tab(name)
            with ui.tab_panels(tabs, value=next(iter(TABS)), animated=False) as panels:
                panels.props("keep-alive").classes("panels")
                made: dict[str, Panel] = {}
                for name, kind in TABS.items():
                    with ui.tab_panel(name):
                        made[name] = kind(page)
                tabs.on_value_change(lambda event: made[event.value].opened())


def _part(name: str, label: str) -> Element:
    """Return a section of the page that can receive the keyboard focus from a skip link."""
    return ui.element("section").classes(name).props(f'aria-label="{label}" tabindex=-1')
