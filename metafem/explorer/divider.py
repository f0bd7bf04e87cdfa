"""The movable line between the plots and the workshop."""

from __future__ import annotations

from nicegui.element import Element


class Divider(Element, component="divider.js"):
    """Element that the user drags to set the height of the workshop; the browser stores the height."""
