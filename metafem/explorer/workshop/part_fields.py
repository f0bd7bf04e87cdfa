"""The fields of the dialog for a new part, and the values that are typed in them."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from metafem._values import MICROMETRES
from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.fields import with_points
from metafem.files import Specification, quantity

# Fewest asperities for which a line is reached over a range of loads, and most for which the search of this
# range takes seconds.
FEWEST, MOST = 4, 2500

# The units inside of those that the package does not use.
INSIDE = {"µm": "mm"}

# A number and an optional unit, and what separates two of them.
ENTRY = re.compile(r"([+-]?(?:\d+(?:\.\d+)?|\.\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_xX×]*)")
CROSS, SEPARATOR = re.compile(r"[xX×*]"), re.compile(r"[\s,;]*")


@dataclass(frozen=True)
class Field:
    """A field: its name, label and unit, and its first value, that of the paper's part."""

    name: str
    label: str
    unit: str
    first: str

    def told(self, text: str) -> str:
        """Return the words for a value of the field."""
        label = self.label.partition(":")[0]
        return f"{label[:1].lower()}{label[1:]} {text} {self.unit}".strip()


FIELDS = (
    Field("size", "Block: width × length × thickness", "mm", "20 × 20 × 7.2"),
    Field("asperities", "Asperities: rows × columns", "", "8 × 8"),
    Field("coefficient", "Friction coefficient μ", "", "1.5"),
    Field("height", "Largest height of the summits", "µm", "270"),
    Field("error", "Error of the heights when made (SD)", "µm", "0.9"),
    Field("radius", "Radius of curvature", "µm", "526"),
    Field("modulus", "Composite modulus E*", "MPa", "1.36"),
    Field("strength", "Shear strength σ", "MPa", "0.37"),
    Field("ratio", "Area ratio B", "", "0.85"),
)

# The first values of all fields. `law` is the text of a target to keep; "" stands for the coefficient.
FIRST = {field.name: field.first for field in FIELDS} | {"law": ""}

# The text that is typed in each field.
Typed = Mapping[str, str]


class Collision(InvalidInput):
    """Values that make no part; `field` is to blame, and each of `offers` has texts that mend it."""

    def __init__(self, field: str, words: str, *offers: Typed) -> None:
        super().__init__(words)
        self.field, self.offers = field, offers


@dataclass(frozen=True)
class Wanted:
    """The values of the fields [mm, MPa], with the text of a target to keep, "" for the coefficient."""

    size: tuple[float, float, float]
    shape: tuple[int, int]
    coefficient: float
    height: float
    error: float
    radius: float
    modulus: float
    strength: float
    ratio: float
    law: str

    @property
    def slope(self) -> float:
        """Slope of the rescaled friction over the rescaled load."""
        return self.coefficient * self.modulus / (self.strength * self.ratio)


def filled(specification: Specification) -> dict[str, str]:
    """Return the texts of the fields for the part of a specification; first values for what is missing."""
    text, template, limits = Document(specification.text), specification.template, specification.limits
    block, friction = template.block, template.friction
    values = {
        "size": block and (block.width, block.length, block.thickness),
        "asperities": text.value("lattice.shape"),
        "coefficient": text.value("target.friction_coefficient"),
        "height": MICROMETRES * limits.max_height,
        "error": limits.height_sd and MICROMETRES * limits.height_sd,
        "radius": MICROMETRES * template.radius.min(),
        "modulus": template.material.composite_modulus,
        "strength": friction and friction.shear_strength,
        "ratio": friction and friction.area_ratio,
    }
    given = {name: np.ravel(value) for name, value in values.items() if value is not None}
    single = {  # not one value for each asperity
        field.name: " × ".join(f"{each:.6g}" for each in given[field.name])
        for field in FIELDS
        if len(given.get(field.name, ())) == len(ENTRY.findall(field.first))
    }
    return FIRST | single


def wanted(typed: Typed) -> Wanted:
    """Return the values in the fields, or raise Collision with the first value of a field."""
    values = {field.name: _numbers(field, typed[field.name]) for field in FIELDS}
    rows, columns = values.pop("asperities")
    if not (rows.is_integer() and columns.is_integer() and FEWEST <= rows * columns <= MOST):
        words = f"must be two whole numbers with {FEWEST} to {MOST:,} asperities in all, such as 8 × 8"
        raise Collision("asperities", words, {"asperities": FIRST["asperities"]})
    width, length, thickness = values.pop("size")
    single: dict[str, float] = {name: value for name, (value,) in values.items()}
    return Wanted((width, length, thickness), (int(rows), int(columns)), law=typed["law"], **single)


def _numbers(field: Field, text: str) -> list[float]:
    """Return the numbers in the text of a field, in mm and MPa; one without a unit has that of the field."""
    text, inside = with_points(CROSS.sub(" ", text)), INSIDE.get(field.unit, field.unit)
    count = len(ENTRY.findall(field.first))
    with suppress(InvalidInput, ValueError):  # a unit of another kind
        given = [f"{number} {unit or field.unit}" for number, unit in ENTRY.findall(text)]
        values = [quantity(field.label, each, inside) if inside else float(each) for each in given]
        plain = SEPARATOR.fullmatch(ENTRY.sub("", text)) and all(0.0 < value < math.inf for value in values)
        if plain and len(values) == count:
            return values
    numbers = "a number above 0" if count == 1 else f"{count} numbers above 0"
    unit = f" in {field.unit}" if field.unit else ""
    words = f"must be {numbers}{unit}, such as {field.first}"
    raise Collision(field.name, words, {field.name: field.first})


def told(offer: Typed) -> str:
    """Return the words of the button of an offer."""
    if len(offer) == len(FIRST):
        return "Use the first values of all fields"
    named = [field.told(offer[field.name]) for field in FIELDS if field.name in offer]
    return f"Use {', '.join(named or ['a friction coefficient'])}"
