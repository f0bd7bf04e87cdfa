"""The panel of the fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def workshop_panel(page: Page) -> None:
    """Make the fields of the specification."""
    ui.label("Workshop")
