"""Kinds of target laws: what a page calls them, and where each begins, near the law that is shown."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.law.shown import Units
from metafem.explorer.text.document import Document
from metafem.prediction import FrictionLaw

KINDS: Mapping[str, str] = {
    "operating-points": "points",
    "linear": "straight line",
    "bilinear": "two branches",
    "power": "power",
    "multilinear": "branches",
    "sampled": "curve",
}

# Loads over the last one: operating points, samples, and the ends of branches.
POINTS, SAMPLES = np.array([0.25, 0.5, 1.0]), np.arange(1, 13) / 12
LINE, TWO, THREE = (0.3, 1.0), (0.1, 0.5, 1.0), (0.1, 0.4, 0.7, 1.0)

# A design's law ends at this multiple of the last load of its target; digits of values of a new target.
BEYOND, DIGITS = 1.1, 4


def kind_of(text: str) -> str:
    """Return the kind of the target of a specification's text, "" where it has none."""
    try:
        return str(Document(text).value("target.kind") or "")
    except InvalidInput:
        return ""


def with_kind(answer: Answer, kind: str) -> str:
    """Return the text of an answer with a target of another kind, near the law that is shown.

    Raises
    ------
    InvalidInput
        For an unknown kind, and where the text is no valid TOML.
    """
    if kind not in KINDS:
        raise InvalidInput(f'kind = "{kind:.40}" is unknown (known: {", ".join(KINDS)})')
    document, design = Document(answer.state.text), answer.design
    if design is None:
        return document.with_kind("target", kind)
    law, units = design.law, Units.of(answer, answer.state.newtons)
    return document.with_kind("target", kind, VALUES[kind](law, float(law.rescaled_load[-1]) / BEYOND, units))


def points(
    load: FloatArray, friction: FloatArray, units: Units, digits: int = DIGITS
) -> dict[str, list[str]]:
    """Return the keys of points, rescaled or in newtons."""
    keys = ("load", "friction_force") if units.newtons else ("rescaled_load", "rescaled_friction")
    unit = "N" if units.newtons else "mm^2"
    values = (units.load * load, units.friction * friction)
    return {
        key: [f"{value:.{digits}g} {unit}" for value in each] for key, each in zip(keys, values, strict=True)
    }


def _points(law: FrictionLaw, last: float, units: Units) -> dict[str, Any]:
    return points(last * POINTS, _friction(law, last * POINTS), units)


def _samples(law: FrictionLaw, last: float, units: Units) -> dict[str, Any]:
    return points(last * SAMPLES, _friction(law, last * SAMPLES), units)


def _power(law: FrictionLaw, last: float, units: Units) -> dict[str, Any]:
    load = np.geomspace(0.2 * last, last, 20)
    exponent = float(np.polyfit(np.log(load), np.log(_friction(law, load)), 1)[0])
    return {"exponent": float(f"{exponent:.{DIGITS}g}"), "load_range": _loads([0.2 * last, last], units)}


def _line(law: FrictionLaw, last: float, units: Units) -> dict[str, Any]:
    single = "friction_coefficient" if units.newtons else "slope"
    return {single: _slopes(law, last, LINE, units)[0]}


def _two(law: FrictionLaw, last: float, units: Units) -> dict[str, Any]:
    several = "friction_coefficients" if units.newtons else "slopes"
    return {several: _slopes(law, last, TWO, units), "crossover_load": _loads([TWO[1] * last], units)[0]}


def _three(law: FrictionLaw, last: float, units: Units) -> dict[str, Any]:
    several = "friction_coefficients" if units.newtons else "slopes"
    return {
        several: _slopes(law, last, THREE, units),
        "crossover_loads": _loads([THREE[1] * last, THREE[2] * last], units),
        "load_range": _loads([THREE[0] * last, last], units),
    }


VALUES: Mapping[str, Callable[[FrictionLaw, float, Units], dict[str, Any]]] = {
    "operating-points": _points,
    "linear": _line,
    "bilinear": _two,
    "power": _power,
    "multilinear": _three,
    "sampled": _samples,
}


def _friction(law: FrictionLaw, load: FloatArray) -> FloatArray:
    return np.asarray(np.interp(load, law.rescaled_load, law.area))


def _slopes(law: FrictionLaw, last: float, ends: tuple[float, ...], units: Units) -> list[float]:
    """Return the slope of the law between neighbouring ends, or the friction coefficients."""
    found = []
    for low, high in pairwise(ends):
        load = np.linspace(low * last, high * last, 20)
        slope = float(np.polyfit(load, _friction(law, load), 1)[0]) * units.friction / units.load
        found.append(float(f"{slope:.{DIGITS}g}"))
    return found


def _loads(rescaled: list[float], units: Units) -> list[str]:
    unit = "N" if units.newtons else "mm^2"
    return [f"{units.load * load:.{DIGITS}g} {unit}" for load in rescaled]
