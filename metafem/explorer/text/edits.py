"""Changes of single values in a tomlkit document."""

from __future__ import annotations

import re
from typing import Any

import tomlkit
from tomlkit.container import Container
from tomlkit.items import Array, Item, String, Table

from metafem.explorer.text.names import key_order, section_order

# A comma without a space after it, which tomlkit writes when it adds an entry; and a character that does not
# occur in a list of integers. In lists with such characters no space is added, because their strings or
# comments may contain commas.
CLOSE, OTHER = re.compile(r",(?! )"), re.compile(r"[^\d, \[\]]")


def set_value(
    document: tomlkit.TOMLDocument, parts: list[str], value: Any, wanted: dict[str, Any], careful: bool
) -> None:
    """Set the value of a dotted key; if `careful`, add new keys and sections in the order of the manual."""
    *sections, name = parts
    container: Any = document
    plain: Any = wanted
    for i, section in enumerate(sections):
        if section not in container:
            if i:
                _insert(container, section, tomlkit.inline_table(), (), False)
            else:
                _add_section(document, section, careful)
        container, plain = container[section], plain[section]
    old = container.get(name)
    if old is None:
        order = key_order(".".join(sections), plain.get("kind", "")) if sections else section_order()
        _insert(container, name, _item(value), order, careful)
    elif careful and isinstance(old, Array) and isinstance(value, list) and value:
        _update(old, value)
        if CLOSE.search(old.as_string()) and not OTHER.search(old.as_string()):
            container[name] = tomlkit.value(CLOSE.sub(", ", old.as_string()))
    else:
        new = _item(value, old)
        container[name] = new
        _align(old, new)


def _align(old: Any, new: Item) -> None:
    """Adjust the space after a new value so that its comment stays in the same column."""
    gap = new.trivia.comment_ws
    if new.trivia.comment and len(gap) > 1 and not gap.strip(" "):
        new.trivia.comment_ws = " " * max(1, len(gap) + len(old.as_string()) - len(new.as_string()))


def removed(document: tomlkit.TOMLDocument, parts: list[str]) -> None:
    """Remove a dotted key if the document has it."""
    container: Any = document
    for section in parts[:-1]:
        if section not in container:
            return
        container = container[section]
    if parts[-1] in container:
        del container[parts[-1]]


def separate(document: tomlkit.TOMLDocument, names: list[str]) -> None:
    """Add an empty line after each new section that is followed by another section."""
    places = [key.key for key, _ in document.body if key is not None]
    for name in names:
        section = document[name]
        if isinstance(section, Table) and name in places[:-1]:
            section.add(tomlkit.nl())


def _item(value: Any, old: Any = None) -> Item:
    """Return a value as a tomlkit item; a string keeps the single quotes of the `old` string if possible."""
    quoted = isinstance(old, String) and old.as_string().startswith("'")
    if quoted and isinstance(value, str) and "'" not in value and value.isprintable():
        return tomlkit.string(value, literal=True)
    if isinstance(value, dict):
        table = tomlkit.inline_table()
        table.update(value)
        return table
    item: Item = tomlkit.item(list(value) if isinstance(value, tuple) else value)
    return item


def _update(array: Array, values: list[Any]) -> None:
    """Change only the entries of a list that differ; the others keep their format and their comments."""
    old = array.unwrap()
    least = min(len(old), len(values))
    start = next((i for i in range(least) if old[i] != values[i]), least)
    end = next((i for i in range(least - start) if old[-1 - i] != values[-1 - i]), least - start)
    for i in range(start, least - end):
        entry = array[i]
        if isinstance(entry, Array) and isinstance(values[i], list):
            _update(entry, values[i])
        else:
            array[i] = _item(values[i], entry)
    for i in range(least - end, len(values) - end):
        array.insert(i, _item(values[i], array[i - 1] if i else None))
    for _ in range(len(old) - len(values)):
        del array[least - end]


def _add_section(document: tomlkit.TOMLDocument, name: str, careful: bool) -> None:
    """Add an empty section, after the section that precedes it in the manual or at the end."""
    section = tomlkit.table()
    order = section_order()
    before = order[: order.index(name)] if careful and name in order else ()
    last = next((other for other in reversed(before) if other in document), None)
    places = [key.key for key, _ in document.body if key is not None]
    if last is None or places[-1] == last:
        document.append(name, section)
        return
    document._insert_after(last, name, section)  # tomlkit has no public name for this


def _insert(container: Any, name: str, item: Item, order: tuple[str, ...], careful: bool) -> None:
    """Add a key, after the nearest existing key that precedes it in `order` or at the end."""
    body = container.value if isinstance(container, Table) else container
    before = order[: order.index(name)] if name in order else ()
    last = next((other for other in reversed(before) if other in container), None)
    if careful and isinstance(body, Container) and last is not None:
        body._insert_after(last, name, item)  # tomlkit has no public name for this
    else:
        container[name] = item
