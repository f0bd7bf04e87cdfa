"""The element that shows the surface in the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import json
from nicegui.element import Element


class SurfaceView(Element, component="surface_view.js", esm={"metafem-surface": "js"}):
    """Draws the data of `site_data` and `contact_data`, and emits ``sites`` and ``colour``."""

    def on_event(self, name: str, handler: Callable[[Any], Any]) -> None:
        """Call a function with the data of an event."""
        self.on(name, lambda event: handler(event.args))

    def show(self, data: dict[str, Any]) -> None:
        """Draw the sites of an answer."""
        self._call("show", data)

    def contact(self, data: dict[str, Any]) -> None:
        """Draw the contacts at a load."""
        self._call("contact", data)

    def _call(self, name: str, data: dict[str, Any]) -> None:
        # as a statement, which the browser reads once; `run_method` lets it read thousands of numbers twice
        self.client.run_javascript(f"runMethod({self.id}, {name!r}, [{json.dumps(data)}])")
