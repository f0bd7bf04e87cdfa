"""The head of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def header_panel(page: Page) -> None:
    """Make the name of the design, and the buttons for undo and redo."""
    with ui.row():
        ui.label("metafem")
        ui.button("Undo", on_click=page.undo).props("flat dense no-caps")
        ui.button("Redo", on_click=page.redo).props("flat dense no-caps")
