"""The specification of a new part from a few values, and values that work where the typed ones collide."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import tomlkit

from metafem._values import MICROMETRES
from metafem.caps import SPHERE
from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.text.names import on_page
from metafem.files import parsed, planned, quantity
from metafem.inversion import (
    Design,
    Limits,
    LinearLaw,
    achievable_friction_coefficients,
    achievable_load_range,
    design,
)
from metafem.surface import Friction, Material, Surface

# Standard deviation of the heights of the paper's moulds (doi:10.1126/science.adk4234) [mm].
HEIGHT_SD = 0.9e-3

# Highest summit relative to the radius. Alignment caps are higher, and at most as high as the radius.
HIGHEST = 0.95

# Distance of a load range from the ends of the reached loads, relative to them, for rounding.
EDGE = 0.01

# Fewest asperities for which a line is reached over a range of loads, and most for which the search of this
# range takes seconds.
FEWEST, MOST = 4, 2500

# Most collisions that one offer mends; a mended value can collide with another one.
MOST_MENDED = 4

# A number with a decimal point or comma and an optional unit, and what separates two of them.
ENTRY = re.compile(r"([+-]?(?:\d+(?:[.,]\d+)?|[.,]\d+)(?:[eE][+-]?\d+)?)\s*([^\W\d_xX×]*)")
SEPARATOR = re.compile(r"[\sxX×*,;]*")


@dataclass(frozen=True)
class Field:
    """A field of the dialog: its name, label and unit, and its first value, that of the paper's part."""

    name: str
    label: str
    unit: str
    first: str

    @property
    def count(self) -> int:
        """Number of values in the field."""
        return len(ENTRY.findall(self.first))


FIELDS = (
    Field("size", "Block: width × length × thickness", "mm", "20 × 20 × 7.2"),
    Field("asperities", "Asperities: rows × columns", "", "8 × 8"),
    Field("coefficient", "Friction coefficient μ", "", "1.5"),
    Field("height", "Largest height of the summits", "µm", "270"),
    Field("radius", "Radius of curvature", "µm", "526"),
    Field("modulus", "Composite modulus E*", "MPa", "1.36"),
    Field("strength", "Shear strength σ", "MPa", "0.37"),
    Field("ratio", "Area ratio B", "", "0.85"),
)
NAMED = {field.name: field for field in FIELDS}

# The first values of all fields. `law` is the text of a target to keep; "" stands for the coefficient.
FIRST = {field.name: field.first for field in FIELDS} | {"law": ""}

# The text that is typed in each field.
Typed = Mapping[str, str]


class Collision(InvalidInput):
    """Values that make no part; `field` is to blame, and each of `offers` changes fields to make one."""

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
    radius: float
    modulus: float
    strength: float
    ratio: float
    law: str

    @property
    def slope(self) -> float:
        """Slope of the rescaled friction over the rescaled load."""
        return self.coefficient * self.modulus / (self.strength * self.ratio)


def new_part(typed: Typed, tables: Mapping[str, str] | None = None) -> str:
    """Return the specification of a part from the texts of the fields.

    Raises
    ------
    Collision
        If the values make no part. Each offer of the error makes one.

    Examples
    --------
    >>> text = new_part(FIRST | {"size": "30 30 7,2"})
    >>> print(text.partition("[lattice]")[2].partition("[limits]")[0].strip())
    shape = [8, 8]
    pitch = "3.22 mm"
    radius = "526 um"
    <BLANKLINE>
    [block]
    width = "30 mm"
    length = "30 mm"
    thickness = "7.2 mm"
    """
    given = {name: text.encode() for name, text in (tables or {}).items()}
    try:
        return _built(typed, given)
    except Collision as error:
        offers = [found for offer in error.offers if (found := _mended(typed, offer, given))]
        raise Collision(error.field, str(error), *offers or [FIRST]) from None


