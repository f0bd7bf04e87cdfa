"""The specification as text."""

from __future__ import annotations

from typing import Any

from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.widget import Widget
from metafem.explorer.workshop.loading import load
from metafem.explorer.workshop.places import placed


class Editor(Widget, component="editor.js"):
    """Text editor that marks the problems of the text; emits events when it is ready, and for changes."""


class Specification(Panel):
    """The text of the specification of a page; it is updated with each answer while its tab is open."""

    pace = 0.3

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.editor = Editor(
            ready=lambda _: page.renew(self),
            changed=self._changed,
            load=lambda given: load(page, given["files"]),
        )

    async def _changed(self, text: str) -> None:
        if text != self.page.state.text:
            await self.page.alter(text=text, by=self)

    def prepare(self, answer: Answer) -> dict[str, Any] | None:
        """Return the text of an answer, its problems with their lines, and the names of its tables."""
        if not self.open:
            return None
        state = answer.state
        problems = placed(state.text, answer.problems, answer.refusal)
        return {"text": state.text, "problems": problems, "tables": list(state.tables)}

    def show(self, answer: Answer, data: dict[str, Any] | None) -> None:
        """Show an answer."""
        if data is not None:
            self.editor.call("show", data)
