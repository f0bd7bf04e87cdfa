"""The line between the plots and the workshop, which can be moved."""

from __future__ import annotations

from nicegui.element import Element


class Divider(Element, component="divider.js"):
    """Sets the height of the workshop, which the browser keeps."""
