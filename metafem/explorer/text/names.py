"""Names and order of sections and keys: those of a specification, and what the page calls them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from metafem.files import KeyForm, SectionForm, section_forms

# Titles of sections whose names do not explain themselves.
TITLES: Mapping[str, str] = {
    "target": "Target law", "part": "Part files", "lattice": "Sites and radius", "tools": "Choice of tools",
    "sites": "Given heights, empty sites", "limits": "Heights",
    "contact": "Contact law", "contact.cap": "Cap under adhesion",
}  # fmt: skip

# Labels of keys whose names do not explain themselves.
LABELS: Mapping[str, str] = {
    "lattice.shape": "rows, columns",
    "lattice.radius": "radius of curvature",
    "limits.max_height": "largest height",
    "limits.min_height": "smallest height",
    "limits.height_sd": "error when made (SD)",
    "model.kind": "model",
    "material.composite_modulus": "composite modulus E*",
    "material.poisson_ratio": "Poisson's ratio ν",
    "friction.shear_strength": "shear strength σ",
    "friction.area_ratio": "area ratio B",
    "tools.radii": "radii of the tools",
    "tools.caps": "their caps",
    "tools.radius_range": "any radius within",
    "tools.step": "step of these radii",
    "tools.exponent_range": "any exponent within",
    "tools.exponent_step": "step of these exponents",
    "layout.seed": "random seed",
    "layout.tilt": "against a tilt of",
    "sites.empty": "empty sites",
    "sites.pinned": "sites with given heights",
    "sites.heights": "their heights",
}

# A name in a message: a section in brackets, or a key with its section or with an underscore, and its entry.
NAME = re.compile(r"\[([a-z]+(?:\.[a-z]+)?)\]|\b((?:[a-z]+\.){0,2}[a-z_]+)(?:\[(\d+)\])?(?![\w(])")

# The place of an asperity, a list, and the example at the end of a message, in the notation of a file.
PLACE = re.compile(r"(?<= at )\(([^,()]+), ([^()]+)\) mm")
LIST = re.compile(r"(?<= = )\[[^=\n]*\]|\[[^\[\]\n]*,[^\[\]\n]*\]")
EXAMPLE = re.compile(r"(write for example )(?:\w+ = )?(.+)$", re.MULTILINE)

# Words about the notation of a specification, and those of a field.
NOTATION = {
    ", without quotes and unit": " without a unit",
    ", without quotes": "",
    " in square brackets": ", separated by commas",
    " on a line of its own": "",
}


def title_of(section: str) -> str:
    """Return the title of a section."""
    return TITLES.get(section) or section.rpartition(".")[2].capitalize()


def label_of(key: str) -> str:
    """Return the label of the field of a key.

    Examples
    --------
    >>> label_of("limits.max_height"), label_of("lattice.pitch")
    ('largest height', 'pitch')
    """
    return LABELS.get(key) or key.rpartition(".")[2].replace("_", " ")


def on_page(message: str) -> str:
    """Return a message with the page's names of sections and keys, without the notation of a specification.

    Examples
    --------
    >>> on_page("the asperity at (1, 2) mm is too high; lower max_height or omit [block]")
    'the asperity at x = 1 mm, y = 2 mm is too high; lower “largest height” or omit “Block”'
    >>> on_page('lattice.shape[0] is missing; write for example shape = [8, 8]')
    '“rows, columns”, entry 1 is missing; write for example 8, 8'
    """
    message = PLACE.sub(r"x = \1 mm, y = \2 mm", message)
    for notation, words in NOTATION.items():
        message = message.replace(notation, words)
    message = LIST.sub(lambda found: _plain(found[0]), message)
    message = EXAMPLE.sub(lambda found: found[1] + _plain(found[2]), message)
    return NAME.sub(_named, message)


def _plain(value: str) -> str:
    """Return a value as a field shows it, without brackets and quotes."""
    return re.sub(r"[\[\]\"']", "", value)


def _named(found: re.Match[str]) -> str:
    section, name, entry = found.groups()
    known = _known()
    if section is not None:
        return f"“{title_of(section)}”" if section in known else found[0]
    if name not in known or not (entry or re.search(r"[._]", name)):
        return found[0]
    return f"“{known[name]}”" + (f", entry {int(entry) + 1}" if entry else "")


@cache
def _known() -> Mapping[str, str]:
    """Return the page's name of each section, of each key with its section, and of each key alone."""
    found: dict[str, str] = {}
    for form in section_forms().values():
        found[form.name] = title_of(form.name)
        for name in dict.fromkeys(key.name for key in form.every):
            label = label_of(f"{form.name}.{name}")
            found[f"{form.name}.{name}"] = label
            found.setdefault(name, label)
    return {**found, "height_sd": label_of("limits.height_sd")}


def form_of(section: str) -> SectionForm | None:
    """Return the form of a section such as ``limits`` or ``contact.cap``; None for an unknown section.

    Examples
    --------
    >>> form_of("limits").optional
    False
    """
    return section_forms().get(section)


def keys_of(section: str, kind: object = None) -> tuple[KeyForm, ...]:
    """Return the forms of the keys of a section of a kind, in the order of the manual; none if unknown."""
    form = form_of(section)
    return () if form is None else form.keys.get(str(kind) if form.kinds else "", ())


def order_of(section: str, kind: object = None) -> tuple[str, ...]:
    """Return the keys of a section of a kind in the order of the manual; for "", the outer sections.

    Examples
    --------
    >>> order_of("contact", "kogut-etsion"), order_of("")[:2]
    (('kind', 'hardness'), ('target', 'material'))
    """
    if not section:
        return tuple(name for name in section_forms() if "." not in name)
    return ("kind", *(key.name for key in keys_of(section, kind)))