def _mended(typed: Typed, offer: Typed, tables: Mapping[str, bytes]) -> dict[str, str]:
    """Return an offer, with what it needs further to make a part; nothing if it makes none."""
    found = dict(offer)
    for _ in range(MOST_MENDED):
        try:
            _built({**typed, **found}, tables)
            return found
        except Collision as error:
            if not error.offers:
                break
            found |= error.offers[0]
    return {}


def _built(typed: Typed, tables: Mapping[str, bytes]) -> str:
    """Return the specification, or raise Collision with offers that may collide, too."""
    wanted = _wanted(typed)
    sections = _sections(wanted)
    try:
        found = _designed(wanted, sections, tables)
        # independent asperities have the same law with any offset
        needed = MICROMETRES * (wanted.radius - found.law.separation[-1])
        offset = max(0.0, math.floor(needed) + 1.0)
        sections["limits"]["offset"] = f"{offset:g} um"
        sections |= _placed(wanted, sections, wanted.height + offset / MICROMETRES)
        text = tomlkit.dumps(sections)
        specification = parsed(text, tables)
        template, height = specification.template, found.surface.height - wanted.radius + offset / MICROMETRES
        made = found.surface.replaced(
            position=template.position[found.sites], height=height, block=template.block
        )
        planned(made, template, specification.part)
    except Collision:
        raise
    except MetafemError as error:
        raise Collision("law" if wanted.law else "coefficient", on_page(str(error)), {"law": ""}) from None
    return text


def _wanted(typed: Typed) -> Wanted:
    """Return the values in the fields."""
    values = {field.name: _numbers(field, typed[field.name]) for field in FIELDS}
    rows, columns = values.pop("asperities")
    if not (rows.is_integer() and columns.is_integer() and FEWEST <= rows * columns <= MOST):
        words = f"must be two whole numbers with {FEWEST} to {MOST:,} asperities in all, such as 8 × 8"
        raise Collision("asperities", words, {"asperities": FIRST["asperities"]})
    width, length, thickness = values.pop("size")
    single: dict[str, float] = {name: value for name, (value,) in values.items()}
    return Wanted((width, length, thickness), (int(rows), int(columns)), law=typed.get("law", ""), **single)


def _numbers(field: Field, text: str) -> list[float]:
    """Return the numbers in the text of a field, in mm and MPa; one without a unit has that of the field."""
    offer = {field.name: field.first}
    words = f"must be {'a number' if field.count == 1 else f'{field.count} numbers'} above 0"
    example = f"such as {field.first} {field.unit}".strip()
    found = ENTRY.findall(text)
    if len(found) != field.count or not SEPARATOR.fullmatch(ENTRY.sub("", text)):
        raise Collision(field.name, f"{words}, {example}", offer)
    unit = {"MPa": "MPa", "": "1"}.get(field.unit, "mm")
    try:
        given = [f"{number.replace(',', '.')} {own or field.unit}".strip() for number, own in found]
        values = (
            [quantity(field.label, each, unit) for each in given] if field.unit else list(map(float, given))
        )
    except (InvalidInput, ValueError):
        raise Collision(field.name, f"{words} in {field.unit or 'no unit'}, {example}", offer) from None
    if not all(0.0 < value < math.inf for value in values):
        raise Collision(field.name, f"{words}, {example}", offer)
    return values


def _sections(wanted: Wanted) -> dict[str, Any]:
    """Return the sections of a surface without a part, with an offset that no load of a part uses up."""
    if wanted.height > HIGHEST * wanted.radius:
        _refuse_height(wanted, wanted.height)
    kept = tomlkit.parse(wanted.law).unwrap() if wanted.law else {"target": _line_of(wanted)}
    return {
        **kept,
        "material": {"composite_modulus": f"{wanted.modulus:.6g} MPa", "poisson_ratio": 0.5},
        "friction": {"shear_strength": f"{wanted.strength:.6g} MPa", "area_ratio": wanted.ratio},
        "lattice": {
            "shape": list(wanted.shape),
            "pitch": _mm(3.0 * wanted.radius),
            "radius": _um(wanted.radius),
        },
        "limits": {
            "max_height": _um(wanted.height),
            "offset": _um(wanted.radius),
            "height_sd": _um(HEIGHT_SD),
        },
        "layout": {"seed": 0},
        "model": {"kind": "independent"},
    }


