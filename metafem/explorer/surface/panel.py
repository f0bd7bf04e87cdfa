"""The panel of the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def surface_panel(page: Page) -> None:
    """Make the views of the surface."""
    ui.label("Surface")
