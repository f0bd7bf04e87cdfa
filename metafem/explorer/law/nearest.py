"""The nearest law that can be designed, as the target of a specification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, answered
from metafem.explorer.law.kinds import points
from metafem.explorer.law.shown import Units
from metafem.explorer.text.document import Document
from metafem.explorer.text.handles import added
from metafem.explorer.text.kinds import near_design
from metafem.explorer.text.written import stated
from metafem.files import Specification
from metafem.inversion import LinearLaw, OperatingPoints, SampledLaw, Target

# Largest number of nearest laws, each of the refusal of the one before, that are tried.
MOST_STEPS = 3

# Relative resolution of the values, and their significant digits. Both are finer than 1e-6, the relative
# distance of the nearest law from its bound.
RESOLUTION, DIGITS = 1e-9, 10


def offer(answer: Answer) -> str:
    """Return the label of the button that adopts the nearest law of an answer; "" if none is known."""
    nearest = answer.nearest_target
    if nearest is None or answer.specification is None:
        return ""
    target = answer.specification.target
    if isinstance(nearest, LinearLaw) and nearest.load_range == getattr(target, "load_range", None):
        return f"Use {nearest.wording.slopes(nearest.slope)}"
    if not isinstance(nearest, OperatingPoints) or not isinstance(target, OperatingPoints):
        return "Use the nearest law"
    kept, count = len(nearest.rescaled_load), len(target.rescaled_load)
    moved = np.flatnonzero(nearest.rescaled_friction != target.rescaled_friction[:kept]) + 1
    words = f"Move {_numbered(moved.tolist())} to the nearest law"
    if kept < count:
        words += f" and drop {_numbered(list(range(kept + 1, count + 1)))}"
    return words


def _numbered(numbers: list[int]) -> str:
    """Return the numbers of points in words, such as ``points 1 and 2``."""
    *first, last = map(str, numbers)
    return f"points {', '.join(first)} and {last}" if first else f"point {last}"


def reachable(answer: Answer) -> str:
    """Return the text of a refused answer with a target near it that can be designed.

    It is the nearest law of the refusal if one is known, otherwise a target close to the law of the last
    design.
    """
    found, state = answer, answer.state
    for _ in range(MOST_STEPS):
        if found.nearest_target is None:
            break
        text = with_nearest(found)
        found = answered(replace(state, text=text), answer.number, answer, draft=True)
        if found.undecided:  # only the whole search decides
            found = answered(replace(state, text=text), answer.number, answer)
        if not found.refused:
            return text
    if answer.design is None or answer.specification is None:
        raise InvalidInput("no law is known that can be designed")
    return near_design(Document(state.text), answer.specification, answer.design)


def with_point(answer: Answer, load: float, friction: float, near: float) -> str:
    """Return the text of an answer with one more point of the target at a rescaled load and friction [mm^2].

    If the friction differs by at most `near` from that of the achieved law, the point is on it; if no surface
    passes through all points then, they become a curve that is approximated.
    """
    text, specification = answer.state.text, answer.specification
    free = added(text, specification, load, friction)
    found = added(text, specification, load, friction, design=answer.design, near=near)
    if found != free and answered(replace(answer.state, text=found), answer.number, draft=True).refused:
        return Document(found).with_value("target.kind", "sampled")
    return found


def with_nearest(answer: Answer) -> str:
    """Return the text of a refused answer, with the nearest law that can be designed as the target."""
    target, specification = answer.nearest_target, answer.specification
    if target is None or specification is None:
        raise InvalidInput("no nearest law is known")
    document = Document(answer.state.text)
    section = document.value("target")
    if isinstance(target, (OperatingPoints, SampledLaw)):
        values = _points(section, specification, target)
    else:
        values = _parameters(section, specification, target)
    return document.with_values({f"target.{name}": value for name, value in values.items()})


def _points(
    section: Mapping[str, Any], specification: Specification, target: OperatingPoints | SampledLaw
) -> dict[str, Any]:
    """Return the keys and values of the points, in the units of the previous points."""
    given = [(target.rescaled_load, True), (target.rescaled_friction, False)]
    names = ("load", "friction_force") if "load" in section else ("rescaled_load", "rescaled_friction")
    if names[0] not in section:  # the points of a table
        return {"file": None, **points(target.rescaled_load, target.rescaled_friction, Units(), DIGITS)}
    # the nearest law may have fewer points: it may end at the first point that cannot be met
    return {
        name: _stated(column, section[name][: len(column)], specification, loads)
        for name, (column, loads) in zip(names, given, strict=True)
    }


def _parameters(section: Mapping[str, Any], specification: Specification, target: Target) -> dict[str, Any]:
    """Return the keys and values of the law parameters that differ from the text."""
    values: dict[str, Any] = {}
    for name in ("exponent", "prefactor", "slope", "slopes", "crossover_load", "load_range"):
        new = getattr(target, name, None)
        if new is None or new == getattr(specification.target, name):
            continue
        if name.startswith("slope"):
            key = name if name in section else name.replace("slope", "friction_coefficient")
            told = target.wording.coefficient
            values[key] = [told(slope) for slope in new] if name == "slopes" else told(new)
        elif name in ("exponent", "prefactor"):
            values[name] = new
        elif name == "crossover_load":
            values[name] = _stated([new], [section[name]], specification, True)[0]
        else:
            values[name] = _stated(new, section[name], specification, True)
    return values


def _stated(
    values: FloatArray | list[float], like: list[str], specification: Specification, loads: bool
) -> list[str]:
    """Return rescaled loads or frictions as quantities in the units of the quantities `like`."""
    template = specification.template
    stress: float | None = template.material.composite_modulus
    if not loads:
        pair = template.friction
        stress = None if pair is None else pair.stress
    pairs = zip(values, like, strict=True)
    return [stated(float(value), other, stress, RESOLUTION) for value, other in pairs]
