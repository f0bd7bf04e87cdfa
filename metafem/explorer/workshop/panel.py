"""The panel of the fields."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping
from typing import TYPE_CHECKING, Any

from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.following import Follower
from metafem.explorer.session import State
from metafem.explorer.text.fields import with_field
from metafem.explorer.workshop.changes import with_choice, with_section, without_section
from metafem.explorer.workshop.form import contents, form

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
        self.shown: dict[str, Any] = {}
        on = self.fields.on
        on("typed", lambda event: self._typed(**event.args))
        on("kind", lambda event: self._kind(event.args["section"], event.args["kind"]))
        on("choice", lambda event: self._choice(event.args["section"], event.args["choice"]))
        on("with", lambda event: self._change(event.args["section"], with_section))
        on("without", lambda event: self._change(event.args["section"], without_section))
        self.follower = Follower(page, PACE, _contents, self._show)
        page.listen_warnings(self._warned)

    async def _typed(self, key: str, text: str, released: bool) -> None:
        await self._change(key, with_field, text, released=released)

    async def _kind(self, section: str, kind: str) -> None:
        """Change the kind of a section; a target of another kind is near the present law."""
        if section == "target":
            await self._made("target.kind", self.page.choose_kind(kind))
        elif kind:
            await self._typed(f"{section}.kind", kind, True)
        else:
            await self._change(section, without_section)

    async def _choice(self, section: str, choice: int) -> None:
        """Change how a section is given."""
        await self._made(section, self.page.make(_given_by, section, choice))

    async def _change(self, key: str, change: Callable[..., str], *given: Any, released: bool = True) -> None:
        make = self.page.make(lambda state: change(state.text, key, *given), released=released)
        await self._made(key, make)

    async def _made(self, key: str, change: Coroutine[Any, Any, int | None]) -> None:
        """Make a change, or say at its field why it cannot be made."""
        self.shown.pop("values", None)  # the browser shows what was typed, which the answer may not hold
        try:
            await self.follower.change(change)
        except InvalidInput as error:
            self.fields.run_method("refuse", {"key": key, "words": str(error)})

    def _warned(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings that belong to fields."""
        warnings = {key: texts for key, texts in places.items() if "." in key}
        if warnings != self.shown.get("warnings", {}):
            self._show({"warnings": warnings})

    def _show(self, found: Mapping[str, Any]) -> None:
        """Show what has changed."""
        changed = {name: value for name, value in found.items() if self.shown.get(name) != value}
        if changed:
            self.shown |= changed
            self.fields.run_method("show", changed)


def _contents(answer: Answer) -> dict[str, Any]:
    return contents(answer.state.text, answer.reasons)


def _given_by(state: State, section: str, choice: int) -> str:
    """Return the text with another choice of keys; one with problems has examples instead of its own law."""
    try:
        specification = specification_of(state) if section == "target" else None
    except InvalidInput:
        specification = None
    return with_choice(state.text, section, choice, specification)


def workshop_panel(page: Page) -> None:
    """Make the fields of the specification."""
    Workshop(page)
