"""Other targets near a law: of another kind or choice of keys, and the nearest that can be designed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.answer import Answer, answered, specification_of
from metafem.explorer.handles import RESOLUTION, added, scene_of
from metafem.explorer.history import State
from metafem.explorer.scene import NEWTON_KEYS, Keys, Numbers, members
from metafem.explorer.table import Table, section_of, with_only, with_section, with_values
from metafem.files import Specification
from metafem.inversion import Design, Limits, SampledLaw, Target, achievable_load_range
from metafem.inversion.wording import RESCALED, Wording

# Rescaled friction at rescaled loads [mm^2].
Law = Callable[[FloatArray], FloatArray]

# Number of operating points, and of samples of a law.
POINTS, SAMPLES = 4, 8

# Half-width of a band around the law of the last design, relative to the law.
HALF_WIDTH = 0.05

# Relative resolution of a target after a change of units. The change of the law is too small to see.
RESTATED = 1e-6

# Distance of a load range from the ends of the reached loads, relative to them, for rounding.
EDGE = 0.01

# Number of the choice of target keys that are forces or friction coefficients.
FORCES = 1

# First load of the new target if the present target has a single load, as a fraction of that load.
START = 0.25


def with_kind_near(state: State, design: Design | None, kind: str) -> Table:
    """Return the table of a state with a target of another kind that is close to the law of the last design.

    The values keep their units. Without a design, or if the state has problems, the values are the examples
    of the manual.

    Raises
    ------
    InvalidInput
        If the kind is unknown or the text is not valid TOML.

    Examples
    --------
    >>> from metafem.files import demo_text, of_table, parsed
    >>> text = demo_text("operating-points")
    >>> of_table(with_kind_near(State(text), parsed(text).design(), "power")).target.load_range
    (0.144, 0.649)
    """
    if kind not in KINDS:
        raise InvalidInput(f'kind = "{kind:.40}" is unknown (known: {", ".join(KINDS)})')
    if kind == section_of(state.table, "target").get("kind"):
        return state.table
    try:
        if design is not None:
            return near_design(state, specification_of(state), design, kind)
    except MetafemError:
        pass  # the state has problems
    return with_section(state.table, "target", kind)


def near_design(state: State, specification: Specification, design: Design, kind: str = "") -> Table:
    """Return the table with a target of a kind, default: its own, that is close to the law of a design."""
    scene = scene_of(state, specification, design)
    target, kind = scene.target, kind or scene.kind
    law, low, high = _present(design, specification.limits)
    numbers = KINDS[kind][1](law, low, high)
    if kind == "linear" and target.wording.per_slope:  # a friction coefficient is F/P at these loads
        numbers["load_range"] = [low, high]
    if "rescaled_friction" in numbers:
        numbers = _with_bends(numbers, law, target)
    return with_only(state.table, "target", {"kind": kind, **scene.stated(numbers, RESOLUTION)})


def with_units(state: State, section: str, choice: int, specification: Specification | None) -> Table:
    """Return the table with the keys of another choice of a section; a valid target keeps its law.

    A friction coefficient without a load range is then F/P over the widest range of loads in which
    independent asperities reach it. All other new keys have the examples of the manual.
    """
    kind = section_of(state.table, section).get("kind", "")
    if section != "target" or specification is None:
        return with_section(state.table, section, kind, choice)
    template, same, given = specification.template, Keys(), section_of(state.table, "target")
    if choice != FORCES or template.friction is not None:
        scene, wording = scene_of(state, specification, None), RESCALED
        if choice == FORCES and template.friction is not None:
            wording = Wording.of(template.material, template.friction)
        same = scene.stated(members(scene.target, NEWTON_KEYS), RESTATED, wording=wording)
    table = with_section(state.table, section, kind, choice, same)
    if choice == FORCES and "slope" in given and "load_range" not in given:
        table = with_values(table, {"target.load_range": _reached_forces(specification)})
    return table


def _reached_forces(specification: Specification) -> list[str] | None:
    """Return the loads between which a line through the origin is reached, or None."""
    target: Any = specification.target
    template, limits, tools = specification.template, specification.limits, specification.tools
    try:
        low, high = achievable_load_range(target, template, limits, tools)
    except MetafemError:
        return None
    modulus = template.material.composite_modulus
    return [f"{modulus * end:.3g} N" for end in (low * (1.0 + EDGE), high * (1.0 - EDGE))]


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


def _band(law: Law, low: float, high: float) -> Numbers:
    load = np.geomspace(low, high, SAMPLES)
    lowest, highest = ((factor * law(load)).tolist() for factor in (1.0 - HALF_WIDTH, 1.0 + HALF_WIDTH))
    return {"rescaled_load": load.tolist(), "lowest": lowest, "highest": highest}


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
    "operating-points": (
        "operating points",
        lambda law, low, high: _along(law, np.linspace(low, high, POINTS)),
    ),
    "linear": ("straight line (linear)", lambda *law: {"slope": _slope(*law)}),
    "bilinear": ("two branches (bilinear)", _bilinear),
    "multilinear": ("several branches (multilinear)", _multilinear),
    "power": ("power law", _power),
    "sampled": ("curve (sampled)", lambda law, low, high: _along(law, np.geomspace(low, high, SAMPLES))),
    "band": ("between two curves (band)", _band),
}


# Largest number of nearest laws, each of the refusal of the one before, that are tried.
MOST_STEPS = 3

# Relative resolution of the values. It is finer than 1e-6, the relative distance of the nearest law from its
# bound.
CLOSE = 1e-9

# Members of a nearest law that can differ from those of the target.
MEMBERS = (
    "rescaled_load", "rescaled_friction", "exponent", "prefactor", "slope", "slopes", "crossover_load",
    "load_range",
)  # fmt: skip


def offer(answer: Answer) -> str:
    """Return the label of the button that adopts the nearest law of an answer; "" if none is known."""
    return "" if answer.nearest_target is None or answer.specification is None else "Use the nearest law"


def reachable(answer: Answer) -> Table:
    """Return the table of a refused answer with a target near it that can be designed.

    It is the nearest law of the refusal if one is known, otherwise a target close to the law of the last
    design.
    """
    found = answer
    for _ in range(MOST_STEPS):
        if found.nearest_target is None:
            break
        state = answer.state.edited(with_nearest(found))
        found = answered(state, answer.number, answer, draft=True)
        if found.undecided:  # only the whole search decides
            found = answered(state, answer.number, answer)
        if not found.refused:
            return state.table
    if answer.design is None or answer.specification is None:
        raise InvalidInput("no law is known that can be designed")
    return near_design(answer.state, answer.specification, answer.design)


def with_point(answer: Answer, load: float, friction: float, near: float) -> Table:
    """Return the table of an answer with one more point of the target at a rescaled load and friction [mm^2].

    If the friction differs by at most `near` from that of the achieved law, the point is on it; if no surface
    passes through all points then, they become a curve that is approximated.
    """
    scene = scene_of(answer.state, answer.specification, answer.design)
    free, found = added(scene, load, friction), added(scene, load, friction, near)
    if found != free and answered(answer.state.edited(found), answer.number, draft=True).refused:
        return with_values(found, {"target.kind": "sampled"})
    return found


def with_nearest(answer: Answer) -> Table:
    """Return the table of a refused answer, with the nearest law that can be designed as the target."""
    target, specification = answer.nearest_target, answer.specification
    if target is None or specification is None:
        raise InvalidInput("no nearest law is known")
    scene = scene_of(answer.state, specification, answer.design)
    numbers = members(target, MEMBERS)
    if isinstance(target, SampledLaw) and scene.kind != "sampled":  # no law of the kind is near
        return with_only(answer.state.table, "target", {"kind": "sampled", **scene.stated(numbers, CLOSE)})
    return scene.written(numbers, CLOSE)
