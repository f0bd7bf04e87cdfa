"""Other targets near a law: of another kind or choice of keys, and the nearest that can be designed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput, MetafemError
from metafem.explorer.answer import Answer, answered, specification_of
from metafem.explorer.handles import RESOLUTION, added, scene_of
from metafem.explorer.history import State
from metafem.explorer.scene import NEWTON_KEYS, Numbers, Scene, members
from metafem.explorer.table import Document, form_of
from metafem.files import Specification
from metafem.inversion import Design, Limits, OperatingPoints, SampledLaw, Target, achievable_load_range
from metafem.inversion.wording import RESCALED, Wording, listed

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
    nearest = answer.nearest_target
    if nearest is None or answer.specification is None:
        return ""
    target = answer.specification.target
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
    return f"{'points' if len(numbers) > 1 else 'point'} {listed(list(map(str, numbers)))}"


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
    return near_design(state, answer.specification, answer.design)


def with_point(answer: Answer, load: float, friction: float, near: float) -> str:
    """Return the text of an answer with one more point of the target at a rescaled load and friction [mm^2].

    If the friction differs by at most `near` from that of the achieved law, the point is on it; if no surface
    passes through all points then, they become a curve that is approximated.
    """
    scene = scene_of(answer.state.text, answer.specification, answer.design)
    free, found = added(scene, load, friction), added(scene, load, friction, near)
    if found != free and answered(replace(answer.state, text=found), answer.number, draft=True).refused:
        return Document(found).with_values({"target.kind": "sampled"})
    return found


def with_nearest(answer: Answer) -> str:
    """Return the text of a refused answer, with the nearest law that can be designed as the target."""
    target, specification = answer.nearest_target, answer.specification
    if target is None or specification is None:
        raise InvalidInput("no nearest law is known")
    scene = scene_of(answer.state.text, specification, answer.design)
    numbers = members(target, MEMBERS)
    if isinstance(target, SampledLaw) and scene.kind != "sampled":  # no law of the kind is near
        return scene.document.with_kind("target", "sampled", scene.stated(numbers, CLOSE))
    return scene.written(numbers, CLOSE)


# Distance of a load range from the ends of the reached loads, relative to them, for rounding.
EDGE = 0.01

# Number of the choice of target keys that are forces or friction coefficients.
FORCES = 1


def with_choice(text: str, section: str, choice: int, specification: Specification | None = None) -> str:
    """Return the text with the keys of another choice of a section.

    If `specification` is given, a target keeps its law; a friction coefficient without a load range is then
    F/P over the widest range of loads in which independent asperities reach it. All other new keys have the
    examples of the manual.

    Examples
    --------
    >>> with_choice("[target]\\nkind = 'linear'\\nslope = 7.0", "target", 1)
    '[target]\\nkind = "linear"\\nfriction_coefficient = 1.5\\n'
    """
    document = Document(text)
    given, same, values = document.section(section), dict[str, Any](), dict[str, Any]()
    if section == "target" and specification is not None:
        same = restated(text, specification, newtons=choice == FORCES)
        if choice == FORCES and "slope" in given and "load_range" not in given:
            values["target.load_range"] = _reached_forces(specification)
    for key in document.keys(section):
        if key.choice == choice and key.name not in given:
            values[f"{section}.{key.name}"] = same.get(key.name, key.example)
        elif key.choice not in (None, choice):
            values[f"{section}.{key.name}"] = None
    return _with_radius(document.with_values(values), section)


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


def with_section(text: str, section: str) -> str:
    """Return the text with a new section, whose required keys have the example values of the manual.

    The radii of the section ``tools`` replace ``lattice.radius``.
    """
    document, form = Document(text), form_of(section)
    if form is None or document.value(section) is not None:
        return text
    if form.kinds:
        return document.with_kind(section, next(iter(form.kinds)))
    needed = [key for key in form.keys[""] if key.needed] or form.keys[""][:1]
    values = {f"{section}.{key.name}": key.example for key in needed}
    return _with_radius(document.with_values(values), section)


def without_section(text: str, section: str) -> str:
    """Return the text without a section; an example ``lattice.radius`` replaces ``tools``."""
    document = Document(text)
    values = dict.fromkeys(f"{section}.{key}" for key in document.section(section))
    return _with_radius(document.with_values(values), section)


def _with_radius(text: str, section: str) -> str:
    """Return a text with ``lattice.radius`` unless the changed section ``tools`` replaces it.

    Exponents of tools are those of caps with the radius of the lattice. A missing radius is the example of
    the manual.
    """
    document = Document(text)
    if section != "tools":
        return text
    example = next(key.example for key in document.keys("lattice") if key.name == "radius")
    needed = document.value("tools") is None or document.value("tools.exponent_range") is not None
    radius = (document.value("lattice.radius") or example) if needed else None
    return document.with_values({"lattice.radius": radius})
