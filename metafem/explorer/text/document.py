"""The specification of a page: the values of its text, and the one writer of a changed text."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import rtoml

from metafem.errors import InvalidInput
from metafem.explorer.text.names import form_of, keys_of, order_of
from metafem.files import DEMOS, KeyForm, demo_text, toml_table

# A string or a comment in TOML; only a comment is captured.
COMMENT = re.compile(
    r"'''[\s\S]*?'''|\"\"\"(?:\\[\s\S]|[^\\])*?\"\"\"|'[^'\n]*'|\"(?:\\.|[^\"\\\n])*\"|(#.*)"
)


# Number of texts whose values are stored: the newest ones of the open pages, which are few. Each part of a
# page reads the text of an answer again.
TEXTS = 8

_table_of = lru_cache(TEXTS)(toml_table)


class Document:
    """The values of a specification, and methods that return its text with other values.

    A changed text is written from the values alone, in the order of the manual with the lists of a section
    last; comments end. A change that sets what is given already returns the text as it is.

    Parameters
    ----------
    text : str
        A specification, or any other TOML text.

    Raises
    ------
    InvalidInput
        If the text is not valid TOML.

    Examples
    --------
    >>> text = Document("[limits]  # of the workshop\\noffset = '1 um'").with_values(
    ...     {"limits.max_height": "120 um"}
    ... )
    >>> print(text)
    [limits]
    max_height = "120 um"
    offset = "1 um"
    <BLANKLINE>
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.table = _table_of(text)  # shared, and never changed

    def value(self, key: str) -> Any:
        """Return the value of a dotted key; None if the text does not have the key."""
        found: Any = self.table
        for part in key.split("."):
            found = found.get(part) if isinstance(found, dict) else None
        return found

    def section(self, name: str) -> dict[str, Any]:
        """Return the keys and values of a section; none if the text does not have the section."""
        found = self.value(name)
        return found if isinstance(found, dict) else {}

    def keys(self, section: str) -> tuple[KeyForm, ...]:
        """Return the forms of the keys that a section of the kind in the text can have."""
        return keys_of(section, self.value(f"{section}.kind"))

    def with_kind(self, section: str, kind: str, values: Mapping[str, Any] | None = None) -> str:
        """Return the text with a section changed to another kind.

        `values` are the keys and values of the new section. Default: the present values of the keys that the
        new kind has, and the examples of the manual for missing required keys. If a list is missing, all
        lists are those of the examples. All other keys are removed.
        """
        given, forms = self.section(section), keys_of(section, kind)
        if values is None:
            kept = {form.name: given[form.name] for form in forms if form.name in given}
            if any(isinstance(value, list) for value in _examples(forms, kept).values()):
                kept = {name: value for name, value in kept.items() if not isinstance(value, list)}
            values = kept | _examples(forms, kept)
        keys = dict.fromkeys(given) | dict(values) | {"kind": kind}
        return self.with_values({f"{section}.{name}": value for name, value in keys.items()})

    def with_values(self, values: Mapping[str, Any]) -> str:
        """Return the text with new values of dotted keys; the value None removes a key.

        Missing sections are added, and optional sections without a key that is left are removed.
        """
        table = copy.deepcopy(self.table)
        for key, value in values.items():
            _set(table, key, value)
        # repr distinguishes 1, 1.0 and true, and nan equals nan
        return self.text if repr(table) == repr(self.table) else rtoml.dumps(_ordered(table))


def section_of(text: str, name: str) -> dict[str, Any]:
    """Return the keys and values of a section; none if the text cannot be read or lacks the section."""
    try:
        return Document(text).section(name)
    except InvalidInput:
        return {}


def loses_comments(before: str, after: str) -> bool:
    """Return whether a changed text has lost a comment that is not one of a demo.

    Examples
    --------
    >>> loses_comments("a = '#' # of mine", "a = 2"), loses_comments("a = '#'", "a = 2")
    (True, False)
    """
    known = {words.strip() for text in (after, *map(demo_text, DEMOS)) for words in COMMENT.findall(text)}
    return any(words.strip() not in known | {""} for words in COMMENT.findall(before))


def _set(table: dict[str, Any], key: str, value: Any, outer: str = "") -> None:
    """Set the value of a dotted key in a table, or remove the key and the optional section it empties."""
    name, _, rest = key.partition(".")
    if rest:
        section, inner = f"{outer}{name}", table.get(name, {})
        if not isinstance(inner, dict):
            words = f"{section} is not a section in the text; write [{section}] on a line of its own"
            raise InvalidInput(words)
        _set(inner, rest, value, f"{section}.")
        form = form_of(section)
        stays = inner or (name in table and form is not None and not form.optional)
        value = inner if stays else None
    if value is None:
        table.pop(name, None)
    else:
        table[name] = value


def _ordered(value: Any, section: str = "") -> Any:
    """Return a table with its keys in the order of the manual, unknown keys last; other values unchanged."""
    if not isinstance(value, dict):
        return value
    order = order_of(section, value.get("kind"))
    names = sorted(value, key=lambda name: order.index(name) if name in order else len(order))
    return {name: _ordered(value[name], f"{section}.{name}".lstrip(".")) for name in names}


def _examples(forms: Sequence[KeyForm], kept: Mapping[str, Any]) -> dict[str, Any]:
    """Return example values for the required keys that are not in `kept`."""
    choice = next((form.choice for form in forms if form.choice is not None and form.name in kept), 0)
    return {
        form.name: form.example
        for form in forms
        if form.name not in kept and (not form.optional or form.choice == choice)
    }
