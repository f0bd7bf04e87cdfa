"""The base class of elements with events and many numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import json
from nicegui.element import Element


class Widget(Element):
    """An element that shows data and emits events; each keyword argument is the handler of an event."""

    def __init__(self, **handlers: Callable[[Any], Any]) -> None:
        super().__init__()
        for name, handler in handlers.items():
            self.on(name, lambda event, handler=handler: handler(event.args))

    def call(self, method: str, *given: Any) -> None:
        """Call a method of the element in the browser."""
        if self.is_deleted:  # the page was closed
            return
        # the browser parses a statement once, but the thousands of numbers in a `run_method` call twice
        self.client.run_javascript(f"runMethod({self.id}, {method!r}, {json.dumps(given)})")