def _line_of(wanted: Wanted) -> dict[str, Any]:
    """Return the target of the coefficient, over the widest range of loads."""
    template = Surface.square_lattice(
        wanted.height, (1, 1), 1.0, radius=wanted.radius, material=Material(wanted.modulus),
        friction=Friction(wanted.strength, wanted.ratio),
    )  # fmt: skip
    limits = Limits(wanted.height, height_sd=HEIGHT_SD)
    most = achievable_friction_coefficients(template, limits)[1]
    if wanted.coefficient > most:
        words = f"the largest is {_down(most):g}: a larger one needs finer heights than can be made"
        raise Collision("coefficient", words, {"coefficient": f"{_down(most):g}"})
    (low, high), span = _line(math.prod(wanted.shape))
    needed = span * wanted.radius / wanted.slope**2
    if needed > wanted.height:
        least = _up(wanted.coefficient * math.sqrt(needed / wanted.height))
        height = _up(MICROMETRES * needed)
        words = f"needs summits up to {height:g} µm; with {MICROMETRES * wanted.height:.3g} µm the least is {least:g}"
        raise Collision("coefficient", words, {"coefficient": f"{least:g}"}, {"height": f"{height:g}"})
    newtons = wanted.modulus * wanted.radius**2 / wanted.slope**3
    return {
        "kind": "linear",
        "friction_coefficient": wanted.coefficient,
        "load_range": [f"{low * newtons:.4g} N", f"{high * newtons:.4g} N"],
    }


@cache
def _line(count: int) -> tuple[tuple[float, float], float]:
    """Return the widest load range of a line of slope 1, and the range of its heights, for radius 1.

    For another radius R and slope m, loads P/E* are proportional to R^2/m^3, and heights to R/m^2 [mm].
    """
    high = 1e3  # more than any line needs
    template = Surface.square_lattice(high, (1, count), 3.0, radius=1.0, material=Material(1.0))
    low, end = achievable_load_range(LinearLaw(1.0), template, Limits(high))
    loads = low * (1.0 + EDGE), end * (1.0 - EDGE)
    surface = design(LinearLaw(1.0, load_range=loads), template, limits=Limits(high)).surface
    return loads, float(np.ptp(surface.height)) * (1.0 + EDGE)


def _designed(wanted: Wanted, sections: dict[str, Any], tables: Mapping[str, bytes]) -> Design:
    """Return the design of the sections; if a kept law is not reached, offer the height that it needs."""
    try:
        return parsed(tomlkit.dumps(sections), tables).design()
    except MetafemError as error:
        highest, offers = HIGHEST * wanted.radius, list[Typed]()
        if wanted.height < highest:
            limits = {**sections["limits"], "max_height": _um(highest)}
            with suppress(MetafemError):
                found = parsed(tomlkit.dumps({**sections, "limits": limits}), tables).design()
                needed = (1.0 + EDGE) * float(np.ptp(found.surface.height))
                offers = [{"height": f"{_up(MICROMETRES * needed):g}"}]
        words = f"this part cannot have the law: {on_page(str(error))}"
        raise Collision("law", words, *offers, {"law": ""}) from None


def _refuse_height(wanted: Wanted, top: float) -> None:
    """Raise Collision for summits that are too high for their radius."""
    offers = [
        {"height": f"{_down(MICROMETRES * HIGHEST * wanted.radius):g}"},
        {"radius": f"{_up(MICROMETRES * top / HIGHEST):g}"},
    ]
    if top > wanted.height:  # the load presses the plane deeper than the summits are high
        offers.insert(
            0, {"coefficient": f"{_up(wanted.coefficient * math.sqrt(top / (HIGHEST * wanted.radius))):g}"}
        )
    words = f"the summits are up to {MICROMETRES * top:.3g} µm above the base; a cap is lower than its radius"
    raise Collision("height", words, *offers)


