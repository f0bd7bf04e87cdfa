"""Storage in the browser: the history of a page, as long as its tab is open."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

from metafem.explorer.session import Session
from metafem.explorer.text.link import to_link
from metafem.explorer.widget import Widget

Handler = Callable[[Any], Awaitable[None]]


class Browser(Widget, component="browser.js", esm={"metafem-page": "js"}):
    """Element that reads the stored history and the address when the page opens, and stores each later state.

    The fragment of the address is a link to the current state. The element also shows a message while the
    connection to the server is lost. Its methods are ``keep``, which stores a record of the current state,
    and ``asks`` with the number of the last change, to which the pictures are not yet the answer.
    """

    def __init__(self, restored: Handler, linked: Handler) -> None:
        super().__init__(part=self._part)
        self.parts: dict[int, dict[int, str]] = {}
        self.told: dict[str, Handler] = {"stored": restored, "linked": linked}

    async def _part(self, part: dict[str, Any]) -> None:
        """Collect the parts of a message, which can arrive in any order; handle the complete message."""
        parts = self.parts.setdefault(part["number"], {})
        parts[part["i"]] = part["text"]
        if len(parts) == part["count"]:
            del self.parts[part["number"]]
            text = "".join(parts[i] for i in range(len(parts)))
            await self.told[part["name"]](await asyncio.to_thread(json.loads, text))


def record_of(session: Session) -> dict[str, Any]:
    """Return the current state of a history with its link, and its number among those of the history."""
    state, first = session.state, session.first
    place = {"first": first, "end": first + len(session.states), "at": first + session.at}
    return {**place, "state": state.to_json(), "link": to_link(state)}
