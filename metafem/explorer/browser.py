"""What the browser keeps of a page: the history, for the time that its tab is open."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui.element import Element

from metafem.explorer.session import Session


class Browser(Element, component="browser.js"):
    """Reads the history from the browser when the page has opened, and keeps each later one."""

    def __init__(self, restored: Callable[[str], None]) -> None:
        super().__init__()
        self.on("stored", lambda event: restored(_text(event.args)))

    def keep(self, session: Session, number: int) -> None:
        """Keep a history in the browser, and the number of the request for its newest state."""
        self.run_method("keep", session.to_json(), number)


def _text(given: Any) -> str:
    return given if isinstance(given, str) else ""
