"""The tour of the page."""

from __future__ import annotations

from nicegui.element import Element


class Tour(Element, component="tour.js"):
    """Explains parts of the page in five steps, after the event ``metafem-tour`` of the window."""
