"""Only the newest request is answered."""

import asyncio
import threading

import pytest

from metafem.explorer import newest
from metafem.explorer.newest import Newest, all_told, in_words, prepared
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
        requests = Newest(work, answers.append, failures_of_none)
        requests.put(1)
        await asyncio.to_thread(started.wait, 10.0)
        for number in range(2, 20):
            requests.put(number)
        go.set()
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert answers == [1, 19]


def test_a_long_computation_ends_at_its_next_step(monkeypatch):
    monkeypatch.setattr(newest, "PATIENCE", 0.0)
    started, go, answers, steps = threading.Event(), threading.Event(), [], []

    def work(number):
        started.set()
        go.wait(10.0)
        with doing("a step"):
            steps.append(number)
        return number

    async def run():
        requests = Newest(work, answers.append, failures_of_none)
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
    monkeypatch.setattr(newest, "PATIENCE", 0.0)
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

        requests = Newest(
            work, answers.append, failures_of_none,
            patience=lambda running, waiting: 60.0 if waiting < 4 else newest.PATIENCE,
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
    monkeypatch.setattr(newest, "REST", 0.0)
    started, go, found = threading.Event(), threading.Event(), []

    def work(request):
        if request == "whole":
            started.set()
            go.wait(10.0)
        with doing("a step"):
            return request

    async def run():
        requests = Newest(
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
        requests = Newest(work, answers.append, lambda request, error: failures.append((request, str(error))))
        for number in (1, 2):
            requests.put(number)
            while requests.running:
                await asyncio.sleep(0)

    asyncio.run(run())
    assert failures == [(1, "of the first")]
    assert answers == [2]
    assert "ZeroDivisionError" in caplog.text
    assert __file__ in caplog.text


def test_a_listener_that_fails_leaves_the_others_alone(caplog):
    told = []

    def failing(value):
        raise KeyError(value)

    words = all_told([told.append, failing, told.append], 3)
    assert told == [3, 3]
    assert words == in_words(KeyError(3))
    assert "not of your input: KeyError: 3. The terminal" in words
    assert "KeyError" in caplog.text
    assert all_told([told.append], 4) == ""


def test_an_error_of_a_preparation_is_told_as_one_of_its_listener(caplog):
    told = []
    listeners = [
        prepared(lambda value: 1 / value, lambda value, found: told.append((value, found)), value)
        for value in (2, 0)
    ]
    assert "ZeroDivisionError" in all_told(listeners, 2)
    assert told == [(2, 0.5)]


def test_the_step_that_is_computed_is_known():
    steps = []

    async def run():
        requests = Newest(lambda number: number, lambda _: steps.append(requests.step), failures_of_none)

        def work(number):
            with doing("searching the order"):
                return number

        requests.work = work
        requests.put(1)
        while requests.running:
            await asyncio.sleep(0)

    asyncio.run(run())
    assert steps == ["searching the order"]
