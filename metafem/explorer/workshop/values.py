"""Values of keys as they are typed into fields, without the quotes and brackets of TOML."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from metafem.files import KeyForm

# Numbers as TOML writes them; whole ones are within its 64 bits.
INTEGER = re.compile(r"[+-]?\d{1,18}")
NUMBER = re.compile(r"[+-]?\d{1,18}(\.\d{1,40})?([eE][+-]?\d{1,3})?")


def typed(value: Any) -> str:
    """Return the text of a field for a value of a specification.

    Examples
    --------
    >>> typed("120 um"), typed(6.87), typed(["0.1 mm^2", ["0.2 mm^2", "0.3 mm^2"]])
    ('120 um', '6.87', '0.1 mm^2, [0.2 mm^2, 0.3 mm^2]')
    """
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)):
        return ", ".join(
            f"[{typed(each)}]" if isinstance(each, (list, tuple)) else typed(each) for each in value
        )
    if isinstance(value, (bool, int, float)):
        return json.dumps(value)
    return str(value)


def value_of(form: KeyForm, text: str) -> Any:
    """Return the value of a specification for the text of a field; None if it is empty.

    A text that is no value of the key stays a text: the specification then states what is wrong with it.

    Examples
    --------
    >>> from metafem.files import section_forms
    >>> keys = {key.name: key for form in section_forms() for keys in form.keys.values() for key in keys}
    >>> value_of(keys["slope"], "6.87"), value_of(keys["slope"], "six"), value_of(keys["shape"], "8, 8")
    (6.87, 'six', [8, 8])
    """
    text = text.strip()
    if not text:
        return None
    return [_entry(form, part) for part in _parts(text)] if form.listed else _single(form, text)


def _entry(form: KeyForm, text: str) -> Any:
    """Return an entry of a list, which can be a list in brackets."""
    if text.startswith("[") and text.endswith("]"):
        return [_single(form, part) for part in _parts(text[1:-1])]
    return _single(form, text)


def _single(form: KeyForm, text: str) -> Any:
    if form.value == "truth" and text in ("true", "false"):
        return text == "true"
    if form.value in ("number", "integer") and INTEGER.fullmatch(text):
        return int(text)
    if form.value in ("number", "integer") and NUMBER.fullmatch(text):
        return float(text)
    return text


def _parts(text: str) -> Iterator[str]:
    """Yield the parts of a list between commas outside brackets; one in brackets as a whole is opened."""
    depth, part = 0, ""
    for letter in text.rstrip(", "):
        depth += {"[": 1, "]": -1}.get(letter, 0)
        if letter == "," and depth <= 0:
            yield part.strip()
            part = ""
        else:
            part += letter
    yield part.strip()
