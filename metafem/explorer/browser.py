"""What the browser keeps of a page: the history, for the time that its tab is open."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

from nicegui import background_tasks
from nicegui.element import Element

from metafem.explorer.session import Session
from metafem.explorer.text.link import link_of
from metafem.explorer.turns import Turns


class Browser(Element, component="browser.js"):
    """Reads the history and the address when the page has opened, and keeps each later state.

    The fragment of the address is the link of the state that is shown. A page without a server says so.
    """

    def __init__(
        self, restored: Callable[[Any], Awaitable[None]], linked: Callable[[str], Awaitable[None]]
    ) -> None:
        super().__init__()
        self.turns = Turns()
        self.parts: dict[int, dict[int, str]] = {}
        self.told: dict[str, Callable[[Any], Awaitable[None]]] = {"stored": restored, "linked": linked}
        self.on("part", lambda event: self._part(event.args))

    async def _part(self, part: dict[str, Any]) -> None:
        """Take a part of what the browser tells; large messages come in several, in any order."""
        parts = self.parts.setdefault(part["number"], {})
        parts[part["i"]] = part["text"]
        if len(parts) == part["count"]:
            del self.parts[part["number"]]
            text = "".join(parts[i] for i in range(len(parts)))
            await self.told[part["name"]](await asyncio.to_thread(json.loads, text))

    def keep(self, session: Session, asked: int) -> None:
        """Keep the state that a history shows, its place, and the number of its request."""
        state, first, at = session.state, session.first, session.at
        place = {"first": first, "end": first + len(session.states), "at": first + at, "asked": asked}

        def kept() -> dict[str, Any]:
            return {**place, "state": state.to_json(), "link": link_of(state)}

        background_tasks.create(self.turns.take(kept, self._keep))

    def busy(self, busy: bool) -> None:
        """Tell the browser whether a change is computed."""
        self.run_method("wait", busy)

    def _keep(self, kept: dict[str, Any]) -> None:
        self.run_method("keep", kept)
