"""Storage in the browser: the history of a page, as long as its tab is open."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

from nicegui import background_tasks
from nicegui.element import Element

from metafem.explorer.session import Session
from metafem.explorer.text.link import to_link
from metafem.explorer.turns import Turns


class Browser(Element, component="browser.js"):
    """Element that reads the stored history and the address when the page opens, and stores each later state.

    The fragment of the address is a link to the current state. The element also shows a message while the
    connection to the server is lost.
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
        """Collect the parts of a message, which can arrive in any order; handle the complete message."""
        parts = self.parts.setdefault(part["number"], {})
        parts[part["i"]] = part["text"]
        if len(parts) == part["count"]:
            del self.parts[part["number"]]
            text = "".join(parts[i] for i in range(len(parts)))
            await self.told[part["name"]](await asyncio.to_thread(json.loads, text))

    def keep(self, session: Session, asked: int) -> None:
        """Store in the browser the current state, its position in the history, and its request number."""
        state, first, at = session.state, session.first, session.at
        place = {"first": first, "end": first + len(session.states), "at": first + at, "asked": asked}

        def kept() -> dict[str, Any]:
            return {**place, "state": state.to_json(), "link": to_link(state)}

        background_tasks.create(self.turns.take(kept, self._keep))

    def busy(self, busy: bool) -> None:
        """Tell the browser whether a change is being computed."""
        self.run_method("wait", busy)

    def _keep(self, kept: dict[str, Any]) -> None:
        self.run_method("keep", kept)
