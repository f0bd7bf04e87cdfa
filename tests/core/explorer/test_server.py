"""The server of a page: the requests that it answers, and its queue."""

import asyncio
import threading

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.queue import Dropped, Queue
from metafem.explorer.server import REFUSED, guarded
from metafem.progress import doing

OWN, TOKEN = "127.0.0.1:8123", "c0ffee"


def asked(path=f"/{TOKEN}/", kind="http", **headers):
    """Return what an application behind the guard receives, and what is sent."""
    received, sent = [], []

    async def application(scope, receive, send):
        received.append(scope)
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive():
        return {"type": "http.request"}

    async def send(message):
        sent.append(message)

    given = [(name.encode(), value.encode()) for name, value in ({"host": OWN} | headers).items()]
    scope = {"type": kind, "path": path, "headers": given}
    asyncio.run(guarded(application, TOKEN, 8123)(scope, receive, send))
    return received, sent


def test_the_token_opens_the_page_and_nothing_else_does():
    for headers in (
        {},
        {"origin": f"http://{OWN}"},
        {"host": "localhost:8123", "origin": "http://localhost:8123"},
    ):
        received, sent = asked(**headers)
        assert received[0]["root_path"] == f"/{TOKEN}"
        assert (b"referrer-policy", b"no-referrer") in sent[0]["headers"]
    for path, headers in (
        ("/", {}),
        ("*", {}),  # OPTIONS * has no path
        ("/c0ffe/", {}),
        ("/other/c0ffee", {}),
        (f"/{TOKEN}/", {"origin": "null"}),
        (f"/{TOKEN}/", {"origin": "http://127.0.0.1:9999"}),
        (f"/{TOKEN}/", {"origin": f"https://{OWN}"}),
        (f"/{TOKEN}/", {"host": "example.org:8123"}),  # a name that its owner points to this machine
        (f"/{TOKEN}/", {"host": "example.org:8123", "origin": "http://example.org:8123"}),
    ):
        received, sent = asked(path, **headers)
        assert (received, sent[0]["status"], sent[1]["body"].decode()) == ([], 403, REFUSED)
        received, sent = asked(path, "websocket", **headers)
        assert (received, sent[0]["type"], sent[0]["code"]) == ([], "websocket.close", 1008)
    assert asked(kind="lifespan")[0][0]["type"] == "lifespan"


class Held:
    """Work that waits for its step until it is let go."""

    def __init__(self, answers, **options):
        self.started, self.go, self.steps = threading.Event(), threading.Event(), []
        self.failures = []
        self.queue = Queue(
            self.work,
            answers.append,
            lambda request, error: self.failures.append((request, str(error))),
            **options,
        )

    def work(self, request):
        if request == "wrong":
            raise ZeroDivisionError("of it")
        if request != "draft":
            self.started.set()
            self.go.wait(10.0)
        with doing(f"step {request}"):
            self.steps.append((request, self.queue.step))
        return request

    async def put(self, *requests):
        """Put a first request, the others once it has begun, and let all go."""
        self.queue.put(requests[0])
        await asyncio.to_thread(self.started.wait, 10.0)
        for request in requests[1:]:
            self.queue.put(request)
        await self.end()

    async def end(self):
        self.go.set()
        while self.queue.running:
            await asyncio.wait([self.queue.task])


# without patience the first one ends at its next step
@pytest.mark.parametrize(("patience", "answers"), [(60.0, [1, 9]), (0.0, [9])])
def test_the_newest_request_alone_is_answered(patience, answers):
    found = []

    async def scene():
        held = Held(found, patience=lambda running, waiting: patience)
        await held.put(*range(1, 10))
        return held.steps

    steps = asyncio.run(scene())
    assert found == answers
    assert steps == [(each, f"step {each}") for each in answers]


def test_a_better_answer_follows_at_rest_and_an_error_is_told(caplog):
    assert_rested([], 0.0, ["draft", "whole"])
    assert_rested(["same"], 60.0, ["draft", "whole", "same"])
    assert_rested(["other"], 0.0, ["draft", "other"])
    assert_rested(["wrong"], 0.0, ["draft"])
    assert "ZeroDivisionError" in caplog.text


def assert_rested(newer, patience, answers):
    found = []

    async def scene():
        held = Held(found, better={"draft": "whole"}.get, patience=lambda running, waiting: patience)
        held.queue.pause = 0.0
        await held.put("draft", *newer)
        assert held.failures == [("wrong", "of it")] * newer.count("wrong")

    asyncio.run(scene())
    assert found == answers


def test_changes_are_made_in_their_order_and_what_is_replaceable_ends():
    text, ended = [], []

    async def scene():
        begun, go = asyncio.Event(), threading.Event()
        loop, changes = asyncio.get_running_loop(), Queue(lambda request: request, print, print)

        def make(letter):
            loop.call_soon_threadsafe(begun.set)
            go.wait(10.0)
            try:
                with doing("a step"):
                    if letter == "x":
                        raise InvalidInput("no")
                    return letter
            except Dropped:
                ended.append(letter)
                raise

        def change(letter, **how):
            return asyncio.ensure_future(
                changes.change(lambda: make(letter), lambda number, made: text.append((number, made)), **how)
            )

        tasks = [change("a", replaceable=True)]
        await begun.wait()
        tasks += [change("b", replaceable=True), change("x"), change("c", replaceable=True)]
        await asyncio.sleep(0)
        known = changes.asked, changes.made
        go.set()
        return known, await asyncio.gather(*tasks, return_exceptions=True), changes.made

    known, (first, second, error, last), made = asyncio.run(scene())
    assert (known, made) == ((4, 0), 4)
    assert (first, second, str(error), last) == (None, None, "no", 4)
    assert (text, ended) == ([(4, "c")], ["a"])
