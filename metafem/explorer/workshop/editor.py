"""The specification as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def editor_panel(page: Page) -> None:
    """Make the editor of the text."""
    ui.label("Specification")
