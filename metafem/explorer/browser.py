"""What the browser keeps of a page: the history, for the time that its tab is open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui.element import Element

from metafem.explorer.session import Session


class Browser(Element, component="browser.js"):
    """Reads the history from the browser when the page has opened, and keeps each later state.

    While there is no server, the page says so.
    """

    def __init__(self, restored: Callable[[Any], None]) -> None:
        super().__init__()
        self.on("stored", lambda event: restored(event.args))

    def keep(self, session: Session, asked: int) -> None:
        """Keep the state that a history shows, its place, and the number of its request."""
        place = {"first": session.first, "end": session.first + len(session.states)}
        at = session.first + session.at
        self.run_method("keep", {**place, "at": at, "state": session.state.to_json(), "asked": asked})
