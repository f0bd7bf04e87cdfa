"""Changes are made in their order, and only the newest request is answered, off the event loop."""

import asyncio
import threading

import pytest

from metafem.errors import InvalidInput
from metafem.explorer import queue as module
from metafem.explorer.queue import Dropped, Queue
from metafem.progress import doing


def failures_of_none(request, error):
    """Fail: no request of these tests has an error."""
    raise AssertionError(request) from error


def test_requests_that_wait_are_replaced_by_newer_ones():
    started, go, answers = threading.Event(), threading.Event(), []

    def work(number):
        started.set()
        go.wait(10.0)
        return number

    async def run():
        requests = Queue(work, answers.append, failures_of_none)
        requests.put(1)
        await asyncio.to_thread(started.wait, 10.0)
        for number in range(2, 20):
            requests.put(number)
        go.set()
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert answers == [1, 19]


def test_a_stopped_computation_is_not_waited_for_and_ends_at_its_next_step():
    started, go, ended, answers, steps = threading.Event(), threading.Event(), threading.Event(), [], []

    def work(number):
        if number > 1:
            return number
        started.set()
        try:
            go.wait(10.0)
            with doing("a step"):
                steps.append(number)
        finally:
            ended.set()
        return number

    async def run():
        requests = Queue(work, answers.append, failures_of_none)
        number = await requests.change(lambda: 1, lambda number, request: requests.put(request))
        await asyncio.to_thread(started.wait, 10.0)
        requests.stop()
        requests.put(2)
        while requests.running:
            await asyncio.sleep(0)
        told = list(answers)
        go.set()
        await asyncio.to_thread(ended.wait, 10.0)
        return number, told

    assert asyncio.run(run()) == (1, [2])
    assert (answers, steps) == ([2], [])


def test_a_long_computation_ends_at_its_next_step(monkeypatch):
    monkeypatch.setattr(module, "PATIENCE", 0.0)
    started, go, answers, steps = threading.Event(), threading.Event(), [], []

    def work(number):
        started.set()
        go.wait(10.0)
        with doing("a step"):
            steps.append(number)
        return number

    async def run():
        requests = Queue(work, answers.append, failures_of_none)
        requests.put(1)
        await asyncio.to_thread(started.wait, 10.0)
        requests.put(2)
        go.set()
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert answers == steps == [2]


def test_a_computation_with_patience_is_shown_although_newer_requests_come(monkeypatch):
    """A drag asks faster than a large surface is designed: what waits for patience is seen all the same."""
    monkeypatch.setattr(module, "PATIENCE", 0.0)
    answers = []

    async def run():
        loop = asyncio.get_running_loop()

        def work(number):
            if number < 5:
                loop.call_soon_threadsafe(requests.put, number + 1)
                while requests.waiting is None:
                    pass
            with doing("a step"):
                return number

        requests = Queue(
            work, answers.append, failures_of_none,
            patience=lambda running, waiting: 60.0 if waiting < 4 else module.PATIENCE,
        )  # fmt: skip
        requests.put(1)
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert answers == [1, 2, 5]


@pytest.mark.parametrize(
    ("newer", "answers"),
    [((), ["draft", "whole"]), (("same",), ["draft", "whole", "same"]), (("other",), ["draft", "other"])],
)
def test_a_better_answer_is_computed_at_rest_until_something_else_is_asked_for(monkeypatch, newer, answers):
    monkeypatch.setattr(module, "REST", 0.0)
    started, go, found = threading.Event(), threading.Event(), []

    def work(request):
        if request == "whole":
            started.set()
            go.wait(10.0)
        with doing("a step"):
            return request

    async def run():
        requests = Queue(
            work, found.append, failures_of_none,
            patience=lambda running, waiting: 60.0 if waiting == "same" else 0.0,
            better=lambda request: "whole" if request == "draft" else None,
        )  # fmt: skip
        requests.put("draft")
        await asyncio.to_thread(started.wait, 10.0)
        for request in newer:
            requests.put(request)
        go.set()
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert found == answers


