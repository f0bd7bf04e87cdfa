"""The panel with the fields of the specification."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.control import Control, Panel
from metafem.explorer.session import State
from metafem.explorer.text.fields import with_field
from metafem.explorer.text.kinds import with_kind
from metafem.explorer.text.names import on_page
from metafem.explorer.widget import Widget
from metafem.explorer.workshop.changes import with_choice, with_section, without_section
from metafem.explorer.workshop.form import contents, form


class Fields(Widget, component="fields.js"):
    """The fields of `form`; they emit events when the user types or selects a value."""


class Workshop(Panel):
    """The fields of a page: they show its answers and change its specification."""

    # The plots of the law and the surface have priority while a point is dragged.
    pace = 0.2

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.fields = Fields(
            {"parts": form()},
            typed=lambda given: self._typed(**given),
            kind=lambda given: self._kind(**given),
            choice=lambda given: self._choice(**given),
            added=lambda section: self._change(section, with_section),
            removed=lambda section: self._change(section, without_section),
        )

    async def _typed(self, key: str, text: str, released: bool = True) -> None:
        await self._change(key, with_field, text, released=released)

    async def _kind(self, section: str, kind: str) -> None:
        """Change the kind of a section; a target of another kind is close to the current law."""
        if section == "target":
            await self._made(
                "target.kind", lambda state: with_kind(state, self.page.answer.design, kind), replaceable=True
            )
        elif kind:
            await self._typed(f"{section}.kind", kind)
        else:
            await self._change(section, without_section)

    async def _choice(self, section: str, choice: int) -> None:
        """Change which choice of keys a section uses."""
        await self._made(section, lambda state: _given_by(state, section, choice))

    async def _change(self, key: str, change: Callable[..., str], *given: Any, released: bool = True) -> None:
        await self._made(key, lambda state: change(state.text, key, *given), draft=not released)

    async def _made(self, key: str, change: Callable[[State], str], **how: bool) -> None:
        """Make a change, or show at its field why the change is impossible."""
        shown = self.fields.shown
        before = shown.pop("values", None)  # the browser shows the typed text, which may not be used
        try:
            await self.page.make(change, by=self, **how)
        except InvalidInput as error:
            shown.setdefault("values", before)
            self.fields.call("refuse", {"key": key, "words": on_page(str(error))})

    def prepare(self, answer: Answer) -> dict[str, Any]:
        """Return the contents of the fields for an answer."""
        return {**contents(answer.state.text, answer.reasons), "offers": answer.offers}

    def show(self, answer: Answer, data: dict[str, Any]) -> None:
        """Show an answer."""
        self.fields.show(data)

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings for single fields."""
        self.fields.show({"warnings": {key: texts for key, texts in places.items() if "." in key}})


def _given_by(state: State, section: str, choice: int) -> str:
    """Return the text with another choice of keys; if it has problems, the target becomes an example."""
    specification = None
    with suppress(InvalidInput):
        specification = specification_of(state)
    return with_choice(state.text, section, choice, specification)
