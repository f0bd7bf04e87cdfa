"""Values of a specification as the form shows them, and as the user types them."""

from __future__ import annotations

import json
import re
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.names import form_of
from metafem.files import KeyForm, SectionForm, toml_table

# A decimal number without a digit before or after the point; TOML does not accept this form.
SHORT_NUMBER = re.compile(r"[+-]?(\d+\.|\.\d+)")

# A number with a decimal comma. A comma before three digits can also separate thousands, except after a zero.
DECIMAL_COMMA = re.compile(r"(?<![\w.^,])([+-]?(?:0+,\d+|\d+,(?!\d{3}(?!\d))\d+))(?![\d,])")

# Separators of the entries of a list. Lists of integers (rows and columns) also accept spaces, a cross, or
# an x that is not part of a word.
SEPARATORS = re.compile(r"[,;\n]")
CROSS = re.compile(r"[,;\s×]|(?<![^\W\d])[xX](?![^\W\d])")

# Brackets around a group of entries, such as a pair.
GROUPS = re.compile(r"\[[^\[\]]*\]")


def with_field(text: str, key: str, typed: str) -> str:
    """Return the text with the value that the user typed for a key; an empty value removes the key.

    Decimal commas become points; in a list, only where semicolons separate the entries. An invalid value is
    also written as typed, so that the reader of the specification reports the error. If
    the key belongs to one of several choices, the keys of the other choices are removed. If the key is a
    kind, the keys that the new kind does not have are removed.

    Raises
    ------
    InvalidInput
        If the text is not valid TOML, or the specification has no such key.

    Examples
    --------
    >>> with_field("[limits]\\nmax_height = '120 um'", "limits.max_height", "90 um")
    "[limits]\\nmax_height = '90 um'"
    """
    document = Document(text)
    section, _, name = key.rpartition(".")
    form, typed = form_of(section), typed.strip()
    if form is not None and form.kinds and name == "kind":
        return document.with_kind(section, typed) if typed else document.without(key)
    found = None if form is None else _key_form(form, document, name)
    if form is None or found is None:
        raise InvalidInput(f'a specification has no key "{key:.60}" here')
    if typed == shown(document.value(key)):
        return text
    if not typed:
        return document.without(key)
    others = [
        other.name
        for other in _keys(form, document)
        if found.choice is not None and other.choice not in (None, found.choice)
    ]
    present = [other for other in others if document.value(f"{section}.{other}") is not None]
    several = found.listed or (found.several and ", " in typed)
    if found.value != "text" and (not several or ";" in typed):
        typed = DECIMAL_COMMA.sub(lambda number: number[1].replace(",", "."), typed)
    return document.with_values(
        {key: typed_value(found, typed), **{f"{section}.{other}": None for other in present}}
    )


def with_section(text: str, name: str) -> str:
    """Return the text with a new section, whose required keys have the example values of the manual."""
    document, form = Document(text), form_of(name)
    if form is None or document.value(name) is not None:
        return text
    if form.kinds:
        return document.with_kind(name, next(iter(form.kinds)))
    needed = [key for key in form.keys[""] if key.needed] or list(form.keys[""][:1])
    return document.with_values({f"{name}.{key.name}": key.example for key in needed})


def without_section(text: str, name: str) -> str:
    """Return the text without a section."""
    document = Document(text)
    section = document.value(name)
    if not isinstance(section, dict):
        return text
    return document.with_values({f"{name}.{key}": None for key in section})


def shown(value: Any) -> str:
    """Return a value of a specification as a field shows it: strings without quotes, lists without brackets.

    Examples
    --------
    >>> shown(["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]]), shown(True), shown(0.5)
    ('0.07 mm^2, [0.15 mm^2, 0.18 mm^2]', 'true', '0.5')
    """
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)):
        return ", ".join(f"[{shown(part)}]" if isinstance(part, list) else shown(part) for part in value)
    if isinstance(value, float):
        return f"{value:.15g}"
    return json.dumps(value, default=str)


def typed_value(form: KeyForm, typed: str) -> Any:
    """Return typed text as a TOML value; text that does not match the type of the key stays a string.

    Examples
    --------
    >>> forms = {key.name: key for key in form_of("lattice").keys[""]}
    >>> typed_value(forms["shape"], "8 x 12"), typed_value(forms["pitch"], "1.5")
    ([8, 12], '1.5')
    """
    if not form.listed:
        several = form.several and ", " in typed  # one value for each site
        return _typed_list(form, typed.strip("[] ")) if several else _typed_entry(form, typed)
    # take groups out first, so that their commas do not separate entries of the list
    groups = [_typed_list(form, group[1:-1]) for group in GROUPS.findall(typed)] if form.pairs else []
    rest = GROUPS.sub("[]", typed) if form.pairs else typed.strip().removeprefix("[").removesuffix("]")
    entries = _split(form, rest)
    waiting = iter(groups)
    return [next(waiting) if entry == "[]" else _typed_entry(form, entry) for entry in entries]


def _typed_list(form: KeyForm, typed: str) -> list[Any]:
    return [_typed_entry(form, entry) for entry in _split(form, typed)]


def _split(form: KeyForm, typed: str) -> list[str]:
    parts = (CROSS if form.value == "integer" else SEPARATORS).split(typed)
    return [part.strip().strip("\"'") for part in parts if part.strip()]


def _typed_entry(form: KeyForm, typed: str) -> Any:
    if form.value in ("quantity", "text"):
        return typed
    if SHORT_NUMBER.fullmatch(typed):
        return float(typed)
    try:
        read = toml_table(f"value = {typed}")
    except InvalidInput:
        return typed
    value = read["value"]
    return value if len(read) == 1 and isinstance(value, (bool, int, float)) else typed


def _keys(form: SectionForm, document: Document) -> tuple[KeyForm, ...]:
    """Return the keys of a section for its kind in the text; none if the kind is unknown."""
    kind = document.value(f"{form.name}.kind") if form.kinds else ""
    return form.keys.get(kind, ()) if isinstance(kind, str) else ()


def _key_form(form: SectionForm, document: Document, name: str) -> KeyForm | None:
    return next((key for key in _keys(form, document) if key.name == name), None)
