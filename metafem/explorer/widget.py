"""The base class of elements with events and many numbers."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any
from weakref import WeakKeyDictionary

from nicegui import Client, json
from nicegui.element import Element

# Calls that are not sent yet, by the page.
CALLS: WeakKeyDictionary[Client, list[str]] = WeakKeyDictionary()


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
        """Call a method of the element in the browser.

        The calls of one step of the event loop are one message, so that the browser shows them in one frame.
        """
        if self.is_deleted:  # the page was closed
            return
        calls = CALLS.setdefault(self.client, [])
        if not calls:
            asyncio.get_running_loop().call_soon(self._send)
        # the browser parses a statement once, but the thousands of numbers in a `run_method` call twice
        calls.append(f"queueMicrotask(() => runMethod({self.id}, {method!r}, {json.dumps(given)}))")

    def _send(self) -> None:
        calls = CALLS.pop(self.client)
        if not self.is_deleted:
            self.client.run_javascript(";".join(calls))
