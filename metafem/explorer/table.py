"""The table of a specification: its values and their one writer, and what the page calls its keys."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from typing import Any

import rtoml

from metafem.errors import InvalidInput
from metafem.files import DEMOS, KeyForm, SectionForm, demo_text, section_forms, toml_table

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
