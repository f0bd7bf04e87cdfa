"""The panel of the fields."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from nicegui import ui
from nicegui.element import Element

from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.text.fields import with_field
from metafem.explorer.text.kinds import with_target_kind
from metafem.explorer.workshop.changes import with_choice, with_section, without_section
from metafem.explorer.workshop.form import contents, form
from metafem.files import Specification
from metafem.inversion import Design

if TYPE_CHECKING:
    from metafem.explorer.page import Page

# Seconds between two refreshes while a point is dragged: the law and the heights go first.
PACE = 0.2


class Fields(Element, component="fields.js"):
    """The fields of `form`, which emit what is typed and chosen."""

    def __init__(self) -> None:
        super().__init__()
        self._props["columns"] = form()


class Workshop:
    """The fields of a page: they follow its answers, and change its specification."""

    def __init__(self, page: Page) -> None:
        self.page, self.fields = page, Fields()
        self.asked = 0
        self.shown: dict[str, Any] = {}
        self.waiting: Answer | None = None
        on = self.fields.on
        on("typed", lambda event: self._typed(**event.args))
        on("kind", lambda event: self._kind(event.args["section"], event.args["kind"]))
        on("choice", lambda event: self._choice(event.args["section"], event.args["choice"]))
        on("with", lambda event: self._change(with_section, event.args["section"]))
        on("without", lambda event: self._change(without_section, event.args["section"]))
        self.timer = ui.timer(PACE, self._refresh, active=False)
        page.listen(self._answered)
        page.listen_warnings(self._warned)

    def _typed(self, key: str, text: str, released: bool) -> None:
        self._change(with_field, key, text, key=key, released=released)

    async def _kind(self, section: str, kind: str) -> None:
        """Change the kind of a section; a target of another kind is near the present law."""
        if not kind:
            self._change(without_section, section)
        elif section == "target":
            text, answer = self.page.state.text, self.page.answer
            given = text, answer.specification, answer.design, kind
            found = await self.page.in_thread(_near, *given)
            if self.page.state.text == text:
                self._change(lambda _, __: found, "target.kind")
        else:
            self._typed(f"{section}.kind", kind, True)

    def _choice(self, section: str, choice: int) -> None:
        """Change how a section is given; a text with problems has examples instead of its own law."""
        try:
            specification = specification_of(self.page.state) if section == "target" else None
        except InvalidInput:
            specification = None
        self._change(with_choice, section, choice, specification)

    def _change(
        self, change: Callable[..., str], *given: Any, key: str | None = None, released: bool = True
    ) -> None:
        key = given[0] if key is None else key
        try:
            text = change(self.page.state.text, *given)
        except InvalidInput as error:
            self.fields.run_method("refuse", {"key": key, "words": str(error)})
            return
        self.shown.pop("values", None)  # the browser shows what was typed, which the answer may not hold
        self.asked = self.page.edit(text, released=released)

    def _answered(self, answer: Answer) -> None:
        """Keep the newest answer; what is older than the last change of a field is not shown."""
        self.waiting = answer if answer.number >= self.asked else self.waiting
        if self.waiting is not None and not self.timer.active:
            self._refresh()
            self.timer.activate()

    def _warned(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings that belong to fields."""
        warnings = {key: texts for key, texts in places.items() if "." in key}
        if warnings != self.shown.get("warnings", {}):
            self.shown["warnings"] = warnings
            self.fields.run_method("show", {"warnings": warnings})

    def _refresh(self) -> None:
        answer, self.waiting = self.waiting, None
        if answer is None:
            self.timer.deactivate()
            return
        found = contents(answer.state.text, answer.problems)
        changed = {name: value for name, value in found.items() if self.shown.get(name) != value}
        if changed:
            self.shown |= changed
            self.fields.run_method("show", changed)


def _near(text: str, specification: Specification | None, design: Design | None, kind: str) -> str:
    """Return the text with a target of another kind, near the law of a design where one is found."""
    try:
        return with_target_kind(text, specification, design, kind)
    except MetafemError:
        return with_field(text, "target.kind", kind)


def workshop_panel(page: Page) -> None:
    """Make the fields of the specification."""
    Workshop(page)
