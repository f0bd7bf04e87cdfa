"""Caps as texts of a table: "sphere", "paraboloid", "power 4 0.5" or "profile"."""

from __future__ import annotations

from metafem._given import shown
from metafem.caps import SPHERE, Cap, Paraboloid, Power, Profile, Sphere
from metafem.errors import InvalidInput
from metafem.surface import Surface

# Name of each kind of cap.
NAMES: dict[type[Cap], str] = {Sphere: "sphere", Paraboloid: "paraboloid", Power: "power", Profile: "profile"}


def cap_text(cap: Cap) -> str:
    """Return the text of a cap; that of a profile does not contain its depths.

    Examples
    --------
    >>> cap_text(Power(4))
    'power 4.0 0.5'
    """
    values = f" {cap.exponent!r} {cap.coefficient!r}" if isinstance(cap, Power) else ""
    return NAMES[type(cap)] + values


def caps_column(surface: Surface) -> dict[str, list[str]]:
    """Return the column of the caps of a table, unless all are spheres."""
    if surface.cap == SPHERE:
        return {}
    return {"cap": [cap_text(surface.cap.one(i)) for i in range(surface.count)]}


def cap_named(text: str) -> Cap:
    """Return the cap of a text.

    Examples
    --------
    >>> cap_named("power 4")
    Power(exponent=4.0, coefficient=0.5)
    """
    kind, *values = text.split() or [""]
    try:
        if kind == "power" and 1 <= len(values) <= 2:
            return Power(*map(float, values))
        found: Cap | None = {"sphere": Sphere(), "paraboloid": Paraboloid()}.get(kind) if not values else None
    except InvalidInput:
        raise
    except ValueError:
        found = None
    if found is None:
        words = "must be sphere, paraboloid or power EXPONENT COEFFICIENT; other profiles are in design.json"
        raise InvalidInput(words, key="cap", value=shown(text))
    return found
