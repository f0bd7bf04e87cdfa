"""Requests that the server of the explorer answers, and those that it refuses."""

import asyncio
from contextlib import nullcontext

import pytest

from metafem.explorer.access import REFUSED, Guard

HOST, TOKEN = "127.0.0.1:8123", "c0ffee"


def answer(path=f"/{TOKEN}/", kind="http", **headers):
    """Return what an application behind the guard receives, and what is sent."""
    received, sent = [], []

    async def application(scope, receive, send):
        received.append(scope)
        await send({"type": "http.response.start", "status": 200, "headers": []})

    async def receive():
        return {"type": "websocket.connect"}

    async def send(message):
        sent.append(message)

    given = [(name.encode(), value.encode()) for name, value in ({"host": HOST} | headers).items()]
    scope = {"type": kind, "path": path, "headers": given}
    asyncio.run(Guard(application, TOKEN, 8123)(scope, receive, send))
    return received, sent


@pytest.mark.parametrize("headers", [{}, {"origin": f"http://{HOST}"}])
def test_the_token_opens_the_page(headers):
    received, sent = answer(**headers)
    assert received[0]["root_path"] == f"/{TOKEN}"
    assert (b"referrer-policy", b"no-referrer") in sent[0]["headers"]


def test_the_page_has_the_name_of_this_machine_too():
    assert answer(host="localhost:8123", origin="http://localhost:8123")[0]


@pytest.mark.parametrize(
    ("path", "headers"),
    [
        ("/", {}),
        ("*", {}),  # OPTIONS * has no path
        ("/c0ffe/", {}),
        ("/other/c0ffee", {}),
        (f"/{TOKEN}/", {"origin": "https://example.org"}),
        (f"/{TOKEN}/", {"origin": "null"}),
        (f"/{TOKEN}/", {"origin": "http://127.0.0.1:9999"}),
        (f"/{TOKEN}/", {"origin": f"https://{HOST}"}),
        (f"/{TOKEN}/", {"host": "example.org:8123"}),  # a name that its owner points to this machine
        (f"/{TOKEN}/", {"host": "example.org:8123", "origin": "http://example.org:8123"}),
    ],
)
def test_others_are_refused(path, headers):
    received, sent = answer(path, **headers)
    assert received == []
    assert sent[0]["status"] == 403
    assert sent[1]["body"].decode() == REFUSED
    received, sent = answer(path, "websocket", **headers)
    assert received == []
    assert [(each["type"], each["code"]) for each in sent] == [("websocket.close", 1008)]


def test_the_start_of_the_application_passes():
    received, _ = answer(kind="lifespan")
    assert received[0]["type"] == "lifespan"


@pytest.mark.parametrize("left", [True, False])
def test_a_page_that_is_closed_while_it_loads_is_no_error(left):
    async def application(scope, receive, send):
        await receive()
        raise RuntimeError("No response returned.")

    async def receive():
        return {"type": "http.disconnect" if left else "http.request"}

    async def send(message):
        raise AssertionError

    scope = {"type": "http", "path": f"/{TOKEN}/", "headers": [(b"host", HOST.encode())]}
    with nullcontext() if left else pytest.raises(RuntimeError, match="No response"):
        asyncio.run(Guard(application, TOKEN, 8123)(scope, receive, send))