def _placed(wanted: Wanted, sections: Mapping[str, Any], top: float) -> dict[str, Any]:
    """Return the sections of a part whose lattice fills the block, with room for the alignment caps."""
    if top > HIGHEST * wanted.radius:
        _refuse_height(wanted, top)
    pitch, least, edge = _pitches(wanted, top)
    if pitch <= least:
        _refuse_pitch(wanted, top, least, edge)
    width, length, thickness = map(_mm, wanted.size)
    return {
        "lattice": {**sections["lattice"], "pitch": f"{pitch:g} mm"},
        "block": {"width": width, "length": length, "thickness": thickness},
        "part": {"alignment_height": _um(_alignment(wanted, top))},
    }


def _alignment(wanted: Wanted, top: float) -> float:
    """Return the height of the alignment caps [mm], halfway from the summits to the radius."""
    return 0.5 * (top + wanted.radius)


def _pitches(wanted: Wanted, top: float) -> tuple[float, float, float]:
    """Return the pitch that fills the block, the least for separate caps, and the room at the edge [mm].

    The alignment caps are one pitch outside the corners of the lattice.
    """
    foot, edge = (
        float(SPHERE.foot_radius(np.array([h]), np.array([wanted.radius]))[0])
        for h in (top, _alignment(wanted, top))
    )
    rows, columns = wanted.shape
    width, length, _ = wanted.size
    room = min((width - 2.0 * edge) / (columns + 1), (length - 2.0 * edge) / (rows + 1))
    least = max(2.0 * foot, (foot + edge) / math.sqrt(2.0), 2.0 * edge / (min(wanted.shape) + 1))
    return (_down(room) if room > 0.0 else 0.0), least, edge


def _refuse_pitch(wanted: Wanted, top: float, least: float, edge: float) -> None:
    """Raise Collision for caps that do not fit on the block beside each other."""
    pitch, (rows, columns), (width, length, thickness) = _up(least), wanted.shape, wanted.size
    fitting = [
        min(count, math.floor((side - 2.0 * edge) / pitch) - 1)
        for count, side in ((rows, length), (columns, width))
    ]
    sides = [
        max(side, _up(pitch * (count + 1) + 2.0 * edge)) for count, side in ((columns, width), (rows, length))
    ]
    offers = [{"size": " × ".join(f"{side:g}" for side in (*sides, thickness))}]
    if min(fitting) > 0:
        offers.insert(0, {"asperities": " × ".join(map(str, fitting))})
    words = (
        f"{rows} × {columns} caps with a base of {2.0 * edge:.3g} mm at most do not fit on {width:g} × {length:g} "
        f"mm: they need a pitch of {pitch:g} mm"
    )
    raise Collision("asperities", words, *offers)


def told(offer: Typed) -> str:
    """Return the words of the button of an offer."""
    if "law" in offer and len(offer) == 1:
        return "Use a friction coefficient"
    if len(offer) == len(FIRST):
        return "Use the first values of all fields"
    named = (NAMED[name] for name in offer if name in NAMED)
    return "Use " + ", ".join(
        f"{_lowered(field.label.partition(':')[0])} {offer[field.name]} {field.unit}".strip()
        for field in named
    )


def _lowered(label: str) -> str:
    return label[:1].lower() + label[1:]


def _um(length: float) -> str:
    return f"{MICROMETRES * length:.6g} um"


def _mm(length: float) -> str:
    return f"{length:.6g} mm"


def _down(value: float) -> float:
    """Return a value rounded down to three digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{math.floor(value / step) * step:.3g}")


def _up(value: float) -> float:
    """Return a value rounded up to three digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return float(f"{(math.floor(value / step) + 1) * step:.3g}")
