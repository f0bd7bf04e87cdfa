"""The panel that says how sure the design is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nicegui import ui

if TYPE_CHECKING:
    from metafem.explorer.page import Page


def certainty_panel(page: Page) -> None:
    """Make the figures of the design's errors."""
    ui.label("How sure")
