"""An element gets the data that have changed, and nothing twice."""

import asyncio

from nicegui import Client
from nicegui.page import page as page_of

from metafem.explorer.widget import Widget


def test_only_what_has_changed_is_sent():
    sent = []

    async def scene():
        with Client(page_of("/")) as client:
            widget = Widget({"names": ["a"]})
        widget.call = lambda method, data: sent.append((method, data))
        widget.show({"a": 1, "b": [2]})
        widget.show({"a": 1, "b": [3]})
        widget.show({"b": [3]})
        del widget.shown["a"]  # the browser shows something else
        widget.show({"a": 1, "b": [3]})
        client.delete()
        return widget.props["names"]

    assert asyncio.run(scene()) == ["a"]
    assert sent == [("show", {"a": 1, "b": [2]}), ("show", {"b": [3]}), ("show", {"a": 1})]
