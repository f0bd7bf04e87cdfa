"""The server of the page, on the loopback address: only programs that know its token open it."""

from __future__ import annotations

import asyncio
import gc
import webbrowser
from secrets import compare_digest

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocketClose

from metafem.explorer.history import State

# Time for which the server holds a page after its connection is lost [s]. A later reconnection loads the page
# again, with the state that the browser stored.
RECONNECTION = 10.0

# Interval between checks whether the server has started [s]. The address is printed only after the start.
POLLED = 0.01

# Number of messages that are sent again after a lost connection. A step of a drag sends two of about 20 kB.
HISTORY = 100


def serve(first: State, host: str, token: str, port: int, show: bool) -> None:
    """Serve pages that begin with a state, until Ctrl-C."""
    address = f"http://{host}:{port}/{token}/"
    from nicegui import app, background_tasks, ui
    from nicegui.server import Server

    from metafem.explorer.answer import answered
    from metafem.explorer.page import build

    def root() -> None:
        build(first)

    async def announce() -> None:
        while not Server.instance.started:
            await asyncio.sleep(POLLED)
        print(f"Open {address} in a browser of this machine.\nPress Ctrl-C to end.", flush=True)
        if show:
            webbrowser.open(address)

    async def warm_up() -> None:
        # a draft loads the compiled kernels while the browser loads the page; a design could take long
        await asyncio.to_thread(answered, first, 0, draft=True)
        gc.freeze()  # the modules stay; looking through them for garbage would hold up a drag for .1 s

    app.add_middleware(guarded, token=token, port=port)
    app.on_startup(lambda: background_tasks.create(announce()))
    app.on_startup(lambda: background_tasks.create(warm_up()))
    ui.run(
        root, host=host, port=port, title="metafem", dark=None, language="en-US", reload=False,
        show=False, show_welcome_message=False, favicon="◠", reconnect_timeout=RECONNECTION,
        tailwind=False, message_history_length=HISTORY, binding_refresh_interval=None,
    )  # fmt: skip


REFUSED = "This page needs the token in the address that `metafem explore` printed. Open that address."

# Headers of every answer: the browser sends no other page the address, which contains the token, and no other
# page may show this page in a frame.
HEADERS = {"referrer-policy": "no-referrer", "x-frame-options": "DENY"}

POLICY_VIOLATION = 1008  # RFC 6455


def guarded(app: ASGIApp, token: str, port: int) -> ASGIApp:
    """Return the application behind a guard that refuses requests without the token, or from other origins.

    The token is the first part of each path. Without these checks a page of another origin could send
    requests to the loopback address, either directly or through its own host name that resolves to that
    address (DNS rebinding).
    """
    hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    def allowed(scope: Scope) -> bool:
        headers = Headers(scope=scope)
        host, given = headers.get("host", ""), scope["path"].partition("/")[2].partition("/")[0]
        own = host in hosts and headers.get("origin", f"http://{host}") == f"http://{host}"
        return own and compare_digest(given.encode(), token.encode())

    async def call(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await app(scope, receive, send)
        elif allowed(scope):
            await app({**scope, "root_path": f"/{token}"}, receive, _with_headers(send))
        elif scope["type"] == "http":
            await PlainTextResponse(REFUSED, 403)(scope, receive, send)
        else:
            await WebSocketClose(POLICY_VIOLATION)(scope, receive, send)

    return call


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).update(HEADERS)
        await send(message)

    return sending
