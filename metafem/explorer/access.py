"""Who may see the page: programs of this machine that know the token in its address."""

from __future__ import annotations

from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

# An ASGI application and its parts.
Scope = dict[str, Any]

REFUSED = "This page needs the token in the address that `metafem explore` printed. Open that address."


class Guard:
    """Middleware that refuses requests without the token, from other origins, and for other hosts.

    A page of a foreign origin could otherwise send requests to the loopback address, also by a name of its
    own that it resolves to it. The first page sets a cookie with the token, which its further requests carry.
    """

    def __init__(self, app: Any, token: str, port: int) -> None:
        self.app, self.token, self.cookie = app, token, f"metafem-{port}"
        self.hosts = {f"127.0.0.1:{port}", f"localhost:{port}"}

    async def __call__(self, scope: Scope, receive: Any, send: Any) -> None:
        """Pass an allowed request on, and refuse any other."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        given = parse_qs(scope.get("query_string", b"").decode("latin-1")).get("token", [""])[0]
        if not self._allowed(headers, given):
            await _refuse(scope, receive, send)
        elif given and scope["type"] == "http" and scope["path"] == "/":
            await self.app(scope, receive, self._with_cookie(send))
        else:
            await self.app(scope, receive, send)

    def _allowed(self, headers: dict[str, str], given: str) -> bool:
        from secrets import compare_digest

        origin = headers.get("origin", "").partition("://")[2]
        if headers.get("host") not in self.hosts or (origin and origin not in self.hosts):
            return False
        try:
            kept = SimpleCookie(headers.get("cookie", "")).get(self.cookie)
        except CookieError:
            kept = None
        tokens = [given.encode(), b"" if kept is None else kept.value.encode()]
        return any(compare_digest(each, self.token.encode()) for each in tokens)

    def _with_cookie(self, send: Any) -> Any:
        async def sending(message: dict[str, Any]) -> None:
            if message["type"] == "http.response.start":
                text = f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Strict"
                message = {**message, "headers": [*message["headers"], (b"set-cookie", text.encode())]}
            await send(message)

        return sending


async def _refuse(scope: Scope, receive: Any, send: Any) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008})
        return
    body = REFUSED.encode()
    head = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode())]
    await send({"type": "http.response.start", "status": 403, "headers": head})
    await send({"type": "http.response.body", "body": body})
