"""The panel with the fields of the specification, which are those of its pydantic models."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, specification_of
from metafem.explorer.control import Control, Panel
from metafem.explorer.fields import shown
from metafem.explorer.history import State
from metafem.explorer.kinds import KINDS, with_kind_near, with_units
from metafem.explorer.table import (
    Table,
    section_of,
    title_of,
    value_of,
    with_field,
    with_section,
    without_section,
)
from metafem.files import Form, section_forms

# First sections of the form, as a designer needs them; the model is in the header of the page.
FIRST = ("target", "lattice", "limits", "friction", "material", "block", "contact", "contact.cap", "tools")

# Sections that are open on a new page.
OPEN = FIRST[:3]


def form(forms: Mapping[str, Form] | None = None) -> list[dict[str, Any]]:
    """Return the sections of the form with their fields; default: those of all specifications."""
    forms = section_forms() if forms is None else forms
    return [_section(name, forms) for name in dict.fromkeys((*FIRST, *forms)) if name != "model"]


def _section(name: str, forms: Mapping[str, Form]) -> dict[str, Any]:
    section = forms[name]
    fields = {
        kind: [_field(f"{name}.{key['name']}", key) for key in keys if key["value"] != "section"]
        for kind, keys in section["keys"].items()
    }
    # a section inside another one is shown if that one is of the kind that has it
    outer, _, last = name.rpartition(".")
    inner = [
        {"key": f"{outer}.kind", "kind": kind}
        for kind, keys in forms.get(outer, {"keys": {}})["keys"].items()
        if any(key["name"] == last for key in keys)
    ]
    bare = not any(key["needed"] for keys in section["keys"].values() for key in keys)
    return section | {
        "title": title_of(name),
        "inner": next(iter(inner), None),
        "open": name in OPEN,
        # whether the fields are shown even if the specification does not have the section
        "always": bool(not section["optional"] or bare or section["kinds"]),
        "kind_names": {kind: KINDS[kind][0] for kind in section["kinds"]} if name == "target" else {},
        "keys": fields,
    }


def _field(name: str, key: Form) -> dict[str, Any]:
    """Return what the browser shows of a key: label, explanation, example, default and choices."""
    label, example, default = title_of(name), shown(key["example"]), shown(key["default"])
    default = f"{default} {key['unit']}" if default and key["value"] == "quantity" else default
    meaning = re.sub("^(either|or|with it): ", "", key["meaning"]).removesuffix(".")
    words = [f"{label[:1].upper()}{label[1:]} ({name}): {meaning}."]
    words += [f"{word}: {value}." for word, value in (("Default", default), ("Example", example)) if value]
    names = (
        {"true": "yes", "false": "no"} if key["value"] == "truth" else {each: each for each in key["names"]}
    )
    if names and key["optional"]:
        names = {"": f"default ({names[default]})" if default in names else "default"} | names
    return {each: key[each] for each in ("units", "listed", "choice")} | {
        "key": name,
        "label": label,
        "help": " ".join(words),
        "example": example,
        "placeholder": default or ("" if key["optional"] else example),
        "options": list(names.items()),
    }


def contents(state: State, problems: Mapping[str, str]) -> dict[str, Any]:
    """Return the contents of the fields for a state, and its problems by key.

    Examples
    --------
    >>> found = contents(State('[limits]\\nmax_height = "120"'), {"limits.max_height": "needs a unit"})
    >>> found["values"], found["present"]
    ({'limits.max_height': '120'}, ['limits'])
    """
    try:
        table = state.table
    except InvalidInput as error:
        return {"broken": "; ".join(map(str, error.problems)), "problems": {}}
    present = [name for name in section_forms() if isinstance(value_of(table, name), dict)]
    values = {
        f"{section}.{name}": shown(value)
        for section in present
        for name, value in section_of(table, section).items()
        if not isinstance(value, dict)
    }
    return {"broken": "", "values": values, "present": present, "problems": dict(problems)}


class Workshop(Panel, component="static/fields.js"):
    """The fields of a page: they show its answers and change its specification."""

    # The plots of the law and the surface have priority while a point is dragged.
    pace = 0.2

    def __init__(self, page: Control) -> None:
        super().__init__(
            page,
            {"parts": form()},
            typed=lambda given: self._typed(**given),
            kind=lambda given: self._kind(**given),
            choice=lambda given: self._choice(**given),
            added=lambda section: self._change(section, with_section),
            removed=lambda section: self._change(section, without_section),
        )
        page.warners.append(self.warn)

    async def _typed(self, key: str, text: str) -> None:
        await self._change(key, with_field, text)

    async def _kind(self, section: str, kind: str) -> None:
        """Change the kind of a section; a target of another kind is close to the current law."""
        if section == "target":
            await self._made(
                "target.kind",
                lambda state: with_kind_near(state, self.page.answer.design, kind),
                replaceable=True,
            )
        elif kind:
            await self._typed(f"{section}.kind", kind)
        else:
            await self._change(section, without_section)

    async def _choice(self, section: str, choice: int) -> None:
        """Change which choice of keys a section uses; the target of a valid specification keeps its law."""

        def given(state: State) -> Table:
            specification = None
            with suppress(InvalidInput):
                specification = specification_of(state)
            return with_units(state, section, choice, specification)

        await self._made(section, given)

    async def _change(self, key: str, change: Callable[..., Table], *given: Any) -> None:
        await self._made(key, lambda state: change(state.table, key, *given))

    async def _made(self, key: str, change: Callable[[State], Table], replaceable: bool = False) -> None:
        """Make a change, or show at its field why the change is impossible."""
        before = self.sent.pop("values", None)  # the browser shows the typed text, which may not be used
        try:
            await self.page.make(change, by=self, replaceable=replaceable)
        except InvalidInput as error:
            self.sent.setdefault("values", before)
            self.call("refuse", {"key": key, "words": str(error)})

    def prepare(self, answer: Answer) -> dict[str, Any]:
        """Return the contents of the fields for an answer."""
        return {**contents(answer.state, answer.problems), "offers": answer.offers}

    def show(self, answer: Answer, data: dict[str, Any]) -> None:
        """Show an answer."""
        self.send(data)

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings for single fields."""
        self.send({"warnings": {key: texts for key, texts in places.items() if "." in key}})
