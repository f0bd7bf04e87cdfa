"""What the browser keeps of a page: the history, for the time that its tab is open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.session import Session
from metafem.explorer.text.link import to_link


class Browser(Element, component="browser.js"):
    """Reads the history and the address when the page has opened, and keeps each later state.

    The fragment of the address is the link of the state that is shown. A page without a server says so.
    """

    def __init__(self, restored: Callable[[Any], None], linked: Callable[[str], None]) -> None:
        super().__init__()
        self.on("stored", lambda event: restored(event.args))
        self.on("linked", lambda event: linked(str(event.args)))

    def keep(self, session: Session, asked: int) -> None:
        """Keep the state that a history shows, its place, and the number of its request."""
        place = {"first": session.first, "end": session.first + len(session.states)}
        kept = {"state": session.state.to_json(), "link": link_of(session), "asked": asked}
        self.run_method("keep", {**place, "at": session.first + session.at, **kept})


def link_of(session: Session) -> str:
    """Return the link of the state that is shown; a state that is too large for an address has none."""
    try:
        return to_link(session.state)
    except InvalidInput:
        return ""