def test_an_error_of_the_program_is_told_and_the_next_request_is_answered(caplog):
    answers, failures = [], []

    def work(number):
        if number == 1:
            raise ZeroDivisionError("of the first")
        return number

    async def run():
        requests = Queue(work, answers.append, lambda request, error: failures.append((request, str(error))))
        for number in (1, 2):
            requests.put(number)
            while requests.running:
                await asyncio.sleep(0)

    asyncio.run(run())
    assert failures == [(1, "of the first")]
    assert answers == [2]
    assert "ZeroDivisionError" in caplog.text
    assert __file__ in caplog.text


def test_the_step_that_is_computed_is_known():
    steps = []

    async def run():
        requests = Queue(lambda number: number, lambda _: steps.append(requests.step), failures_of_none)

        def work(number):
            with doing("searching the order"):
                return number

        requests.work = work
        requests.put(1)
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert steps == ["searching the order"]


def requests():
    """Return a queue without requests."""
    return Queue(lambda request: request, lambda answer: None, failures_of_none)


class Text:
    """A text that changes make longer; a change waits until it is let go."""

    def __init__(self):
        self.queue, self.text, self.threads = requests(), "", set()
        self.begun, self.go = asyncio.Event(), threading.Event()
        self.loop = asyncio.get_running_loop()

    def with_letter(self, letter):
        """Return the text with a further letter."""
        before = self.text
        self.threads.add(threading.get_ident())
        self.loop.call_soon_threadsafe(self.begun.set)
        self.go.wait(10.0)
        return before + letter

    def use(self, number, text):
        """Take a text."""
        self.text = text

    def change(self, letter, replaceable=False):
        """Add a letter after the earlier changes."""
        change = self.queue.change(lambda: self.with_letter(letter), self.use, replaceable=replaceable)
        return asyncio.ensure_future(change)


def test_changes_are_made_in_their_order_off_the_event_loop():
    async def run():
        text = Text()
        text.go.set()
        assert await asyncio.gather(*(text.change(letter) for letter in "abc")) == [1, 2, 3]
        return text

    text = asyncio.run(run())
    assert text.text == "abc"
    assert threading.get_ident() not in text.threads


def test_of_replaceable_changes_that_wait_only_the_newest_is_made():
    async def run():
        text = Text()
        changes = [text.change(letter, replaceable=True) for letter in "abc"]
        await text.begun.wait()
        text.go.set()
        return await asyncio.gather(*changes), text.text

    assert asyncio.run(run()) == ([1, None, 3], "ac")


def test_a_change_is_made_although_newer_ones_wait():
    async def run():
        text = Text()
        changes = [text.change("a"), text.change("b"), text.change("c", replaceable=True)]
        text.go.set()
        await asyncio.gather(*changes)
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

        first = asyncio.ensure_future(text.queue.change(work, text.use, replaceable=True))
        await text.begun.wait()
        newer = text.change("b")
        await asyncio.sleep(0)
        text.go.set()
        return await first, await newer

    assert asyncio.run(run()) == (None, 2)
    assert ended == ["dropped"]


def test_an_error_is_that_of_its_change_alone():
    async def run():
        queue, told = requests(), []

        def refuse():
            raise InvalidInput("no")

        refused = queue.change(refuse, lambda *made: told.append(made))
        made = queue.change(lambda: "made", lambda *made: told.append(made))
        return await asyncio.gather(refused, made, return_exceptions=True), told

    (error, _), told = asyncio.run(run())
    assert isinstance(error, InvalidInput)
    assert told == [(2, "made")]


def test_it_is_known_which_changes_have_ended():
    async def run():
        text = Text()
        changes = [text.change(letter) for letter in "ab"]
        await text.begun.wait()
        known = [(text.queue.asked, text.queue.made)]
        text.go.set()
        await asyncio.gather(*changes)
        return [*known, (text.queue.asked, text.queue.made)]

    assert asyncio.run(run()) == [(2, 0), (2, 2)]
