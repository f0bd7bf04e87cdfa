"""Edits of the text of a specification that preserve its comments, order and formatting."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Mapping
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.text.names import form_of, key_order
from metafem.files import DEMOS, demo_text, toml_table

# A line feed without a carriage return.
BARE_LINE_FEED = re.compile(r"(?<!\r)\n")

# The header of a section or of an array of sections.
HEADER = re.compile(r"^[ \t]*\[.*$", re.MULTILINE)


class Document:
    """The text of a specification, with methods that read and set values by dotted keys.

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
    >>> text = Document("[limits]  # of the workshop\\nmax_height = '120 um'").with_value(
    ...     "limits.min_height", "10 um"
    ... )
    >>> print(text)
    [limits]  # of the workshop
    max_height = '120 um'
    min_height = "10 um"
    >>> Document(text).value("limits.max_height")
    '120 um'
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.table = toml_table(text)

    def value(self, key: str) -> Any:
        """Return the value of a dotted key; None if the text does not have the key."""
        found: Any = self.table
        for part in key.split("."):
            found = found.get(part) if isinstance(found, dict) else None
        return found

    def with_value(self, key: str, value: Any) -> str:
        """Return the text with a new value of a dotted key; a missing section is added."""
        return self.with_values({key: value})

    def without(self, key: str) -> str:
        """Return the text without a key; its section is also removed if it is then empty and optional."""
        return self.with_values({key: None})

    def with_kind(self, section: str, kind: str, values: Mapping[str, Any] | None = None) -> str:
        """Return the text with a section changed to another kind.

        `values` are the keys and values of the new section. Default: the present values of the keys that the
        new kind has, and the examples of the manual for missing required keys. Lists whose lengths differ
        from those of the added lists are replaced by the examples. All other keys are removed.
        """
        now = self.value(section)
        present = now if isinstance(now, dict) else {}
        if values is None:
            kept = {name: value for name, value in present.items() if name in key_order(section, kind)}
            sizes = {
                len(value) for value in _examples(section, kind, kept).values() if isinstance(value, list)
            }
            if sizes:
                kept = {
                    name: value
                    for name, value in kept.items()
                    if not isinstance(value, list) or len(value) in sizes
                }
            values = {**kept, **_examples(section, kind, kept)}
        keys = {"kind": kind, **dict.fromkeys(name for name in present if name != "kind"), **values}
        keys["kind"] = kind
        return self.with_values({f"{section}.{name}": value for name, value in keys.items()})

    def with_values(self, values: Mapping[str, Any]) -> str:
        """Return the text with new values of dotted keys; the value None removes a key.

        Raises
        ------
        InvalidInput
            If a value cannot be set without changing other values of the text.
        """
        wanted = copy.deepcopy(self.table)
        for key, value in values.items():
            _set_plain(wanted, key.split("."), value)
        emptied = [key for key in _sections_of(values) if _is_emptied(wanted, key)]
        for key in emptied:
            _set_plain(wanted, key.split("."), None)
        if wanted == self.table and _same(wanted, self.table):
            return self.text
        for careful in (True, False):
            text = self._edited(values, emptied, wanted, careful)
            if text is not None:
                return text
        keys = ", ".join(values)
        raise InvalidInput(
            f"{keys} cannot be changed here without changing other parts of the text; edit the specification "
            "as text"
        )

    def _edited(
        self, values: Mapping[str, Any], emptied: list[str], wanted: dict[str, Any], careful: bool
    ) -> str | None:
        """Return the edited text if its values are those in `wanted`, otherwise None."""
        import tomlkit
        from tomlkit.exceptions import TOMLKitError

        from metafem.explorer.text.edits import removed, separate, set_value

        mark = "\ufeff" if self.text.startswith("\ufeff") else ""
        body = self.text.removeprefix("\ufeff")
        only_crlf = "\r\n" in body and not BARE_LINE_FEED.search(body)
        newline, ended = "\r\n" if only_crlf else "\n", body.endswith("\n")
        if not ended:
            body += newline
        try:
            document = tomlkit.parse(body)
            for key, value in values.items():
                if value is None:
                    removed(document, key.split("."))
                else:
                    set_value(document, key.split("."), value, wanted, careful)
            separate(document, [name for name in wanted if name not in self.table])
            text = document.as_string()
            for key in emptied:
                text = _without_section(text, key)
        except (TOMLKitError, RecursionError, AttributeError, KeyError, TypeError, ValueError):
            return None  # a form of TOML that tomlkit does not edit
        if only_crlf:
            text = BARE_LINE_FEED.sub("\r\n", text)
        text = mark + (text if ended else text.removesuffix(newline))
        try:
            return text if _same(toml_table(text), wanted) else None
        except InvalidInput:
            return None


