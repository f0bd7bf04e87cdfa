"""What follows the answers at its own pace."""

import asyncio
from types import SimpleNamespace

import pytest

from metafem.errors import InvalidInput
from metafem.explorer import newest
from metafem.explorer.answer import Answer
from metafem.explorer.following import Follower
from metafem.explorer.session import State


class Page:
    """What a follower needs of a page."""

    def __init__(self):
        self.listeners = []
        self.answer = Answer(0, State(""))

    def listen(self, listener):
        """Keep a listener."""
        self.listeners.append(listener)

    def not_shown(self, request, error):
        """Fail: no preparation of these tests has an error."""
        raise AssertionError(request) from error

    def tell(self, number):
        """Tell an answer."""
        self.answer = Answer(number, State(""))
        for listener in self.listeners:
            listener(self.answer)


async def shown(follower):
    """Wait until all is shown."""
    while follower.newest.running:
        await asyncio.sleep(0)


def scene(**given):
    """Return a page, a follower of it and what that shows."""
    page, told = Page(), []
    return page, Follower(page, 0.0, lambda answer: answer.number, told.append, **given), told


def test_all_that_wait_while_it_rests_are_replaced_by_the_last(monkeypatch):
    async def run():
        rests, go = [], asyncio.Event()

        async def rest(seconds):
            rests.append(seconds)
            await go.wait()

        monkeypatch.setattr(newest, "asyncio", SimpleNamespace(**{**vars(asyncio), "sleep": rest}))
        page, told = Page(), []
        follower = Follower(page, 0.2, lambda answer: answer.number, told.append)
        page.tell(1)
        while not rests:
            await asyncio.sleep(0)
        for number in range(2, 9):
            page.tell(number)
        assert told == [1]
        go.set()
        await shown(follower)
        return told, rests

    assert asyncio.run(run()) == ([1, 8], [0.2, 0.2])


def test_answers_before_the_last_change_are_not_shown():
    async def run():
        page, follower, told = scene()

        async def change():
            page.tell(3)  # an answer to an older state comes while the change is computed
            return 5

        assert await follower.change(change()) == 5
        for number in (4, 5, 6):
            page.tell(number)
            await shown(follower)
        return told

    assert asyncio.run(run()) == [5, 6]


def test_the_present_answer_is_shown_again_where_another_change_replaced_one():
    async def run():
        page, follower, told = scene()
        page.tell(3)
        await shown(follower)

        async def replaced():
            return None

        await follower.change(replaced())
        await shown(follower)
        return told

    assert asyncio.run(run()) == [3, 3]


@pytest.mark.parametrize("late", [False, True])
def test_a_refused_change_shows_only_what_came_meanwhile(late):
    async def run():
        page, follower, told = scene()
        page.tell(3)
        await shown(follower)

        async def refused():
            if late:
                page.tell(4)
            raise InvalidInput("no")

        with pytest.raises(InvalidInput, match="no"):
            await follower.change(refused())
        await shown(follower)
        return told

    assert asyncio.run(run()) == ([3, 4] if late else [3])


def test_nothing_is_prepared_while_it_is_not_seen():
    async def run():
        seen = []
        page, follower, told = scene(seen=lambda: bool(seen))
        page.tell(1)
        await shown(follower)
        seen.append("opened")
        follower.put(page.answer)
        await shown(follower)
        return told

    assert asyncio.run(run()) == [1]
