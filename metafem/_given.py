"""Units of arguments, and their values as texts of messages."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

# Unit of each argument and column of a table that has a unit. A name has one meaning in the whole package;
# NAME_sd is its standard deviation.
UNITS: Mapping[str, str] = {
    name: unit
    for unit, names in {
        "mm": (
            *("position", "height", "radius", "pitch", "width", "length", "thickness", "max_height"),
            *("min_height", "offset", "height_step", "low", "high", "radii", "step", "x", "y", "rho", "f"),
            *("separation", "approach", "cell", "contact_radius", "block_radius", "cell_radius"),
            *("alignment_height", "chord_error", "indentation", "r", "tools", "radius_range"),
            *("displacement", "boundary", "centre", "site_position", "frame"),
            *("sd_position", "sd_height", "sd_radius", "pixel_size", "blur", "pinned"),
        ),
        "mm^2": (
            *("rescaled_load", "rescaled_friction", "crossover_load", "crossover_loads", "load_range"),
            *("area", "asperity_area", "area_before", "area_sheared", "smallest_area"),
            *("area_error", "sheared_area", "sheared_area_error"),
        ),
        "N": ("load", "load_min", "friction_force"),
        "N/mm": ("adhesion_energy",),
        "MPa": (
            *("composite_modulus", "young_modulus", "shear_strength", "hardness", "yield_strength"),
            *("nominal_pressure", "nominal_shear_stress"),
        ),
        "rad": ("angle", "angle_x", "angle_y", "tilt", "rotation", "rotation_range"),
    }.items()
    for name in names
}

# Arguments with an entry for each of some sites, which keep their numbers.
BY_SITE = ("pinned",)


def unit_of(name: str) -> str:
    """Return the unit of an argument, such as "mm" for ``radius[3]``, or "1" if it has none."""
    return UNITS.get(name.rpartition(".")[2].partition("[")[0].removesuffix("_sd"), "1")


def with_unit(name: str, value: float) -> str:
    """Return the value of an argument as text, with its unit."""
    return f"{value:g} {unit_of(name)}".removesuffix(" 1")


def spoken(name: str) -> str:
    """Return the name of an argument in words: entries count from 1, as those of a table do.

    Examples
    --------
    >>> spoken("limits.offset"), spoken("radius[3]"), spoken("target.crossover_loads[0][1]")
    ('limits.offset', 'entry 4 of radius', 'entry (1, 2) of target.crossover_loads')
    """
    found = re.fullmatch(r"([^][]+)((?:\[\d+(?:, \d+)*\])+)", name)
    if found is None or found[1] in BY_SITE:
        return name
    places = [str(int(place) + 1) for place in re.findall(r"\d+", found[2])]
    place = places[0] if len(places) == 1 else f"({', '.join(places)})"
    return f"entry {place} of {found[1]}"


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
