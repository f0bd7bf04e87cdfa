"""The specification as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from nicegui import ui
from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.workshop.loading import Given, loaded
from metafem.explorer.workshop.places import placed
from metafem.files import DEMOS, demo_text

if TYPE_CHECKING:
    from metafem.explorer.page import Page

# Seconds between two refreshes of the text while a point is dragged.
PACE = 0.3


class Editor(Element, component="editor.js"):
    """A text with its problems, which emits what is typed, loaded and chosen."""

    def __init__(self) -> None:
        super().__init__()
        self._props["demos"] = list(DEMOS)


class Specification:
    """The text of a page's specification: it follows the answers while its tab is open."""

    def __init__(self, page: Page) -> None:
        self.page, self.editor = page, Editor()
        self.open = False
        self.asked = 0
        self.waiting: Answer | None = None
        self.editor.on("opened", self._opened)
        self.editor.on("closed", self._closed)
        self.editor.on("changed", lambda event: self._changed(**event.args))
        self.editor.on("load", lambda event: load(page, event.args["files"]))
        self.editor.on("demo", lambda event: page.change(text=demo_text(event.args["name"]), tables={}))
        self.timer = ui.timer(PACE, self._refresh, active=False)
        page.listen(self._answered)

    def _opened(self) -> None:
        self.open = True
        self._show(self.page.answer)

    def _closed(self) -> None:
        self.open = False

    def _changed(self, text: str) -> None:
        if text != self.page.state.text:
            self.asked = self.page.edit(text)

    def _answered(self, answer: Answer) -> None:
        """Keep the newest answer; what is older than the last edit is not shown."""
        if not self.open or answer.number < self.asked:
            return
        self.waiting = answer
        if not self.timer.active:
            self._refresh()
            self.timer.activate()

    def _refresh(self) -> None:
        answer, self.waiting = self.waiting, None
        if answer is None or not self.open:
            self.timer.deactivate()
        else:
            self._show(answer)

    def _show(self, answer: Answer) -> None:
        state = answer.state
        problems = placed(state.text, answer.problems, answer.refusal)
        self.editor.run_method(
            "show", {"text": state.text, "problems": problems, "tables": list(state.tables)}
        )


def load(page: Page, files: list[dict[str, Any]]) -> None:
    """Show the specification of files, or say why they cannot be used."""
    try:
        state = loaded(page.state, [Given(**each) for each in files])
    except InvalidInput as error:
        ui.notify(str(error), type="warning", multi_line=True, close_button="Close", timeout=12000)
        return
    page.change(text=state.text, tables=state.tables)


def editor_panel(page: Page) -> None:
    """Make the editor of the text."""
    Specification(page)
