"""Targets of another kind that are close to the law of the last design."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import Infeasible, InvalidInput, MetafemError
from metafem.explorer.answer import specification_of
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.handles import RESOLUTION
from metafem.explorer.text.marks import Scene
from metafem.explorer.text.names import form_of
from metafem.explorer.text.written import rounded
from metafem.files import Specification, parsed
from metafem.inversion import Design, Limits, Target
from metafem.inversion.targets.wording import RESCALED, Wording
from metafem.models import Independent
from metafem.models.model import contact_of

# Names of the kinds on the page.
NAMES: Mapping[str, str] = {
    "operating-points": "operating points",
    "linear": "straight line (linear)",
    "bilinear": "two branches (bilinear)",
    "multilinear": "several branches (multilinear)",
    "power": "power law",
    "sampled": "curve (sampled)",
    "band": "between two curves (band)",
}

# Numbers of operating points to try, in this order, and the number of samples of a law.
POINTS, SAMPLES = (4, 3, 2, 1), 8

# Half-width of a band around the law of the last design, relative to the law.
HALF_WIDTH = 0.05

# Relative resolution of a target after a change of units. The change of the law is too small to see.
RESTATED = 1e-6

# First load of the new target if the present target has a single load, as a fraction of that load.
START = 0.25

# Distance of a value from the bound of the reachable values, in units of the resolution. Rounding moves a
# value by at most half a unit.
INSIDE = 4.0

# Largest number of sites for which designs are tried. With more sites, the user would wait too long.
MOST_TRIED = 256

# Members of a target by name: slopes [-], loads and frictions [mm^2].
Numbers = dict[str, Any]


def kind_names() -> dict[str, str]:
    """Return the names of the target kinds on the page, by kind, in the order of the manual."""
    form = form_of("target")
    return {} if form is None else {kind: NAMES.get(kind, kind) for kind in form.kinds}


def with_kind(state: State, design: Design | None, kind: str) -> str:
    """Return the text of a state with a target of another kind that is close to the law of the last design.

    The values keep their units. With up to 256 sites, several targets are tried, each also with its nearest
    reachable values. The result is the first target that independent asperities reach, or the first of all if
    they reach none. Without a design, or if the text has problems, the values are the examples of the manual.

    Raises
    ------
    InvalidInput
        If the kind is unknown or the text is not valid TOML.

    Examples
    --------
    >>> from metafem.files import demo_text
    >>> text = demo_text("operating-points")
    >>> new = with_kind(State(text), parsed(text).design(), "power")
    >>> parsed(new).target.load_range
    (0.144, 0.649)
    """
    document = Document(state.text)
    if kind not in ATTEMPTS:
        raise InvalidInput(f'kind = "{kind:.40}" is unknown (known: {", ".join(ATTEMPTS)})')
    if kind == document.value("target.kind"):
        return state.text
    try:
        specification = specification_of(state)
        if design is not None:
            return near_design(document, specification, design, kind)
    except MetafemError:
        pass  # the text has problems
    return document.with_kind("target", kind)


def near_design(
    document: Document,
    specification: Specification,
    design: Design,
    kind: str = "",
    resolution: float = RESOLUTION,
) -> str:
    """Return the text with a target of a kind, default: its own, that is close to the law of a design."""
    kind = kind or str(document.value("target.kind"))
    scene, tables = Scene(document, specification, design), _tables(document, specification)
    wording, template, first = scene.target.wording, specification.template, ""
    law, low, high = _present(design, specification.limits)
    coefficient = kind == "linear" and wording.per_slope is not None
    for numbers in ATTEMPTS[kind](law, low, high):
        if coefficient:  # a friction coefficient is F/P at these loads
            numbers = {**numbers, "load_range": [low, high]}
        if "rescaled_friction" in numbers:
            numbers = _with_bends(numbers, law, scene.target)
        found = document.with_kind("target", kind, _written(numbers, scene, wording, resolution))
        first = first or found
        nearest = _nearest(found, tables) if template.count <= MOST_TRIED else None
        if nearest is None:
            return found
        inside = {name: _beyond(numbers[name], getattr(nearest, name, None), resolution) for name in numbers}
        if all(value is not None for value in inside.values()):
            found = document.with_kind("target", kind, _written(inside, scene, wording, resolution))
            if _nearest(found, tables) is None:
                return found
    return first


def restated(document: Document, specification: Specification, newtons: bool) -> dict[str, Any]:
    """Return the keys of the same target in newtons or rescaled; no keys for newtons without a friction."""
    scene, friction = Scene(document, specification, None), specification.template.friction
    if newtons and friction is None:
        return {}
    wording = (
        RESCALED if friction is None or not newtons else Wording.of(specification.template.material, friction)
    )
    names = ("rescaled_load", "rescaled_friction", "lowest", "highest", "slope", "slopes")
    given = {name: getattr(scene.target, name, None) for name in names}
    numbers = {name: np.asarray(value).tolist() for name, value in given.items() if value is not None}
    return _written(numbers, scene, wording, RESTATED)


def _present(design: Design, limits: Limits) -> tuple[Callable[[FloatArray], FloatArray], float, float]:
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


Law = Callable[[FloatArray], FloatArray]


def _with_bends(numbers: Numbers, law: Law, target: Target) -> Numbers:
    """Return points of a law, with inner points moved to the crossover loads of the previous target."""
    edges = [load for _, ends in target.branches for load in ends][1:-1]
    load = np.array(numbers["rescaled_load"])
    for bend in edges or [start for _, start in target.lines[1:]]:
        if len(load) > 2 and load[0] < bend < load[-1]:
            load[1 + np.abs(load[1:-1] - bend).argmin()] = bend
    return {"rescaled_load": load.tolist(), "rescaled_friction": law(load).tolist()}


def _points(law: Law, low: float, high: float) -> Iterator[Numbers]:
    for count in POINTS:
        load = np.linspace(low, high, count) if count > 1 else np.array([high])
        yield {"rescaled_load": load.tolist(), "rescaled_friction": law(load).tolist()}


def _sampled(law: Law, low: float, high: float) -> Iterator[Numbers]:
    load = np.geomspace(low, high, SAMPLES)
    yield {"rescaled_load": load.tolist(), "rescaled_friction": law(load).tolist()}


def _band(law: Law, low: float, high: float) -> Iterator[Numbers]:
    load = np.geomspace(low, high, SAMPLES)
    lowest, highest = ((factor * law(load)).tolist() for factor in (1.0 - HALF_WIDTH, 1.0 + HALF_WIDTH))
    yield {"rescaled_load": load.tolist(), "lowest": lowest, "highest": highest}


def _linear(law: Law, low: float, high: float) -> Iterator[Numbers]:
    yield {"slope": _slope(law, low, high)}


def _bilinear(law: Law, low: float, high: float) -> Iterator[Numbers]:
    for share in (0.5, 0.25):
        middle = low + share * (high - low)
        first, second = _slope(law, low, middle), _slope(law, middle, high)
        yield {"slopes": [first, second], "crossover_load": middle}
    whole = _slope(law, low, high)
    for ratio in (4.0 / 3.0, 1.2, 1.1):
        yield {"slopes": [whole, ratio * whole], "crossover_load": 0.5 * (low + high)}


def _power(law: Law, low: float, high: float) -> Iterator[Numbers]:
    load = np.geomspace(low, high, SAMPLES)
    yield {
        "exponent": float(np.polyfit(np.log(load), np.log(law(load)), 1)[0]),
        "load_range": [low, high],
    }


def _multilinear(law: Law, low: float, high: float) -> Iterator[Numbers]:
    middle = 0.5 * (low + high)
    slopes = [_slope(law, low, middle), _slope(law, middle, high)]
    yield {"slopes": slopes, "crossover_loads": [middle], "load_range": [low, high]}
    whole = _slope(law, low, high)
    yield {"slopes": [whole, whole], "crossover_loads": [middle], "load_range": [low, high]}


ATTEMPTS: dict[str, Callable[[Law, float, float], Iterator[Numbers]]] = {
    "operating-points": _points,
    "linear": _linear,
    "bilinear": _bilinear,
    "sampled": _sampled,
    "power": _power,
    "multilinear": _multilinear,
    "band": _band,
}


def _slope(law: Law, low: float, high: float) -> float:
    """Return the least-squares slope of a law between two loads [-]."""
    load = np.linspace(low, high, SAMPLES)
    return float(np.polyfit(load, law(load), 1)[0])


def _written(numbers: Numbers, scene: Scene, wording: Wording, resolution: float) -> dict[str, Any]:
    """Return the keys and values of a target in the units of a `Wording`."""
    rescaled, forces = wording.composite_modulus is None, wording.per_slope is not None
    found: dict[str, Any] = {}
    for name, value in numbers.items():
        if name == "rescaled_load":
            key, like = ("load", "1 N") if forces else (name, "1 mm^2")
            found[key] = [scene.load(load, like, resolution) for load in value]
        elif name == "rescaled_friction":
            key, like = ("friction_force", "1 N") if forces else (name, "1 mm^2")
            found[key] = [scene.friction(friction, like, resolution) for friction in value]
        elif name in ("lowest", "highest"):
            key, like = (f"{name}_force", "1 N") if forces else (name, "1 mm^2")
            found[key] = [scene.friction(friction, like, resolution) for friction in value]
        elif name == "exponent":
            found[name] = rounded(value, resolution)
        elif name == "slope":
            found[wording.keys[0]] = rounded(wording.coefficient(value), resolution)
        elif name == "slopes":
            found[wording.keys[1]] = [rounded(wording.coefficient(slope), resolution) for slope in value]
        else:
            like = "1 mm^2" if rescaled else "1 N"
            loads = [scene.load(load, like, resolution) for load in np.atleast_1d(value)]
            found[name] = loads if isinstance(value, list) else loads[0]
    return found


def _nearest(text: str, tables: Mapping[str, bytes]) -> Any:
    """Return None if independent asperities reach the target of a text, otherwise the nearest target.

    If no nearest target is known, an empty tuple is returned.
    """
    try:
        specification = parsed(text, tables)
        model = Independent(contact_of(specification.model))
        replace(specification, layout=None, robust=None).design(model)
    except Infeasible as error:
        return error.nearest or ()
    except InvalidInput:
        return ()
    return None


def _beyond(wanted: Any, nearest: Any, resolution: float) -> Any:
    """Return the numbers `nearest`, moved slightly further from `wanted`; None if their shapes differ."""
    if nearest is None or np.shape(nearest) != np.shape(wanted):
        return None
    near = np.asarray(nearest, dtype=np.float64)
    moved = near * (1.0 + INSIDE * resolution * np.sign(near - np.asarray(wanted)))
    return moved.tolist()


def _tables(document: Document, specification: Specification) -> dict[str, bytes]:
    """Return the contents of the tables that a text refers to, by the names in the text."""
    places = ("target", "contact", "contact.cap")
    names = [name for place in places if (name := document.value(f"{place}.file"))]
    return dict(zip(names, list(specification.files.values())[1:], strict=True))
