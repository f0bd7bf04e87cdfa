"""The specification as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nicegui.element import Element

from metafem.explorer.answer import Answer
from metafem.explorer.following import Follower
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
        self.follower = Follower(page, PACE, _contents, self._show, lambda: self.open)
        self.editor.on("opened", self._opened)
        self.editor.on("closed", self._closed)
        self.editor.on("changed", lambda event: self._changed(**event.args))
        self.editor.on("load", lambda event: load(page, event.args["files"]))
        self.editor.on("demo", lambda event: page.alter(text=demo_text(event.args["name"]), tables={}))

    def _opened(self) -> None:
        self.open = True
        self.follower.put(self.page.answer)

    def _closed(self) -> None:
        self.open = False

    async def _changed(self, text: str) -> None:
        if text != self.page.state.text:
            await self.follower.change(self.page.alter(text=text))

    def _show(self, found: dict[str, Any]) -> None:
        self.editor.run_method("show", found)


def _contents(answer: Answer) -> dict[str, Any]:
    """Return the text of an answer, its problems with their lines, and the names of its tables."""
    state = answer.state
    problems = placed(state.text, answer.problems, answer.refusal)
    return {"text": state.text, "problems": problems, "tables": list(state.tables)}


async def load(page: Page, files: list[dict[str, Any]]) -> None:
    """Show the specification in loaded files, or a message why they cannot be used."""
    given = [Given(**each) for each in files]
    await page.told(
        page.turns.take(
            lambda: loaded(page.state, given),
            lambda state: page.change(text=state.text, tables=state.tables),
        )
    )


def editor_panel(page: Page) -> None:
    """Create the text editor of the specification."""
    Specification(page)
