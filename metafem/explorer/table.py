"""The table of a specification, which is the state of the page: its edits, its text, and names of its keys.

A table has the values of TOML by section and key. No function changes the table that it is given.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

import rtoml

from metafem.errors import refuse_if
from metafem.explorer.fields import shown, typed_value, unit_of
from metafem.files import Form, section_forms

Table = Mapping[str, Any]

# Titles of sections and labels of keys whose names do not explain themselves.
TITLES: Mapping[str, str] = {
    "target": "Target law", "part": "Part files", "lattice": "Sites and radius", "tools": "Choice of tools",
    "sites": "Given heights, empty sites", "limits": "Heights",
    "contact": "Contact law", "contact.cap": "Cap under adhesion",
    "lattice.shape": "rows, columns", "lattice.radius": "radius of curvature",
    "limits.max_height": "largest height", "limits.min_height": "smallest height",
    "limits.height_sd": "error when made (SD)",
    "material.composite_modulus": "composite modulus E*", "material.poisson_ratio": "Poisson's ratio ν",
    "friction.shear_strength": "shear strength σ", "friction.area_ratio": "area ratio B",
    "tools.radii": "radii of the tools", "tools.caps": "their caps",
    "sites.pinned": "sites with given heights", "sites.heights": "their heights",
    "model.kind": "model", "layout.seed": "random seed", "layout.tilt": "against a tilt of",
}  # fmt: skip

# A name in a message: a section in brackets, or a key with its section or with an underscore, and its entry.
NAME = re.compile(r"\[([a-z]+(?:\.[a-z]+)?)\]|\b((?:[a-z]+\.){0,2}[a-z_]+)(?:\[(\d+)\])?(?![\w(])")


def title_of(name: str) -> str:
    """Return the title of a section, or the label of a key with its section.

    Examples
    --------
    >>> title_of("limits.max_height"), title_of("lattice.pitch"), title_of("block")
    ('largest height', 'pitch', 'Block')
    """
    words = name.rpartition(".")[2].replace("_", " ")
    return TITLES.get(name) or (words.capitalize() if name in section_forms() else words)


def on_page(message: str) -> str:
    """Return a message with the page's names of sections and keys.

    Examples
    --------
    >>> on_page("the cap is too high; lower max_height or omit [block]")
    'the cap is too high; lower “largest height” or omit “Block”'
    >>> on_page("lattice.shape[0] is missing")
    '“rows, columns”, entry 1 is missing'
    """
    return NAME.sub(_named, message)


def _named(found: re.Match[str]) -> str:
    section, name, entry = found.groups()
    place = places().get(section or name)
    if place is None or not (section or entry or re.search(r"[._]", name)):
        return found[0]
    return f"“{title_of(place)}”" + (f", entry {int(entry) + 1}" if entry else "")


@cache
def places() -> Mapping[str, str]:
    """Return each section, and each key with its section, by its name and, where it is first, by its last."""
    found = {name: name for name in section_forms()} | {"height_sd": "limits.height_sd"}
    for section, form in section_forms().items():
        names = [key["name"] for keys in form["keys"].values() for key in keys]
        for name in [*names, *["kind"] * bool(form["kinds"])]:
            found[f"{section}.{name}"] = f"{section}.{name}"
            found.setdefault(name, f"{section}.{name}")
    return found


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

    Exponents of tools are those of caps with the radius of the lattice. A missing radius is the example of
    the manual.
    """
    if section != "tools":
        return table
    example = next(key["example"] for key in keys_of("lattice") if key["name"] == "radius")
    needed = value_of(table, "tools") is None or value_of(table, "tools.exponent_range") is not None
    radius = (value_of(table, "lattice.radius") or example) if needed else None
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
