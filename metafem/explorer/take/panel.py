"""The panel of the files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def take_panel(page: Page) -> None:
    """Make the buttons that download the design."""
    ui.label("Take it")
