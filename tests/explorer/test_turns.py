"""Changes are made in their order, off the event loop, and a late one overwrites none."""

import asyncio
import threading

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.newest import Dropped
from metafem.explorer.turns import Turns
from metafem.progress import doing


class Text:
    """A text that changes make longer; a change waits until it is let go."""

    def __init__(self):
        self.turns, self.text, self.threads = Turns(), "", set()
        self.begun, self.go = asyncio.Event(), threading.Event()
        self.loop = asyncio.get_running_loop()

    def with_letter(self, letter):
        """Return the text with a further letter."""
        before = self.text
        self.threads.add(threading.get_ident())
        self.loop.call_soon_threadsafe(self.begun.set)
        self.go.wait(10.0)
        return before + letter

    def use(self, text):
        """Take a text."""
        self.text = text
        return len(text)

    def change(self, letter, draft=False):
        """Add a letter in its turn."""
        return asyncio.ensure_future(self.turns.take(lambda: self.with_letter(letter), self.use, draft=draft))

    def aside(self, letter):
        """Add a letter beside the other changes."""
        return asyncio.ensure_future(self.turns.aside(lambda: self.with_letter(letter), self.use))


def test_changes_are_made_in_their_order_off_the_event_loop():
    async def run():
        text = Text()
        text.go.set()
        assert await asyncio.gather(*(text.change(letter) for letter in "abc")) == [1, 2, 3]
        return text

    text = asyncio.run(run())
    assert text.text == "abc"
    assert threading.get_ident() not in text.threads


def test_of_drafts_that_wait_only_the_newest_is_made():
    async def run():
        text = Text()
        changes = [text.change(letter, draft=True) for letter in "abc"]
        await text.begun.wait()
        text.go.set()
        return await asyncio.gather(*changes), text.text

    assert asyncio.run(run()) == ([1, None, 2], "ac")


def test_a_released_change_is_made_although_newer_ones_wait():
    async def run():
        text = Text()
        changes = [text.change("a"), text.change("b"), text.change("c", draft=True)]
        text.go.set()
        await asyncio.gather(*changes)
        return text.text

    assert asyncio.run(run()) == "abc"


@pytest.mark.parametrize("second", ["aside", "change"])
def test_a_late_result_overwrites_no_newer_change(second):
    async def run():
        text = Text()
        first = text.aside("a")
        await text.begun.wait()
        newer = getattr(text, second)("b")
        await asyncio.sleep(0)
        text.go.set()
        return await first, await newer, text.text

    assert asyncio.run(run()) == (None, 1, "b")


def test_a_change_beside_the_others_holds_none_up():
    async def run():
        text = Text()
        text.go.set()
        earlier, aside = text.change("a"), text.aside("b")
        assert (await earlier, await aside, text.text) == (1, 2, "ab")
        held = threading.Event()
        waiting = asyncio.ensure_future(text.turns.aside(lambda: held.wait(10.0), text.use))
        await asyncio.sleep(0)
        assert await text.change("c") == 3
        held.set()
        assert await waiting is None
        return text.text

    assert asyncio.run(run()) == "abc"


def test_a_change_that_is_no_longer_wanted_ends_at_its_next_step():
    ended = []

    async def run():
        text = Text()

        def work():
            text.with_letter("a")
            try:
                with doing("a step"):
                    pass
            except Dropped:
                ended.append("dropped")
                raise

        first = asyncio.ensure_future(text.turns.aside(work, text.use))
        await text.begun.wait()
        newer = text.change("b")
        await asyncio.sleep(0)
        text.go.set()
        return await first, await newer

    assert asyncio.run(run()) == (None, 1)
    assert ended == ["dropped"]


def test_an_error_is_that_of_its_change_alone():
    async def run():
        turns, told = Turns(), []

        def refuse():
            raise InvalidInput("no")

        refused = turns.take(refuse, told.append)
        made = turns.take(lambda: "made", told.append)
        return await asyncio.gather(refused, made, return_exceptions=True), told

    (error, _), told = asyncio.run(run())
    assert isinstance(error, InvalidInput)
    assert told == ["made"]


def test_it_is_told_when_changes_are_under_way():
    told = []

    async def run():
        turns = Turns(told.append)
        await turns.take(lambda: None, told.append, draft=True)
        await asyncio.gather(*(turns.take(lambda: "made", told.append) for _ in range(2)))

    asyncio.run(run())
    assert told == [None, True, "made", "made", False]
