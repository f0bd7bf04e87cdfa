"""The specification as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nicegui.element import Element

from metafem.explorer.answer import Answer
from metafem.explorer.workshop.loading import Given, loaded
from metafem.explorer.workshop.places import placed
from metafem.files import DEMOS, demo_text

if TYPE_CHECKING:
    from metafem.explorer.page import Page

# Shortest time between two updates of the text while a point is dragged [s].
PACE = 0.3


class Editor(Element, component="editor.js"):
    """Text editor that marks the problems of the text; emits events for new text, loaded files and demos."""

    def __init__(self) -> None:
        super().__init__()
        self._props["demos"] = list(DEMOS)


class Specification:
    """The text of the specification of a page; it is updated with each answer while its tab is open."""

    def __init__(self, page: Page) -> None:
        self.page, self.editor = page, Editor()
        self.open = False
        self.asked = 0  # number of the last change by the editor
        page.listen_prepared(self._contents, self._show, PACE)
        self.editor.on("opened", self._opened)
        self.editor.on("closed", self._closed)
        self.editor.on("changed", lambda event: self._changed(**event.args))
        self.editor.on("load", lambda event: load(page, event.args["files"]))
        self.editor.on("demo", lambda event: page.alter(text=demo_text(event.args["name"]), tables={}))

    def _opened(self) -> None:
        self.open = True
        self.page.again()

    def _closed(self) -> None:
        self.open = False

    async def _changed(self, text: str) -> None:
        if text != self.page.state.text:
            self.asked = self.page.queue.asked + 1
            await self.page.alter(text=text)

    def _contents(self, answer: Answer) -> dict[str, Any]:
        """Return the text of an answer, its problems with their lines, and the names of its tables."""
        if not self.open:
            return {}
        state = answer.state
        problems = placed(state.text, answer.problems, answer.refusal)
        return {"text": state.text, "problems": problems, "tables": list(state.tables)}

    def _show(self, answer: Answer, found: dict[str, Any]) -> None:
        """Show an answer, unless the browser already shows a newer text."""
        if found and answer.number >= self.asked:
            self.editor.run_method("show", found)


async def load(page: Page, files: list[dict[str, Any]]) -> None:
    """Show the specification in loaded files, or a message why they cannot be used."""
    given = [Given(**each) for each in files]
    await page.told(page.step(lambda state: loaded(state, given)))


def editor_panel(page: Page) -> None:
    """Create the text editor of the specification."""
    Specification(page)