def as_own(text: str) -> str:
    """Return the text; without the comment that describes a demo's law if the target is another one."""
    for name in DEMOS:
        demo = demo_text(name)
        head = demo[: demo.index("\n", demo.index("# Edit any value")) + 1]
        if text.startswith(head) and toml_table(text).get("target") != toml_table(demo)["target"]:
            return text.removeprefix(head)
    return text


def _set_plain(table: dict[str, Any], parts: list[str], value: Any) -> None:
    """Set a value in a plain table, or remove it."""
    for i, part in enumerate(parts[:-1]):
        if value is None and part not in table:
            return
        inner = table.setdefault(part, {})
        if not isinstance(inner, dict):
            key = ".".join(parts[: i + 1])
            raise InvalidInput(f"{key} is not a section in the text; write [{key}] on a line of its own")
        table = inner
    if value is None:
        table.pop(parts[-1], None)
    else:
        table[parts[-1]] = value


def _sections_of(values: Mapping[str, Any]) -> list[str]:
    """Return the sections of the removed keys and their outer sections, inner sections first."""
    found = {key.rpartition(".")[0] for key, value in values.items() if value is None and "." in key}
    found |= {key.rpartition(".")[0] for key in found if "." in key}
    return sorted(found, key=lambda key: -key.count("."))


def _is_emptied(table: dict[str, Any], key: str) -> bool:
    """Return whether a section has no keys left and is optional or unknown."""
    inner: Any = table
    for part in key.split("."):
        inner = inner.get(part) if isinstance(inner, dict) else None
    form = form_of(key)
    return inner == {} and (form is None or form.optional)


def _same(first: dict[str, Any], second: dict[str, Any]) -> bool:
    """Return whether two tables have equal values of equal types; nan counts as equal to nan.

    An empty section counts as no section, because dotted keys cannot describe an empty section.
    """
    filled = [{name: value for name, value in table.items() if value != {}} for table in (first, second)]
    texts = [json.dumps(table, sort_keys=True, default=repr) for table in filled]
    return texts[0] == texts[1]


def _without_section(text: str, key: str) -> str:
    """Return the text without a section that has no keys left; comments after a blank line remain."""
    name = r"[ \t]*\.[ \t]*".join(
        rf"(?:{re.escape(part)}|[\"']{re.escape(part)}[\"'])" for part in key.split(".")
    )
    found = re.search(rf"^[ \t]*\[[ \t]*{name}[ \t]*\].*$", text, re.MULTILINE)
    if found is None:  # an inline table, or dotted keys
        import tomlkit

        from metafem.explorer.text.edits import removed

        document = tomlkit.parse(text)
        removed(document, key.split("."))
        return document.as_string()
    following = HEADER.search(text, found.end())
    end = following.start() if following else len(text)
    blank = re.compile(r"^[ \t]*\r?\n", re.MULTILINE).search(text, found.end(), end)
    return text[: found.start()] + text[blank.end() if blank else end :]


def _examples(section: str, kind: str, kept: Mapping[str, Any]) -> dict[str, Any]:
    """Return example values for the required keys of a kind that are not in `kept`."""
    form = form_of(section)
    keys = form.keys.get(kind, ()) if form else ()
    begun = [key.choice for key in keys if key.choice is not None and key.name in kept]
    choice = begun[0] if begun else 0
    return {
        key.name: key.example
        for key in keys
        if key.name not in kept and (not key.optional or key.choice == choice)
    }
