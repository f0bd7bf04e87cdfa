"""The form of the workshop: its sections and fields, and what stands in them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.fields import shown
from metafem.files import KeyForm, SectionForm, section_forms

# Sections in the order of the form with their titles; the first ones are always open.
COMMON = {
    "target": "Target law", "lattice": "Sites and radius", "limits": "Heights",
    "model": "Model", "contact": "Contact law",
}  # fmt: skip
FURTHER = {
    "material": "Material", "friction": "Friction", "radii": "Choice of radii", "block": "Block",
    "sites": "Pinned and empty sites", "robust": "Errors of the made part", "layout": "Layout",
    "part": "Part files", "checks": "Checks",
}  # fmt: skip

# Names of keys in words, where the key itself is not enough.
LABELS = {
    "lattice.shape": "rows, columns",
    "limits.max_height": "largest height",
    "limits.min_height": "smallest height",
    "limits.height_sd": "scatter of heights",
    "model.kind": "model",
}


def form() -> list[dict[str, Any]]:
    """Return the sections of the form with their fields, as the browser needs them once."""
    forms = {each.name: each for each in section_forms()}
    inner = [name for name in forms if "." in name]
    known = [name for name in (*COMMON, *FURTHER) if name in forms]
    rest = [name for name in forms if name not in known and name not in inner]
    names = [*known, *rest]
    for name in inner:
        names.insert(names.index(name.partition(".")[0]) + 1, name)
    return [_section(forms[name]) for name in names]


def _section(section: SectionForm) -> dict[str, Any]:
    name = section.name
    title = {**COMMON, **FURTHER}.get(name, name.rpartition(".")[2].capitalize())
    return {
        "name": name,
        "title": title,
        "meaning": section.meaning,
        "optional": section.optional,
        "inner": _inner(name),
        "common": name.partition(".")[0] in COMMON,
        "kinds": section.kinds,
        "keys": {
            kind: [_field(name, key) for key in keys if key.value != "section"]
            for kind, keys in section.keys.items()
        },
    }


def _inner(name: str) -> dict[str, str] | None:
    """Return the key and the kind of the section around another one, which has it."""
    outer, _, key = name.rpartition(".")
    for form in section_forms():
        for kind, keys in form.keys.items():
            if form.name == outer and key in [each.name for each in keys]:
                return {"key": f"{outer}.kind", "kind": kind}
    return None


def _field(section: str, key: KeyForm) -> dict[str, Any]:
    name = f"{section}.{key.name}"
    return {
        "key": name,
        "label": LABELS.get(name, key.name.replace("_", " ")),
        "meaning": key.meaning,
        "example": shown(key.example),
        "default": shown(key.default),
        "value": key.value,
        "units": key.units,
        "names": key.names,
        "listed": key.listed,
        "choice": key.choice,
        "needed": not key.optional,
    }


def contents(text: str, problems: Mapping[str, str]) -> dict[str, Any]:
    """Return what stands in the fields for a text of a specification, and what is wrong with it.

    Examples
    --------
    >>> found = contents('[limits]\\nmax_height = "120"', {"limits.max_height": "needs a unit"})
    >>> found["values"], found["present"]
    ({'limits.max_height': '120'}, ['limits'])
    """
    try:
        document = Document(text)
    except InvalidInput as error:
        return {"broken": "; ".join(error.problems) or str(error), "problems": {}}
    values: dict[str, str] = {}
    present: list[str] = []
    for section in section_forms():
        table = document.value(section.name)
        if isinstance(table, dict):
            present.append(section.name)
            values |= {
                f"{section.name}.{name}": shown(value)
                for name, value in table.items()
                if not isinstance(value, dict)
            }
    return {"broken": "", "values": values, "present": present, "problems": dict(problems)}
