"""Access to the page: only programs on this machine that know the token in its address may open it."""

from __future__ import annotations

from secrets import compare_digest

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocketClose

REFUSED = "This page needs the token in the address that `metafem explore` printed. Open that address."

# Headers of every answer: the browser sends no other page the address, which contains the token, and no other
# page may show this page in a frame.
HEADERS = {"referrer-policy": "no-referrer", "x-frame-options": "DENY"}

POLICY_VIOLATION = 1008  # RFC 6455


class Guard:
    """Middleware that refuses requests without the token, from other origins, and for other hosts.

    The token is the first part of each path. Without these checks a page of another origin could send
    requests to the loopback address, either directly or through its own host name that resolves to that
    address (DNS rebinding).
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self.app, self.token = app, token
        self.hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass an allowed request to the application, and refuse any other request."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
        elif self.allowed(scope):
            await self._answer({**scope, "root_path": f"/{self.token}"}, receive, _with_headers(send))
        elif scope["type"] == "http":
            await PlainTextResponse(REFUSED, 403)(scope, receive, send)
        else:
            await WebSocketClose(POLICY_VIOLATION)(scope, receive, send)

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request to the application; ignore its error if the client has already disconnected."""
        left = False

        async def heard() -> Message:
            nonlocal left
            message = await receive()
            left = left or message["type"] == "http.disconnect"
            return message

        try:
            await self.app(scope, heard, send)
        except RuntimeError:  # Starlette's "No response returned"
            if not left:
                raise

    def allowed(self, scope: Scope) -> bool:
        """Return whether a request has the token and comes from a page of this server or from no page."""
        headers = Headers(scope=scope)
        host, token = headers.get("host", ""), scope["path"].partition("/")[2].partition("/")[0]
        own = host in self.hosts and headers.get("origin", f"http://{host}") == f"http://{host}"
        return own and compare_digest(token.encode(), self.token.encode())


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).update(HEADERS)
        await send(message)

    return sending
