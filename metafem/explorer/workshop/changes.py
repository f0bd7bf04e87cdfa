"""Changes of a specification by its fields."""

from __future__ import annotations

from typing import Any

from metafem.explorer.text.document import Document
from metafem.explorer.workshop.values import value_of
from metafem.files import KeyForm, SectionForm, section_forms


def with_typed(text: str, key: str, given: str) -> str:
    """Return the text with the value that was typed into the field of a key; an empty one removes the key."""
    document = Document(text)
    section, _, name = key.rpartition(".")
    if name == "kind" and _section(section).kinds:
        return with_kind(text, section, given)
    found = _key(document, section, name)
    return document.with_values({key: value_of(found, given)})


def with_kind(text: str, section: str, kind: str) -> str:
    """Return the text with a section of another kind; its needed keys have examples."""
    return Document(text).with_kind(section, kind)


def with_choice(text: str, section: str, choice: int) -> str:
    """Return the text with the keys of another choice of a section, as examples."""
    document = Document(text)
    keys = _keys(document, section)
    given = document.value(section) or {}
    values = {key.name: key.example for key in keys if key.choice == choice and key.name not in given}
    values |= {key.name: None for key in keys if key.choice not in (None, choice) and key.name in given}
    return document.with_values({f"{section}.{name}": value for name, value in values.items()})


def with_section(text: str, section: str) -> str:
    """Return the text with an optional section, whose needed keys have examples."""
    form = _section(section)
    document = Document(text)
    if form.kinds:
        return document.with_kind(section, next(iter(form.kinds)))
    keys = form.keys[""]
    needed = [key for key in keys if key.needed] or list(keys[:1])
    values: dict[str, Any] = {f"{section}.{key.name}": key.example for key in needed}
    if section == "radii":
        values["lattice.radius"] = None
    if section == "sites":
        values = {"sites.empty": [0]}
    return document.with_values(values)


def without_section(text: str, section: str) -> str:
    """Return the text without an optional section."""
    document = Document(text)
    values: dict[str, Any] = {section: None}
    if section == "radii" and document.value("lattice.radius") is None:
        values["lattice.radius"] = next(
            key.example for key in _section("lattice").keys[""] if key.name == "radius"
        )
    return document.with_values(values)


def _section(name: str) -> SectionForm:
    return next(form for form in section_forms() if form.name == name)


def _keys(document: Document, section: str) -> tuple[KeyForm, ...]:
    """Return the keys of a section of the kind that the text has."""
    form = _section(section)
    kind = document.value(f"{section}.kind") if form.kinds else ""
    return form.keys.get(kind if isinstance(kind, str) else "", ())


def _key(document: Document, section: str, name: str) -> KeyForm:
    return next(key for key in _keys(document, section) if key.name == name)
