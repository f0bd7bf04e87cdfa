"""The kind of a target, and points as values in a specification."""

from __future__ import annotations

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.law.shown import Units
from metafem.explorer.text.document import Document


def kind_of(text: str) -> str:
    """Return the kind of the target that a text names; "" if it names none."""
    try:
        return str(Document(text).value("target.kind") or "")
    except InvalidInput:
        return ""


def points(load: FloatArray, friction: FloatArray, units: Units, digits: int) -> dict[str, list[str]]:
    """Return loads and frictions of points as quantities by key, rescaled [mm^2] or in newtons."""
    keys = ("load", "friction_force") if units.newtons else ("rescaled_load", "rescaled_friction")
    unit = "N" if units.newtons else "mm^2"
    values = (units.load * load, units.friction * friction)
    return {
        key: [f"{value:.{digits}g} {unit}" for value in each] for key, each in zip(keys, values, strict=True)
    }
