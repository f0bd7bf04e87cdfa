"""Changes of a specification by controls of the form that change several keys at once."""

from __future__ import annotations

from typing import Any

from metafem.errors import MetafemError
from metafem.explorer.text.document import Document
from metafem.explorer.text.kinds import restated
from metafem.explorer.text.names import form_of
from metafem.files import Specification
from metafem.inversion import achievable_load_range

# Distance of a load range from the ends of the reached loads, relative to them, for rounding.
EDGE = 0.01

# Number of the choice of target keys that are forces or friction coefficients.
FORCES = 1


def with_choice(text: str, section: str, choice: int, specification: Specification | None = None) -> str:
    """Return the text with the keys of another choice of a section.

    If `specification` is given, a target keeps its law; a friction coefficient without a load range is then
    F/P over the widest range of loads in which independent asperities reach it. All other new keys have the
    examples of the manual.

    Examples
    --------
    >>> with_choice("[target]\\nkind = 'linear'\\nslope = 7.0", "target", 1)
    '[target]\\nkind = "linear"\\nfriction_coefficient = 1.5\\n'
    """
    document = Document(text)
    given, same, values = document.section(section), dict[str, Any](), dict[str, Any]()
    if section == "target" and specification is not None:
        same = restated(text, specification, newtons=choice == FORCES)
        if choice == FORCES and "slope" in given and "load_range" not in given:
            values["target.load_range"] = _reached_forces(specification)
    for key in document.keys(section):
        if key.choice == choice and key.name not in given:
            values[f"{section}.{key.name}"] = same.get(key.name, key.example)
        elif key.choice not in (None, choice):
            values[f"{section}.{key.name}"] = None
    return _with_radius(document.with_values(values), section)


def _reached_forces(specification: Specification) -> list[str] | None:
    """Return the loads between which a line through the origin is reached, or None."""
    target: Any = specification.target
    template, limits, tools = specification.template, specification.limits, specification.tools
    try:
        low, high = achievable_load_range(target, template, limits, tools)
    except MetafemError:
        return None
    modulus = template.material.composite_modulus
    return [f"{modulus * end:.3g} N" for end in (low * (1.0 + EDGE), high * (1.0 - EDGE))]


def with_section(text: str, section: str) -> str:
    """Return the text with a new section, whose required keys have the example values of the manual.

    The radii of the section ``tools`` replace ``lattice.radius``.
    """
    document, form = Document(text), form_of(section)
    if form is None or document.value(section) is not None:
        return text
    if form.kinds:
        return document.with_kind(section, next(iter(form.kinds)))
    needed = [key for key in form.keys[""] if key.needed] or form.keys[""][:1]
    values = {f"{section}.{key.name}": key.example for key in needed}
    return _with_radius(document.with_values(values), section)


def without_section(text: str, section: str) -> str:
    """Return the text without a section; an example ``lattice.radius`` replaces ``tools``."""
    document = Document(text)
    values = dict.fromkeys(f"{section}.{key}" for key in document.section(section))
    return _with_radius(document.with_values(values), section)


def _with_radius(text: str, section: str) -> str:
    """Return a text with ``lattice.radius`` unless the changed section ``tools`` replaces it.

    Exponents of tools are those of caps with the radius of the lattice. A missing radius is the example of
    the manual.
    """
    document = Document(text)
    if section != "tools":
        return text
    example = next(key.example for key in document.keys("lattice") if key.name == "radius")
    needed = document.value("tools") is None or document.value("tools.exponent_range") is not None
    radius = (document.value("lattice.radius") or example) if needed else None
    return document.with_values({"lattice.radius": radius})
