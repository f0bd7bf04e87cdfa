"""Names, units and values of arguments in error messages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

# Unit of each argument that has a unit. An argument name has the same meaning in the whole package.
UNITS: Mapping[str, str] = {
    name: unit
    for unit, names in {
        "mm": (
            *("position", "height", "radius", "pitch", "width", "length", "thickness", "max_height"),
            *("min_height", "offset", "height_step", "height_sd", "low", "high", "radii", "step"),
            *("separation", "approach", "cell", "contact_radius", "block_radius", "cell_radius"),
            *("alignment_height", "chord_error", "indentation", "r", "tools", "radius_range"),
            *("displacement", "boundary", "centre", "site_position", "frame"),
            *("radius_sd", "position_sd", "pixel_size", "blur", "pinned"),
        ),
        "mm^2": (
            *("rescaled_load", "rescaled_friction", "crossover_load", "crossover_loads", "load_range"),
            *("area", "area_sd", "asperity_area", "asperity_area_sd"),
            *("area_before", "area_sheared", "smallest_area"),
        ),
        "N": ("load", "load_min", "friction_force", "load_sd", "friction_force_sd"),
        "N/mm": ("adhesion_energy",),
        "MPa": ("composite_modulus", "young_modulus", "shear_strength", "hardness", "yield_strength"),
        "rad": ("angle", "angle_x", "angle_y", "tilt", "rotation", "rotation_range"),
    }.items()
    for name in names
}


def unit_of(name: str) -> str:
    """Return the unit of an argument, such as "mm" for ``radius[3]``, or "1" if it has none."""
    return UNITS.get(name.rpartition(".")[2].partition("[")[0], "1")


@dataclass(frozen=True)
class Given:
    """An argument or an entry of an array argument, such as ``radius[3]``, named in an error message.

    `value` is None if the message does not state the value. A number is in the package's unit. A text is
    printed unchanged.
    """

    name: str
    value: float | str | None = None

    @property
    def number(self) -> str:
        """Value as text."""
        return str(self.value)

    def __str__(self) -> str:
        return f"{self.name} = {self.value}"


@dataclass(frozen=True)
class Names:
    """Names of arguments as a reader knows them: in Python, in a file or on the command line.

    `names` maps arguments to the reader's names. `units` maps quantities to the unit in which they were
    written and the size of this unit in the package's unit. `places` holds the location of each entry of an
    array argument, such as a line of a file.
    """

    names: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    places: Sequence[str] = ()

    def under(self, inner: Names) -> Names:
        """Return these names combined with `inner`, which takes precedence."""
        places = inner.places or self.places
        return Names({**self.names, **inner.names}, {**self.units, **inner.units}, places)

    def filled(self, message: str, *about: Given) -> str:
        """Return a message with its fields ``{}``, ``{.name}`` and ``{.number}`` filled by the arguments."""
        return message.format(*map(self.said, about)) if about else message

    def said(self, given: Given) -> Given:
        """Return an argument with the reader's name, and its value as text with the reader's unit."""
        value = given.value
        number = value if isinstance(value, str) else "" if value is None else self.number(given.name, value)
        return Given(self.name(given.name), number)

    def number(self, name: str, value: float) -> str:
        """Return a number as text, in the unit in which the reader wrote the quantity."""
        if not self.units:
            return f"{value:g}"
        base = name.partition("[")[0]
        unit, size = self.units.get(base) or (unit_of(name), 1.0)
        return f"{float(value) / size:g} {unit}".removesuffix(" 1").rstrip()

    def name(self, name: str) -> str:
        """Return the reader's name of an argument or of an entry, such as ``radius[3]``."""
        if name in self.names:
            return self.names[name]
        base, bracket, index = name.partition("[")
        known = self.names.get(base, base)
        if self.places and bracket:
            return f"{self.places[int(index.rstrip(']').partition(',')[0])]}: {known}"
        return known + bracket + index


AS_IN_PYTHON = Names()


def shown(value: Any, most: int = 60) -> str:
    """Return any value as one line of text, for an error message."""
    if isinstance(value, (str, bytes)):
        value = value[: 2 * most]
    try:
        text = repr(value)
    except Exception:  # an object of another library, or an integer with too many digits
        text = f"{'an' if type(value).__name__[0] in 'aeiou' else 'a'} {type(value).__name__}"
    return printable(" ".join(text.split()), most)


def printable(text: str, most: int = 200) -> str:
    """Return text as one line: unprintable characters are escaped, and long texts are cut."""
    cut = text if len(text) <= most else text[: most - 1] + "…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in cut)
