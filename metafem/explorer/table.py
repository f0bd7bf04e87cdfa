"""The table of a specification, which is the state of the page: its edits, its text, and titles of its keys.

A table has the values of TOML by section and key. No function changes the table that it is given.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import rtoml

from metafem.errors import refuse_if
from metafem.explorer.fields import shown, typed_value, unit_of
from metafem.files import Form, section_forms

Table = Mapping[str, Any]


def title_of(name: str) -> str:
    """Return the title of a section, or the label of a key with its section: the words of its name.

    Examples
    --------
    >>> title_of("limits.max_height"), title_of("block"), title_of("contact.cap")
    ('max height', 'Block', 'Contact cap')
    """
    if name in section_forms():
        return name.replace(".", " ").capitalize()
    return name.rpartition(".")[2].replace("_", " ")


@cache
def names() -> tuple[str, ...]:
    """Return all sections, and all keys with their sections."""
    found = [*section_forms()]
    for section, form in section_forms().items():
        keys = [key["name"] for keys in form["keys"].values() for key in keys]
        found += [f"{section}.{name}" for name in [*["kind"] * bool(form["kinds"]), *keys]]
    return tuple(found)


def value_of(table: Table, key: str) -> Any:
    """Return the value of a dotted key, or of a section; None if the table does not have it."""
    found: Any = table
    for part in key.split("."):
        found = found.get(part) if isinstance(found, Mapping) else None
    return found


def section_of(table: Table, name: str) -> dict[str, Any]:
    """Return the keys and values of a section; none if the table does not have the section."""
    found = value_of(table, name)
    return found if isinstance(found, dict) else {}


def keys_of(section: str, kind: object = None) -> list[Form]:
    """Return the descriptions of the keys of a section of a kind; none if unknown."""
    form = section_forms().get(section, {"kinds": {}, "keys": {}})
    keys: list[Form] = form["keys"].get(str(kind) if form["kinds"] else "", [])
    return keys


def with_values(table: Table, values: Mapping[str, Any]) -> Table:
    """Return the table with new values of dotted keys; the value None removes a key.

    Missing sections are added, and optional sections without a key that is left are removed.

    Examples
    --------
    >>> with_values({"checks": {"hardness": "1 MPa"}}, {"checks.hardness": None, "limits.offset": "1 um"})
    {'limits': {'offset': '1 um'}}
    """
    for key, value in values.items():
        table = _with(table, key, value)
    return table


def _with(table: Table, key: str, value: Any, outer: str = "") -> dict[str, Any]:
    name, _, rest = key.partition(".")
    if rest:
        section, inner = f"{outer}{name}", table.get(name, {})
        wrong = f"{section} is not a section in the text; write [{section}] on a line of its own"
        refuse_if(not isinstance(inner, dict), wrong)
        value = _with(inner, rest, value, f"{section}.")
        required = not section_forms().get(section, {"optional": True})["optional"]
        value = value if value or (name in table and required) else None
    others = {each: other for each, other in table.items() if each != name or value is not None}
    return others if value is None else {**others, name: value}


def with_only(table: Table, section: str, values: Mapping[str, Any]) -> Table:
    """Return the table with these keys and values of a section alone."""
    values = {**dict.fromkeys(section_of(table, section)), **values}
    return with_values(table, {f"{section}.{name}": value for name, value in values.items()})


def with_section(
    table: Table,
    section: str,
    kind: str = "",
    choice: int | None = None,
    same: Mapping[str, Any] | None = None,
) -> Table:
    """Return the table with a section of a kind, default: the first, and of an alternative set of its keys.

    It has the present values of the keys that the kind and the set have. The required keys that it lacks have
    the values `same` or the examples of the manual; if another kind lacks a list, all its lists are examples.

    Examples
    --------
    >>> with_section({"target": {"kind": "linear", "slope": 7.0}}, "target", "linear", 1)
    {'target': {'kind': 'linear', 'friction_coefficient': 1.5}}
    """
    given, form = section_of(table, section), section_forms()[section]
    kind = kind or next(iter(form["kinds"]), "")
    keys = keys_of(section, kind)
    if choice is None:
        of_given = [key["choice"] for key in keys if key["name"] in given and key["choice"] is not None]
        choice = of_given[0] if of_given else 0
    fit = [key for key in keys if key["choice"] in (None, choice)]
    for lists in (True, False):
        kept = {key["name"]: given[key["name"]] for key in fit if key["name"] in given}
        kept = {name: value for name, value in kept.items() if lists or not isinstance(value, list)}
        lacks = [key for key in fit if not key["optional"] or key["choice"] == choice]
        lacks = [key for key in lacks if key["name"] not in kept]
        values = {key["name"]: (same or {}).get(key["name"], key["example"]) for key in lacks}
        if kind == given.get("kind", kind) or not any(isinstance(each, list) for each in values.values()):
            break
    if not kept and not values and keys:
        values = {keys[0]["name"]: keys[0]["example"]}
    values = {**kept, **values, **({"kind": kind} if kind else {})}
    return _with_radius(with_only(table, section, values), section)


def without_section(table: Table, section: str) -> Table:
    """Return the table without a section."""
    return _with_radius(with_only(table, section, {}), section)


def with_field(table: Table, key: str, typed: str) -> Table:
    """Return the table with the value that the user typed for a key; an empty value removes the key.

    A number without a unit has the unit of the value before. Decimal commas become points; in a list of plain
    numbers, only where semicolons separate the entries. An invalid value stays as typed, so that the reader
    of the specification reports the error. If the key belongs to one of several choices, the keys of the
    other choices are removed; if it is a kind, the keys that the new kind does not have.

    Raises
    ------
    InvalidInput
        If the specification has no such key.

    Examples
    --------
    >>> with_field({"limits": {"max_height": "120 um"}}, "limits.max_height", "90,5")
    {'limits': {'max_height': '90.5 um'}}
    """
    section, _, name = key.rpartition(".")
    typed, old = typed.strip(), value_of(table, key)
    forms = {form["name"]: form for form in keys_of(section, value_of(table, f"{section}.kind"))}
    is_kind = name == "kind" and bool(section_forms().get(section, {}).get("kinds"))
    refuse_if(not is_kind and name not in forms, f'a specification has no key "{key:.60}" here')
    if typed == shown(old):
        return table
    if not typed:
        return with_values(table, {key: None})
    if is_kind:
        return with_section(table, section, typed)
    form = forms[name]
    others = [each for each in forms.values() if None not in (form["choice"], each["choice"])]
    values = {f"{section}.{each['name']}": None for each in others if each["choice"] != form["choice"]}
    return with_values(table, {**values, key: typed_value(form, typed, unit_of(old))})


def _with_radius(table: Table, section: str) -> Table:
    """Return a table with ``lattice.radius``, unless the changed section ``tools`` replaces it.

    A missing radius is the example of the manual.
    """
    if section != "tools":
        return table
    example = next(key["example"] for key in keys_of("lattice") if key["name"] == "radius")
    radius = (value_of(table, "lattice.radius") or example) if value_of(table, "tools") is None else None
    return with_values(table, {"lattice.radius": radius})


def written(table: Table) -> str:
    """Return the text of a table, in the order of the manual with the lists of a section last."""
    return rtoml.dumps(_ordered(table))


def _ordered(value: Any, section: str = "") -> Any:
    if not isinstance(value, Mapping):
        return value
    order = ["kind", *(key["name"] for key in keys_of(section, value.get("kind")))]
    order = order if section else [*section_forms()]
    names = sorted(value, key=lambda name: order.index(name) if name in order else len(order))
    return {name: _ordered(value[name], f"{section}.{name}".lstrip(".")) for name in names}
