"""The nearest law that can be designed, as the target of a specification."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, answered
from metafem.explorer.text.document import Document
from metafem.explorer.text.handles import added, scene_of
from metafem.explorer.text.kinds import near_design
from metafem.explorer.text.marks import members
from metafem.inversion import OperatingPoints, SampledLaw
from metafem.inversion.wording import listed

# Largest number of nearest laws, each of the refusal of the one before, that are tried.
MOST_STEPS = 3

# Relative resolution of the values. It is finer than 1e-6, the relative distance of the nearest law from its
# bound.
RESOLUTION = 1e-9

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
        return scene.document.with_kind("target", "sampled", scene.stated(numbers, RESOLUTION))
    return scene.written(numbers, RESOLUTION)
