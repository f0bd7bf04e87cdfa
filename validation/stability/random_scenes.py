"""Four thousand random scenes: few are refused or not solved, and none without a message."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

import metafem as mf
from validation.check import Check, Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods.equation_errors import equation_error
from validation.scenes.random_contacts import CROWDING, LAYER, WIDTH, Scene, random_scene
from validation.sources import known_input, self_consistency

# Half a minute of one core.
SLOW = True

# Scenes of the report, half of them inside the documented ranges; the tests set a smaller number.
SCENES = 4_000

# Largest part of the scenes outside the ranges that may be refused or not solved, and not solved.
REFUSED, UNSOLVED = 0.1, 0.01

# Largest error of the equations, recomputed with the laws themselves: ten times that of their tables.
EQUATIONS = 1e-8

# The same for adhesive contacts, whose equations on slopes contain a second derivative of the profile.
ADHESIVE = 1e-9

LARGEST = "largest error of the recomputed equations"

# The numbers in a reason, without the exponents of units.
NUMBERS = re.compile(r"(?<![\^\w])-?\d[\d.e+-]*")

# Refused: the input is beyond a stated limit. Not solved: the solver does not converge, or the search of a
# design misses its target; it says so. Failed: anything else, such as an error of Python.
ENDS = ("converged", "refused", "not solved", "failed")

RECOMPUTED = self_consistency(equation_error, "the equations in plain numpy, without the compiled kernels")
INSIDE = known_input(
    f"documented ranges, a/R to {WIDTH:g}, a/r to {CROWDING:g}, a/t to {LAYER:g}: every scene must be solved"
)
FEW = known_input("requirement: outside the ranges at most one scene in ten has no solution")
RARE = known_input("requirement: outside the ranges solver or search fails in at most one scene of a hundred")
REASON = known_input("requirement: a scene ends with a solution within its tolerance or with a stated reason")


@dataclass(frozen=True)
class Outcome:
    """What became of a scene: its end, the reason of a refusal or failure, and the error of its equations."""

    seed: int
    inside: bool
    model: str
    law: str
    end: str
    reason: str = ""
    error: float | None = None


def outcome(seed: int, inside: bool) -> Outcome:
    """Solve a scene and return what became of it; any exception but a MetafemError is a failure."""
    scene = random_scene(seed, inside)
    names = seed, inside, scene.kind, type(scene.law).__name__
    try:
        if scene.kind == "design":
            return _designed(names, scene)
        given = {"load" if scene.by_load else "approach": scene.control}
        curve = scene.model.curve(scene.surface, **given)
        last = curve.last
        error = equation_error(scene.surface, scene.model, curve) if curve.converged else None
    except mf.MetafemError as reason:
        end = "not solved" if isinstance(reason, mf.NotConverged) else "refused"
        return Outcome(*names, end if str(reason) else "failed", str(reason) or "no reason is given")
    except Exception as reason:
        return Outcome(*names, "failed", repr(reason))
    numbers = (curve.approach, curve.load, curve.area, last.load, last.area, last.indentation)
    if not all(np.isfinite(each).all() for each in numbers):
        return Outcome(*names, "failed", "a number is not finite")
    if not curve.converged:
        return Outcome(*names, "not solved", curve.status.value)
    return Outcome(*names, "converged", error=error)


def _designed(names: tuple[int, bool, str, str], scene: Scene) -> Outcome:
    """Design the heights again from the law of the surface of a scene."""
    law = scene.model.curve(scene.surface, scene.control).checked()
    top = float(scene.surface.height.max())
    template = scene.surface.replaced(height=np.full(scene.surface.count, top))
    target = mf.SampledLaw(law.load, law.area)
    # high enough for the plane to stay above the base at the loads of the target
    limits = mf.Limits(top, offset=max(0.0, float(law.approach[-1])))
    design = mf.design(target, template, scene.model, limits=limits)
    end = "not solved" if design.status.name == "MISSED" else "converged"
    reason = design.status.value if end == "not solved" else ""
    return Outcome(*names, end, reason)


def claim() -> Claim:
    """Documented ranges: a/R ≤ {width:g}, a/r ≤ {crowding:g}, a/t ≤ {layer:g} on a layer, with the contact
    radius a, the radius of curvature R, the distance r of the nearest neighbour and the thickness t. The
    loads of half of the scenes end inside them, those of the others at one to two times their ends. Of
    {designs:,} designs {refused_designs:,} were refused, of {others:,} other scenes {refused_others:,}. A
    design is refused with a message where its target needs loads at which the plane reaches the base plane.
    In {unsolved:,} scenes the solver did not converge or the search of a design missed its target; these are
    failures of the method, which it states. The rows “refused”, “not solved” and “failed” list all reasons.
    Each scene follows from its seed: `outcome(8, inside=False)` repeats that of seed 8 outside the ranges.
    """
    found = [outcome(seed, inside) for inside in (True, False) for seed in range(SCENES // 2)]
    return Claim(
        "Random scenes: surfaces, contact laws, models and loads",
        [*_checks(found), *_results(found)],
        {"ends by model and law": Picture(partial(_ends, found))},
        _numbers(found),
    )


def _checks(found: list[Outcome]) -> list[Check]:
    """Compare the numbers of failures and refusals, and the errors, with what is allowed."""
    inside, outside = ([each for each in found if each.inside == side] for side in (True, False))
    solved = [each for each in found if each.end == "converged"]
    curves = [each for each in solved if each.model != "design"]
    return [
        near("scenes that fail", _count(found, "failed"), 0, 0, REASON),
        near("inside the ranges: scenes that are refused", _count(inside, "refused"), 0, 0, INSIDE),
        near("inside the ranges: scenes that are not solved", _count(inside, "not solved"), 0, 0, INSIDE),
        below(
            "outside the ranges: part of the scenes that is refused or not solved",
            (_count(outside, "refused") + _count(outside, "not solved")) / len(outside), REFUSED, FEW,
        ),
        below(
            "outside the ranges: part of the scenes that is not solved",
            _count(outside, "not solved") / len(outside), UNSOLVED, RARE,
        ),
        below(f"{LARGEST}, without adhesion", _largest_error(curves, False), EQUATIONS, RECOMPUTED),
        below(f"{LARGEST}, with adhesion", _largest_error(curves, True), ADHESIVE, RECOMPUTED),
    ]  # fmt: skip


def _largest_error(curves: list[Outcome], adhesive: bool) -> float:
    errors = [each.error for each in curves if (each.law == "JKR") == adhesive]
    return max((error for error in errors if error is not None), default=0.0)


def _results(found: list[Outcome]) -> Iterator[Row]:
    """State how many scenes are solved."""
    recomputed = sum(each.error is not None for each in found)
    yield reported("scenes", len(found), "half of them inside the documented ranges")
    last = "those that converge, at the last load"
    yield reported("scenes whose equations are recomputed", recomputed, last)
    designs, others = _designs(found)
    every, rest = f"of {len(designs):,} designs", f"of {len(others):,} other scenes"
    missed = _count(designs, "not solved")
    yield reported("scenes whose solver does not converge", _count(others, "not solved"), "it says so")
    yield reported("designs whose search misses the target", missed, f"{every}; it says so")
    yield reported("designs that are refused", _count(designs, "refused"), every)
    yield reported("other scenes that are refused", _count(others, "refused"), rest)
    yield from _unsolved(found)


def _groups(found: list[Outcome], kind: str) -> dict[str, list[Outcome]]:
    """Return the outcomes by model or law, sorted by name."""
    groups = defaultdict(list)
    for each in found:
        groups[getattr(each, kind)].append(each)
    return dict(sorted(groups.items()))


def _count(found: list[Outcome], end: str) -> int:
    return sum(each.end == end for each in found)


def _numbers(found: list[Outcome]) -> dict[str, float]:
    """Return the numbers that the text states."""
    designs, others = _designs(found)
    return {
        "width": WIDTH, "crowding": CROWDING, "layer": LAYER, "unsolved": _count(found, "not solved"),
        "designs": len(designs), "refused_designs": _count(designs, "refused"),
        "others": len(others), "refused_others": _count(others, "refused"),
    }  # fmt: skip


def _designs(found: list[Outcome]) -> tuple[list[Outcome], list[Outcome]]:
    """Return the outcomes of designs, and the others."""
    designs = [each for each in found if each.model == "design"]
    return designs, [each for each in found if each.model != "design"]


def _unsolved(found: list[Outcome]) -> list[Row]:
    """Return a row for each reason of the scenes without a solution, with some seeds and a message."""
    groups = defaultdict(list)
    for each in found:
        if each.end != "converged":
            short = re.split(r"[:;](?= )", each.reason)[0]
            groups[each.end, NUMBERS.sub("…", short)].append(each)
    return [
        reported(f"{end}: {reason}", len(group), f"the first: {_named(group[0])}: “{group[0].reason}”")
        for (end, reason), group in sorted(groups.items(), key=lambda item: -len(item[1]))
    ]


def _named(each: Outcome) -> str:
    return f"seed {each.seed} {'inside' if each.inside else 'outside'} the ranges"


@panels(9.0, 4.0, columns=2)
def _ends(found: list[Outcome], *axes):
    """How the scenes of each kind of model, and of each contact law, end: those inside and outside the
    documented ranges together. Designs are refused where the plane would reach the base plane below their
    largest load.
    """
    for ax, kind in zip(axes, ("model", "law"), strict=True):
        groups = _groups(found, kind)
        counts = {name: Counter(each.end for each in group) for name, group in groups.items()}
        left = np.zeros(len(groups))
        for end, colour in zip(ENDS, ("C0", "C1", "C4", "C3"), strict=True):
            width = np.array([100.0 * counts[name][end] / len(groups[name]) for name in groups])
            ax.barh(list(groups), width, left=left, color=colour, label=end)
            left += width
        ax.set(xlabel="part of the scenes [%]", xlim=(0, 100), title=f"by {kind}")
    axes[0].figure.legend(*ax.get_legend_handles_labels(), frameon=False, loc="outside lower center", ncols=3)
