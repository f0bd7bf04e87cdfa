"""Header and fields show what is chosen at once, and the answer to it when it is known."""

import asyncio

from nicegui import Client
from nicegui.page import page as page_of

from metafem.explorer.control import Control
from metafem.explorer.session import State
from metafem.explorer.workshop.header import FIRST, Header
from metafem.explorer.workshop.panel import Workshop
from metafem.files import demo_text

TEXT = demo_text("operating-points")


def run(kind, scene):
    """Run a scene on a panel of a page whose browser does not answer; return what was sent to the browser."""
    sent = []

    async def begun():
        with Client(page_of("/")) as client:
            page = Control(State(TEXT))
            panel = kind(page)
        element = panel.bar if kind is Header else panel.fields
        element.call = lambda method, data: sent.append((method, data))
        await page.alter()
        await shown(page)
        sent.clear()
        await scene(panel)
        await shown(page)
        await asyncio.sleep(0)  # NiceGUI sends what was called before
        client.delete()

    asyncio.run(begun())
    return sent


async def shown(page):
    """Wait until all answers are shown."""
    while page.queue.running:
        await asyncio.sleep(0.001)


def test_a_model_that_was_chosen_is_not_sent_back():
    ((_, data),) = run(Header, lambda header: header._choose("half-space"))
    assert "model" not in data
    assert data["solved"] == "half-space"
    assert data["undo"]


def test_starting_over_is_a_step_of_the_history():
    async def scene(header):
        await header._begin("linear")
        await header._begin("unknown")
        await shown(header.page)
        await header._begin(FIRST)

    first, second = run(Header, scene)
    assert first[1]["title"] != second[1]["title"] == "Friction law through 3 operating points"


def test_warnings_of_the_part_are_in_the_header():
    async def scene(header):
        header.page.warn({"take": ["no part can be made"]})
        header.page.warn({})

    assert run(Header, scene) == [("show", {"part": "no part can be made"}), ("show", {"part": ""})]


def test_a_refused_text_stays_in_its_field_with_the_reason():
    async def scene(fields):
        await fields.page.alter(text="limits = 3\n")
        await shown(fields.page)
        await fields._typed("limits.max_height", "120 um")

    (_, (method, data)) = run(Workshop, scene)
    assert (method, data["key"]) == ("refuse", "limits.max_height")
    assert data["words"].startswith("limits is not a section")


def test_a_field_shows_the_text_that_is_used():
    ((_, data),) = run(Workshop, lambda fields: fields._typed("limits.max_height", "280"))
    assert data["values"]["limits.max_height"] == "280 um"
    ((_, data),) = run(Workshop, lambda fields: fields._kind("target", "linear"))
    assert data["values"]["target.kind"] == "linear"
