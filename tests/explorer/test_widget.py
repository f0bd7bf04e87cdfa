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


def test_calls_of_one_step_of_the_event_loop_are_one_message():
    sent = []

    async def scene():
        with Client(page_of("/")) as client:
            one, other = Widget(), Widget()
        client.run_javascript = sent.append
        one.show({"a": 1})
        other.call("draw", [2])
        await asyncio.sleep(0)
        other.call("draw", [3])
        client.delete()
        await asyncio.sleep(0)  # the page was closed before the message was sent
        one.call("draw", [4])
        return one.id, other.id

    one, other = asyncio.run(scene())
    assert len(sent) == 1
    first, second = sent[0].split(";")
    assert f"runMethod({one}, 'show', [{{\"a\":1}}])" in first
    assert f"runMethod({other}, 'draw', [[2]])" in second
