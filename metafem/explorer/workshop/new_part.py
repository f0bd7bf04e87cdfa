"""The specification of a new part from a few values, and values that work where the typed ones collide."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np
import rtoml

from metafem._values import MICROMETRES
from metafem.caps import SPHERE
from metafem.errors import MetafemError
from metafem.explorer.text.names import on_page
from metafem.explorer.workshop.changes import EDGE, reached_loads
from metafem.explorer.workshop.part_fields import FIRST, Collision, Typed, Wanted, wanted
from metafem.files import parsed, planned, toml_table
from metafem.inversion import (
    Design,
    Limits,
    LinearLaw,
    achievable_friction_coefficients,
    design,
)
from metafem.surface import Friction, Material, Surface

# Highest summit relative to the radius. Alignment caps are higher, and at most as high as the radius.
HIGHEST = 0.95

# Most collisions that one offer mends; a mended value can collide with another one.
MOST_MENDED = 4

# Heights that no line of slope 1 needs with the radius 1, and a pitch that keeps all caps apart.
FREE, APART = 1e3, 3.0

Sections = dict[str, Any]


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
    pitch = "3.21 mm"
    radius = "526 um"
    shape = [8, 8]
    """
    given = {name: text.encode("utf-8", "surrogatepass") for name, text in (tables or {}).items()}
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
            found |= error.offers[0]
    return {}


def _built(typed: Typed, tables: Mapping[str, bytes]) -> str:
    """Return the specification, or raise Collision with offers that may collide, too."""
    part = wanted(typed)
    if part.height > HIGHEST * part.radius:
        _refuse_height(part, part.height)
    sections = _sections(part)
    found = _designed(part, sections, tables)
    # independent asperities have the same law with any offset
    offset = max(0.0, math.floor(MICROMETRES * (part.radius - found.law.separation[-1])) + 1.0)
    sections["limits"]["offset"] = f"{offset:g} um"
    _place(part, sections, part.height + offset / MICROMETRES)
    text = rtoml.dumps(sections)
    try:
        specification = parsed(text, tables)
        template, height = specification.template, found.surface.height - part.radius + offset / MICROMETRES
        planned(template.only(found.sites, height=height), template, specification.part)
    except MetafemError as error:
        raise Collision("size", on_page(str(error)), FIRST) from None
    return text


def _sections(part: Wanted) -> Sections:
    """Return the sections of a surface without a block, with an offset that keeps its base clear."""
    kept = toml_table(part.law) if part.law else {"target": _line_of(part)}
    radius, pitch = _um(part.radius), f"{APART * part.radius:.6g} mm"
    return kept | {
        "material": {"composite_modulus": f"{part.modulus:.6g} MPa", "poisson_ratio": 0.5},
        "friction": {"shear_strength": f"{part.strength:.6g} MPa", "area_ratio": part.ratio},
        "lattice": {"shape": list(part.shape), "pitch": pitch, "radius": radius},
        "limits": {"max_height": _um(part.height), "offset": radius, "height_sd": _um(part.error)},
        "layout": {"seed": 0},
        "model": {"kind": "independent"},
    }


def _line_of(part: Wanted) -> dict[str, Any]:
    """Return the target of the coefficient, over the widest range of loads."""
    material, friction = Material(part.modulus), Friction(part.strength, part.ratio)
    template = _template(1, part.radius, material=material, friction=friction)
    most = achievable_friction_coefficients(template, Limits(part.height, height_sd=part.error))[1]
    if part.coefficient > most:
        words = f"the largest is {_down(most)}: a larger one needs finer heights than can be made"
        raise Collision("coefficient", words, {"coefficient": _down(most)})
    (low, high), span = _line(math.prod(part.shape))
    needed = span * part.radius / part.slope**2
    if needed > part.height:
        least, height = _up(part.coefficient * math.sqrt(needed / part.height)), _up(MICROMETRES * needed)
        given = f"with {MICROMETRES * part.height:.3g} µm the least is {least}"
        words = f"needs summits up to {height} µm; {given}"
        raise Collision("coefficient", words, {"coefficient": least}, {"height": height})
    newtons = part.modulus * part.radius**2 / part.slope**3
    loads = [f"{low * newtons:.4g} N", f"{high * newtons:.4g} N"]
    return {"kind": "linear", "friction_coefficient": part.coefficient, "load_range": loads}


