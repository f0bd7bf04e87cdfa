"""The base class of elements with events and many numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nicegui import json
from nicegui.element import Element


class Widget(Element):
    """An element that shows data and emits events; each keyword argument is the handler of an event.

    `props` are data that stay. `shown` are the data that `show` has sent last.
    """

    def __init__(self, props: Mapping[str, Any] | None = None, /, **handlers: Callable[[Any], Any]) -> None:
        super().__init__()
        self._props.update(props or {})
        self.shown: dict[str, Any] = {}
        for name, handler in handlers.items():
            self.on(name, lambda event, handler=handler: handler(event.args))

    def show(self, data: Mapping[str, Any]) -> None:
        """Call the method ``show`` of the element in the browser with the data that have changed."""
        new = {
            name: value for name, value in data.items() if name not in self.shown or self.shown[name] != value
        }
        self.shown |= new
        if new:
            self.call("show", new)

    def call(self, method: str, *given: Any) -> None:
        """Call a method of the element in the browser."""
        if self.is_deleted:  # the page was closed
            return
        # the browser parses a statement once, but the thousands of numbers in a `run_method` call twice
        self.client.run_javascript(f"runMethod({self.id}, {method!r}, {json.dumps(given)})")
