"""Storage in the browser: the history of a page, as long as its tab is open."""

from __future__ import annotations

from typing import Any

from nicegui.element import Element

from metafem.explorer.session import Session
from metafem.explorer.text.link import link_of


class Browser(Element, component="browser.js"):
    """Element that reads the stored history and the address when the page opens, and stores each later state.

    The fragment of the address is a link to the current state. The element also shows a message while the
    connection to the server is lost. It emits ``stored`` with the history, and ``linked`` with another link.
    """

    def asks(self, number: int) -> None:
        """Tell the browser the number of the last change, to which the pictures are not yet the answer."""
        self.run_method("asks", number)

    def keep(self, record: dict[str, Any]) -> None:
        """Store in the browser a record of the current state."""
        self.run_method("keep", record)


def record_of(session: Session) -> dict[str, Any]:
    """Return the current state of a history with its link, and its number among those of the history."""
    state, first = session.state, session.first
    place = {"first": first, "end": first + len(session.states), "at": first + session.at}
    return {**place, "state": state.to_json(), "link": link_of(state)}