@cache
def _line(count: int) -> tuple[tuple[float, float], float]:
    """Return the widest load range of a line of slope 1, and the range of its heights, for radius 1.

    For another radius R and slope m, loads P/E* are proportional to R^2/m^3, and heights to R/m^2 [mm].
    """
    template, limits = _template(count, 1.0, material=Material(1.0)), Limits(FREE)
    loads = reached_loads(LinearLaw(1.0), template, limits)
    found = design(LinearLaw(1.0, load_range=loads), template, limits=limits)
    return loads, float(np.ptp(found.surface.height)) * (1.0 + EDGE)


def _template(count: int, radius: float, **given: Any) -> Surface:
    return Surface.square_lattice(FREE, (1, count), APART * radius, radius=radius, **given)


def _designed(part: Wanted, sections: Sections, tables: Mapping[str, bytes]) -> Design:
    """Return the design of the sections; if a kept law is not reached, offer the height that it needs."""
    try:
        return parsed(rtoml.dumps(sections), tables).design()
    except MetafemError as error:
        offers = [{"law": ""}]
        limits = {**sections["limits"], "max_height": _um(HIGHEST * part.radius)}
        with suppress(MetafemError):
            found = parsed(rtoml.dumps({**sections, "limits": limits}), tables).design()
            needed = (1.0 + EDGE) * MICROMETRES * float(np.ptp(found.surface.height))
            offers.insert(0, {"height": _up(needed)})
        words = f"this part cannot have the law: {on_page(str(error))}"
        raise Collision("law", words, *offers) from None


def _place(part: Wanted, sections: Sections, top: float) -> None:
    """Add the block and the pitch that fills it, with alignment caps one pitch outside the corners.

    `top` is the height of the highest summits [mm]. Raise Collision if the caps do not fit.
    """
    if top > HIGHEST * part.radius:
        _refuse_height(part, top)
    alignment = 0.5 * (top + part.radius)
    foot, edge = SPHERE.foot_radius(np.array([top, alignment]), np.array(2 * [part.radius]))
    side, count = np.array(part.size[:2]), np.array(part.shape[::-1])
    least = max(2.0 * foot, (foot + edge) / math.sqrt(2.0), 2.0 * edge / (min(part.shape) + 1))
    pitch = float(((side - 2.0 * edge) / (count + 1)).min())
    if not pitch > 0.0 or float(_down(pitch)) <= least:
        _refuse_size(part, float(_up(least)), float(edge))
    sections["lattice"]["pitch"] = f"{_down(pitch)} mm"
    sides = zip(("width", "length", "thickness"), part.size, strict=True)
    sections["block"] = {name: f"{size:.6g} mm" for name, size in sides}
    sections["part"] = {"alignment_height": _um(alignment)}


def _refuse_height(part: Wanted, top: float) -> None:
    """Raise Collision for summits that are too high for their radius.

    They are higher than the largest height if the load presses the plane deeper than that.
    """
    highest = HIGHEST * part.radius
    lower = {"height": _down(MICROMETRES * highest)}, {"radius": _up(MICROMETRES * top / HIGHEST)}
    lighter = {"law": ""} if part.law else {"coefficient": _up(part.coefficient * math.sqrt(top / highest))}
    words = f"the summits are up to {MICROMETRES * top:.3g} µm above the base; a cap is lower than its radius"
    raise Collision("height", words, *((lighter,) if top > part.height else lower))


def _refuse_size(part: Wanted, pitch: float, edge: float) -> None:
    """Raise Collision for caps that do not fit on the block beside each other with the least pitch [mm]."""
    side, count = np.array(part.size[:2]), np.array(part.shape[::-1])
    fitting = np.minimum(count, np.floor((side - 2.0 * edge) / pitch).astype(int) - 1)[::-1]
    sides = [_up(each) for each in pitch * (count + 1) + 2.0 * edge]
    needed = [new if float(new) > old else f"{old:g}" for new, old in zip(sides, side, strict=True)]
    offers = [{"size": " × ".join((*needed, f"{part.size[2]:g}"))}]
    if fitting.min() > 0:
        offers.insert(0, {"asperities": " × ".join(map(str, fitting))})
    words = "{} × {} caps do not fit on {:g} × {:g} mm".format(*part.shape, *side)
    raise Collision("asperities", f"{words}: they need a pitch of {pitch:g} mm", *offers)


def _um(length: float) -> str:
    return f"{MICROMETRES * length:.6g} um"


def _down(value: float, more: int = 0) -> str:
    """Return a value rounded down to three digits; with `more` units of the last digit."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return f"{float(f'{(math.floor(value / step) + more) * step:.3g}'):g}"


def _up(value: float) -> str:
    """Return the next value above that has three digits."""
    return _down(value, 1)
