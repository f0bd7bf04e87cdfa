"""The panel with the fields of the specification."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.control import Control, Panel, Widget
from metafem.explorer.fields import shown, with_field
from metafem.explorer.history import State
from metafem.explorer.kinds import KINDS, with_choice, with_kind, with_section, without_section
from metafem.explorer.table import Document, form_of, label_of, on_page, order_of, title_of
from metafem.files import KeyForm, SectionForm, section_forms

# First sections of the form, as a designer needs them; the model is in the header of the page.
FIRST = ("target", "lattice", "limits", "friction", "material", "block", "contact", "contact.cap", "tools")

# Sections that are open on a new page.
OPEN = FIRST[:3]

# Further explanations of keys, for readers who do not know the terms of the short meaning.
FURTHER = {
    "target.rescaled_load": "P/E* is the load divided by the composite modulus, an area.",
    "target.rescaled_friction": "F/(σB) is the friction force divided by the shear strength and the area "
    "ratio, an area.",
    "material.composite_modulus": "E* is that of the surface against a rigid plane; it is measured, or "
    "follows from Young's modulus E and Poisson's ratio ν.",
    "friction.shear_strength": "It is measured: the friction force of a contact divided by its area. Without "
    "it laws are designed as areas.",
    "friction.area_ratio": "It is measured: contacts shrink when they are sheared.",
    "limits.offset": "It lifts all summits above the base plane, which then is touched at a larger load.",
    "limits.height_sd": "It is assessed, not designed for: the band about the law and How sure follow from "
    "it.",
    "part.chord_error": "Solids have flat triangles: this is how far they may lie below the round caps.",
}


def form() -> list[dict[str, Any]]:
    """Return the sections of the form with their fields, which the browser needs only once."""
    forms = section_forms()
    return [_section(forms[name]) for name in dict.fromkeys((*FIRST, *forms)) if name != "model"]


def _section(section: SectionForm) -> dict[str, Any]:
    name = section.name
    bare = not section.kinds and not any(key.needed for key in section.every)
    return vars(section) | {
        "title": title_of(name),
        "inner": _inner(name),
        "open": name in OPEN,
        # Whether the fields are shown even if the specification does not have the section.
        "always": not section.optional or bare or bool(section.kinds),
        "kind_names": {kind: KINDS[kind][0] for kind in section.kinds} if name == "target" else {},
        "keys": {
            kind: [_field(name, key) for key in keys if key.value != "section"]
            for kind, keys in section.keys.items()
        },
    }


def _inner(name: str) -> dict[str, str] | None:
    """Return the key ``kind`` of the outer section and its kind that allows an inner section, or None."""
    outer, _, key = name.rpartition(".")
    form = form_of(outer)
    kinds = [] if form is None else [kind for kind in form.kinds if key in order_of(outer, kind)]
    return {"key": f"{outer}.kind", "kind": kinds[0]} if kinds else None


def _field(section: str, key: KeyForm) -> dict[str, Any]:
    name = f"{section}.{key.name}"
    example, default = shown(key.example), _default(key)
    return {each: getattr(key, each) for each in ("value", "units", "names", "listed", "choice")} | {
        "key": name,
        "label": label_of(name),
        "help": _help(name, key.meaning, default, example),
        "example": example,
        "default": default,
        "placeholder": default or ("" if key.optional else example),
        "options": _options(key, default),
    }


def _help(name: str, meaning: str, default: str, example: str) -> str:
    """Return what a key means, its default and an example, as sentences."""
    label = label_of(name)
    meaning = re.sub("^(either|or|with it): ", "", meaning)
    parts = [f"{label[:1].upper()}{label[1:]} ({name}): {meaning}{'' if meaning[-1:] in '.!?' else '.'}"]
    parts += [f"{word}: {value}." for word, value in (("Default", default), ("Example", example)) if value]
    return " ".join([*parts, FURTHER.get(name, "")]).rstrip()


def _options(key: KeyForm, default: str) -> list[tuple[str, str]]:
    """Return the values among which a key is chosen, with their words; "" is the default."""
    names = {"true": "yes", "false": "no"} if key.value == "truth" else {name: name for name in key.names}
    if names and key.optional:
        names = {"": f"default ({names[default]})" if default in names else "default"} | names
    return list(names.items())


def _default(key: KeyForm) -> str:
    """Return the default of a key as text; a quantity with the default 0 has the unit of its example."""
    text = shown(key.default)
    return f"0 {key.example.partition(' ')[2]}" if key.value == "quantity" and text == "0" else text


def contents(text: str, problems: Mapping[str, str]) -> dict[str, Any]:
    """Return the contents of the fields for the text of a specification, and its problems by key.

    Examples
    --------
    >>> found = contents('[limits]\\nmax_height = "120"', {"limits.max_height": "needs a unit"})
    >>> found["values"], found["present"]
    ({'limits.max_height': '120'}, ['limits'])
    """
    try:
        document = Document(text)
    except InvalidInput as error:
        return {"broken": "; ".join(map(str, error.problems)) or str(error), "problems": {}}
    tables = {name: document.value(name) for name in section_forms()}
    present = [name for name, table in tables.items() if isinstance(table, dict)]
    values = {
        f"{section}.{name}": shown(value)
        for section in present
        for name, value in tables[section].items()
        if not isinstance(value, dict)
    }
    return {"broken": "", "values": values, "present": present, "problems": dict(problems)}


class Fields(Widget, component="static/fields.js"):
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
