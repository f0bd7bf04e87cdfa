"""The dialog for a new part."""

from __future__ import annotations

import asyncio
from functools import cached_property, partial

import rtoml
from nicegui import ui

from metafem.explorer.control import Control
from metafem.explorer.text.document import Document
from metafem.explorer.workshop.new_part import new_part
from metafem.explorer.workshop.part_fields import FIELDS, FIRST, Collision, Typed, filled, told


class NewPart:
    """A dialog with the fields of a new part."""

    def __init__(self, page: Control) -> None:
        self.page = page

    def open(self, _: object) -> None:
        """Open the dialog with the values of the part that is shown."""
        specification = self.page.answer.specification
        values = FIRST if specification is None else filled(specification)
        self.dialog.open()
        for name, field in self.fields.items():
            field.value = values[name]
        self._show()

    @cached_property
    def dialog(self) -> ui.dialog:
        """The dialog, which is created when it is first opened."""
        with ui.dialog().props('aria-labelledby="new-part"') as dialog, ui.card().classes("new-part"):
            ui.html("<h2 id='new-part'>New part</h2>", sanitize=False)
            ui.label(
                "The lattice fills the block, and the alignment caps and the offset follow. A number without "
                "a unit has the one beside it. Undo restores the present part."
            ).classes("quiet small")
            with ui.element("div").classes("values"):
                self.fields = {
                    field.name: ui.input(field.label, value=field.first)
                    .props(f'dense outlined no-error-icon hide-bottom-space suffix="{field.unit}"')
                    .on("keydown.enter", self.make)
                    for field in FIELDS
                }
            self.kept = ui.checkbox("Keep the target law that is shown instead of a friction coefficient")
            self.kept.props("dense")
            self.fields["coefficient"].bind_enabled_from(self.kept, "value", lambda kept: not kept)
            self.words = ui.label().classes("warn").props('role="status"')
            self.offers = ui.element("div").classes("row")
            with ui.element("div").classes("row"):
                self.button = ui.button("Make it", on_click=self.make).props("no-caps unelevated")
                ui.button("Cancel", on_click=dialog.close).props("no-caps flat")
        return dialog

    @property
    def typed(self) -> dict[str, str]:
        """The texts of the fields, and the target of the state if it is kept."""
        target = Document(self.page.state.text).value("target") if self.kept.value else None
        law = "" if target is None else rtoml.dumps({"target": target})
        return {name: field.value for name, field in self.fields.items()} | {"law": law}

    async def make(self) -> None:
        """Show the part as one step of the history, or the values that collide."""
        self.button.props("loading")
        try:
            text = await asyncio.to_thread(new_part, self.typed, self.page.state.tables)
        except Collision as error:
            self._show(error)
            return
        finally:
            self.button.props(remove="loading")
        self._show()
        if self.dialog.value:  # otherwise it was cancelled
            self.dialog.close()
            await self.page.alter(text=text, load=None)

    def _show(self, error: Collision | None = None) -> None:
        """Mark the field of an error, and show the offers of the error as buttons."""
        words, offers = str(error or ""), error.offers if error else ()
        for field in FIELDS:
            wrong = error is not None and field.name == error.field
            self.fields[field.name].props(f":error={str(wrong).lower()}")
            words = f"{field.told(self.typed[field.name])}: {words}" if wrong else words
        self.words.text = f"{words[:1].upper()}{words[1:]}"
        self.words.set_visibility(error is not None)
        self.offers.clear()
        with self.offers:
            for offer in offers:
                ui.button(told(offer), on_click=partial(self.use, offer)).props("no-caps outline")

    async def use(self, offer: Typed) -> None:
        """Type the values of an offer, and make the part."""
        for name in self.fields.keys() & offer.keys():
            self.fields[name].value = offer[name]
        self.kept.value = self.kept.value and "law" not in offer
        await self.make()
