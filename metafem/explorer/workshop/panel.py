"""The panel with the fields of the specification."""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.session import State
from metafem.explorer.text.fields import with_field
from metafem.explorer.text.names import on_page
from metafem.explorer.workshop.changes import with_choice, with_section, without_section
from metafem.explorer.workshop.form import contents, form

if TYPE_CHECKING:
    from metafem.explorer.page import Page

# Shortest time between two updates of the fields while a point is dragged [s]. The plots of the law and the
# surface have priority.
PACE = 0.2


class Fields(Element, component="fields.js"):
    """The fields of `form`; they emit events when the user types or selects a value."""

    def __init__(self) -> None:
        super().__init__()
        self._props["parts"] = form()


class Workshop:
    """The fields of a page: they show its answers and change its specification."""

    def __init__(self, page: Page) -> None:
        self.page, self.fields = page, Fields()
        self.shown: dict[str, Any] = {"warnings": {}}
        on = self.fields.on
        on("typed", lambda event: self._typed(**event.args))
        on("kind", lambda event: self._kind(event.args["section"], event.args["kind"]))
        on("choice", lambda event: self._choice(event.args["section"], event.args["choice"]))
        on("with", lambda event: self._change(event.args["section"], with_section))
        on("without", lambda event: self._change(event.args["section"], without_section))
        self.asked = 0  # number of the last change by the fields
        page.listen_prepared(_contents, self._follow, PACE)
        page.listen_warnings(self._warned)

    async def _typed(self, key: str, text: str, released: bool) -> None:
        await self._change(key, with_field, text, released=released)

    async def _kind(self, section: str, kind: str) -> None:
        """Change the kind of a section; a target of another kind is close to the current law."""
        if section == "target":
            await self._made("target.kind", self.page.choose_kind(kind))
        elif kind:
            await self._typed(f"{section}.kind", kind, True)
        else:
            await self._change(section, without_section)

    async def _choice(self, section: str, choice: int) -> None:
        """Change which choice of keys a section uses."""
        await self._made(section, self.page.make(lambda state: _given_by(state, section, choice)))

    async def _change(self, key: str, change: Callable[..., str], *given: Any, released: bool = True) -> None:
        make = self.page.make(lambda state: change(state.text, key, *given), draft=not released)
        await self._made(key, make)

    async def _made(self, key: str, change: Coroutine[Any, Any, int | None]) -> None:
        """Make a change, or show at its field why the change is impossible."""
        shown = self.shown.pop("values", None)  # the browser shows the typed text, which may not be used
        self.asked = self.page.queue.asked + 1
        try:
            await change
        except InvalidInput as error:
            self.shown.setdefault("values", shown)
            self.fields.run_method("refuse", {"key": key, "words": on_page(str(error))})

    def _follow(self, answer: Answer, found: dict[str, Any]) -> None:
        """Show the fields of an answer, unless the browser already shows a newer change of the fields."""
        if answer.number >= self.asked:
            self._show(found)

    def _warned(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings for single fields."""
        self._show({"warnings": {key: texts for key, texts in places.items() if "." in key}})

    def _show(self, found: Mapping[str, Any]) -> None:
        """Send the data that have changed to the browser."""
        changed = {name: value for name, value in found.items() if self.shown.get(name) != value}
        if changed:
            self.shown |= changed
            self.fields.run_method("show", changed)


def _contents(answer: Answer) -> dict[str, Any]:
    return contents(answer.state.text, answer.reasons)


def _given_by(state: State, section: str, choice: int) -> str:
    """Return the text with another choice of keys; if it has problems, the target becomes an example."""
    specification = None
    with suppress(InvalidInput):
        specification = specification_of(state)
    return with_choice(state.text, section, choice, specification)


def workshop_panel(page: Page) -> None:
    """Create the fields of the specification."""
    Workshop(page)
