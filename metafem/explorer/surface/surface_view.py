"""The browser element that draws the surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import json
from nicegui.element import Element


class SurfaceView(Element, component="surface_view.js", esm={"metafem-surface": "js"}):
    """Draws the data of `site_data`, `contact_data` and `press_data`.

    It emits the events ``sites`` and ``colour``.
    """

    def on_event(self, name: str, handler: Callable[[Any], Any]) -> None:
        """Call `handler` with the data of each event of this name."""
        self.on(name, lambda event: handler(event.args))

    def show(self, data: dict[str, Any]) -> None:
        """Draw the sites of an answer."""
        self._call("show", data)

    def contact(self, data: dict[str, Any]) -> None:
        """Draw the contacts at a load."""
        self._call("contact", data)

    def press(self, data: dict[str, Any]) -> None:
        """Take the contacts at several loads, between which the browser moves."""
        self._call("pressed", data)

    def _call(self, name: str, data: dict[str, Any]) -> None:
        # the browser parses a statement once, but the thousands of numbers in a `run_method` call twice
        self.client.run_javascript(f"runMethod({self.id}, {name!r}, [{json.dumps(data)}])")
