"""Targets of another kind that are close to the law of the last design."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.answer import specification_of
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.handles import RESOLUTION
from metafem.explorer.text.marks import NEWTON_KEYS, Numbers, Scene, members
from metafem.files import Specification
from metafem.inversion import Design, Limits, Target
from metafem.inversion.wording import RESCALED, Wording

# Rescaled friction at rescaled loads [mm^2].
Law = Callable[[FloatArray], FloatArray]

# Number of operating points, and of samples of a law.
POINTS, SAMPLES = 4, 8

# Half-width of a band around the law of the last design, relative to the law.
HALF_WIDTH = 0.05

# Relative resolution of a target after a change of units. The change of the law is too small to see.
RESTATED = 1e-6

# First load of the new target if the present target has a single load, as a fraction of that load.
START = 0.25


def with_kind(state: State, design: Design | None, kind: str) -> str:
    """Return the text of a state with a target of another kind that is close to the law of the last design.

    The values keep their units. Without a design, or if the text has problems, the values are the examples of
    the manual.

    Raises
    ------
    InvalidInput
        If the kind is unknown or the text is not valid TOML.

    Examples
    --------
    >>> from metafem.files import demo_text, parsed
    >>> text = demo_text("operating-points")
    >>> new = with_kind(State(text), parsed(text).design(), "power")
    >>> parsed(new).target.load_range
    (0.144, 0.649)
    """
    document = Document(state.text)
    if kind not in KINDS:
        raise InvalidInput(f'kind = "{kind:.40}" is unknown (known: {", ".join(KINDS)})')
    if kind == document.value("target.kind"):
        return state.text
    try:
        if design is not None:
            return near_design(state, specification_of(state), design, kind)
    except MetafemError:
        pass  # the text has problems
    return document.with_kind("target", kind)


def near_design(state: State, specification: Specification, design: Design, kind: str = "") -> str:
    """Return the text with a target of a kind, default: its own, that is close to the law of a design."""
    scene = Scene(Document(state.text), specification, design)
    target, kind = scene.target, kind or scene.kind
    law, low, high = _present(design, specification.limits)
    numbers = KINDS[kind][1](law, low, high)
    if kind == "linear" and target.wording.per_slope:  # a friction coefficient is F/P at these loads
        numbers["load_range"] = [low, high]
    if "rescaled_friction" in numbers:
        numbers = _with_bends(numbers, law, target)
    return scene.document.with_kind("target", kind, scene.stated(numbers, RESOLUTION))


def restated(text: str, specification: Specification, newtons: bool) -> dict[str, Any]:
    """Return the keys of the same target in newtons or rescaled; no keys for newtons without a friction."""
    scene, friction = Scene(Document(text), specification, None), specification.template.friction
    if newtons and friction is None:
        return {}
    material = specification.template.material
    wording = Wording.of(material, friction) if newtons and friction else RESCALED
    return scene.stated(members(scene.target, NEWTON_KEYS), RESTATED, wording=wording)


def _present(design: Design, limits: Limits) -> tuple[Law, float, float]:
    """Return the law of a design as a function, and the smallest and largest load of its target [mm^2].

    Heights above the limits are scaled down; friction is proportional to the heights, and load to their
    power 3/2.
    """
    law = design.law
    scale = min(1.0, limits.max_height / (float(design.surface.height.max()) - limits.offset))
    low, high = (scale**1.5 * float(end) for end in design.target_law.load[[0, -1]])
    loads, frictions = scale**1.5 * law.rescaled_load, scale * law.rescaled_friction
    return (
        lambda load: np.asarray(np.interp(load, loads, frictions)),
        low if low < high else START * high,
        high,
    )


def _along(law: Law, load: FloatArray) -> Numbers:
    """Return points of a law."""
    return {"rescaled_load": load.tolist(), "rescaled_friction": law(load).tolist()}


def _with_bends(numbers: Numbers, law: Law, target: Target) -> Numbers:
    """Return points of a law, with inner points moved to the crossover loads of the previous target."""
    edges = [load for _, ends in target.branches for load in ends][1:-1]
    load = np.array(numbers["rescaled_load"])
    for bend in edges or [start for _, start in target.lines[1:]]:
        if len(load) > 2 and load[0] < bend < load[-1]:
            load[1 + np.abs(load[1:-1] - bend).argmin()] = bend
    return _along(law, load)


def _points(law: Law, low: float, high: float) -> Numbers:
    return _along(law, np.linspace(low, high, POINTS))


def _sampled(law: Law, low: float, high: float) -> Numbers:
    return _along(law, np.geomspace(low, high, SAMPLES))


def _band(law: Law, low: float, high: float) -> Numbers:
    load = np.geomspace(low, high, SAMPLES)
    lowest, highest = ((factor * law(load)).tolist() for factor in (1.0 - HALF_WIDTH, 1.0 + HALF_WIDTH))
    return {"rescaled_load": load.tolist(), "lowest": lowest, "highest": highest}


def _linear(law: Law, low: float, high: float) -> Numbers:
    return {"slope": _slope(law, low, high)}


def _bilinear(law: Law, low: float, high: float) -> Numbers:
    middle = 0.5 * (low + high)
    return {"slopes": [_slope(law, low, middle), _slope(law, middle, high)], "crossover_load": middle}


def _power(law: Law, low: float, high: float) -> Numbers:
    load = np.geomspace(low, high, SAMPLES)
    exponent = float(np.polyfit(np.log(load), np.log(law(load)), 1)[0])
    return {"exponent": exponent, "load_range": [low, high]}


def _multilinear(law: Law, low: float, high: float) -> Numbers:
    halves = _bilinear(law, low, high)
    ends = {"crossover_loads": [halves["crossover_load"]], "load_range": [low, high]}
    return {"slopes": halves["slopes"], **ends}


def _slope(law: Law, low: float, high: float) -> float:
    """Return the least-squares slope of a law between two loads [-]."""
    load = np.linspace(low, high, SAMPLES)
    return float(np.polyfit(load, law(load), 1)[0])


# Name of each kind on the page, and the target of the kind near a law between two loads.
KINDS: Mapping[str, tuple[str, Callable[[Law, float, float], Numbers]]] = {
    "operating-points": ("operating points", _points),
    "linear": ("straight line (linear)", _linear),
    "bilinear": ("two branches (bilinear)", _bilinear),
    "multilinear": ("several branches (multilinear)", _multilinear),
    "power": ("power law", _power),
    "sampled": ("curve (sampled)", _sampled),
    "band": ("between two curves (band)", _band),
}
