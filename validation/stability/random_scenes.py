"""Four thousand random scenes: few are refused or not solved, and none without a message."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd

import metafem as mf
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods.equation_errors import equation_error
from validation.scenes.random_contacts import CROWDING, LAYER, WIDTH, Scene, random_scene
from validation.sources import known_input, self_consistency

# A minute of one core.
SLOW = True

# Scenes of the report, half of them inside the documented ranges.
SCENES = 4_000

# Largest part of the scenes outside the ranges that may be refused or not solved.
REFUSED = 0.1

# Largest error of the equations, recomputed with the laws themselves: ten times that of their tables; and of
# adhesive contacts: ten times the error of the differences in `equation_errors`.
EQUATIONS, ADHESIVE = 1e-8, 1e-10

# The numbers in a reason, without the exponents of units.
NUMBERS = re.compile(r"(?<![\^\w])-?\d[\d.e+-]*")

# Refused: the input is beyond a stated limit. Not solved: the solver does not converge, or the search of a
# design misses its target; it says so. Failed: anything else, such as an error of Python.
CONVERGED, REFUSE, UNSOLVE, FAILED = ENDS = ("converged", "refused", "not solved", "failed")

RECOMPUTED = self_consistency(equation_error, "the equations in plain numpy, without the compiled kernels")
INSIDE = known_input(
    f"documented ranges, a/R to {WIDTH:g}, a/r to {CROWDING:g}, a/t to {LAYER:g}: every scene must be solved"
)
FEW = known_input("requirement: outside the ranges at most one scene in ten has no solution")
REASON = known_input("requirement: a scene ends with a solution within its tolerance or with a stated reason")


class Outcome(NamedTuple):
    """What became of a scene: its end, the reason of a refusal or failure, and the error of its equations."""

    seed: int
    inside: bool
    model: str
    law: str
    end: str
    reason: str = ""
    error: float = np.nan


def outcome(seed: int, inside: bool) -> Outcome:
    """Solve a scene and return what became of it; any exception but a MetafemError is a failure."""
    scene = random_scene(seed, inside)
    names = seed, inside, scene.kind, type(scene.law).__name__
    try:
        return Outcome(*names, *(_designed(scene) if scene.kind == "design" else _solved(scene)))
    except mf.MetafemError as reason:
        end = UNSOLVE if isinstance(reason, mf.NotConverged) else REFUSE
        return Outcome(*names, end if str(reason) else FAILED, str(reason) or "no reason is given")
    except Exception as reason:
        return Outcome(*names, FAILED, repr(reason))


def _solved(scene: Scene) -> tuple[str, str, float]:
    """Return end, reason and error of a curve."""
    curve = scene.model.curve(scene.surface, **{"load" if scene.by_load else "approach": scene.control})
    last = curve.last
    numbers = (curve.approach, curve.load, curve.area, last.load, last.area, last.indentation)
    if not all(np.isfinite(each).all() for each in numbers):
        return FAILED, "a number is not finite", np.nan
    if not curve.converged:
        return UNSOLVE, curve.status.value, np.nan
    return CONVERGED, "", equation_error(scene.surface, scene.model, curve)


def _designed(scene: Scene) -> tuple[str, str]:
    """Design the heights again from the law of the surface of a scene."""
    law = scene.model.curve(scene.surface, scene.control).checked()
    top = float(scene.surface.height.max())
    template = scene.surface.replaced(height=np.full(scene.surface.count, top))
    # high enough for the plane to stay above the base at the loads of the target
    limits = mf.Limits(top, offset=max(0.0, float(law.approach[-1])))
    design = mf.design(mf.SampledLaw(law.load, law.area), template, scene.model, limits=limits)
    return (UNSOLVE, design.status.value) if design.status.name == "MISSED" else (CONVERGED, "")


def claim() -> Claim:
    """Documented ranges: a/R ≤ {width:g}, a/r ≤ {crowding:g}, a/t ≤ {layer:g} on a layer, with the contact
    radius a, the radius of curvature R, the distance r of the nearest neighbour and the thickness t. The
    loads of half of the scenes end inside them, those of the others at one to two times their ends. A design
    is refused with a message where its target needs loads at which the plane reaches the base plane. Where
    the solver does not converge or the search of a design misses its target, the method fails, which it
    states. The rows “refused”, “not solved” and “failed” list all reasons. Each scene follows from its seed:
    `outcome(8, inside=False)` repeats that of seed 8 outside the ranges.
    """
    scenes = ((seed, inside) for inside in (True, False) for seed in range(SCENES // 2))
    found = pd.DataFrame(outcome(*scene) for scene in scenes)
    figures = {"ends by model": Picture(partial(_ends, found))}
    values = {"width": WIDTH, "crowding": CROWDING, "layer": LAYER}
    title = "Random scenes: surfaces, contact laws, models and loads"
    return Claim(title, [*_checks(found), *_reasons(found)], figures, values)


def _checks(found: pd.DataFrame) -> Iterator[Row]:
    """Compare the numbers of failures and refusals, and the errors, with what is allowed."""
    ends = pd.crosstab(found.end, found.inside).reindex(ENDS, fill_value=0)
    yield near("scenes that fail", ends.loc[FAILED].sum(), 0, 0, REASON)
    yield near("inside the ranges: scenes that are refused", ends[True][REFUSE], 0, 0, INSIDE)
    yield near("inside the ranges: scenes that are not solved", ends[True][UNSOLVE], 0, 0, INSIDE)
    share = ends[False][[REFUSE, UNSOLVE]].sum() / ends[False].sum()
    yield below("outside the ranges: part of the scenes that is refused or not solved", share, REFUSED, FEW)
    adhesive = found.law == "JKR"
    for words, those, limit in (("without", ~adhesive, EQUATIONS), ("with", adhesive, ADHESIVE)):
        name = f"largest error of the recomputed equations, {words} adhesion"
        yield below(name, found.error[those].max(), limit, RECOMPUTED)
    yield reported("scenes whose equations were recomputed", found.error.notna().sum(), "at the last load")
    yield reported("scenes", len(found), "half of them inside the documented ranges")
    lost, design = found.end == UNSOLVE, found.model == "design"
    yield reported("scenes whose solver does not converge", (lost & ~design).sum(), "it says so")
    yield reported("designs whose search misses the target", (lost & design).sum(), f"of {design.sum():,}")


def _reasons(found: pd.DataFrame) -> Iterator[Row]:
    """Yield a row for each reason of the scenes without a solution, with a seed and a message."""
    lost = found[found.end != CONVERGED]
    short = lost.reason.str.split(r"[:;](?= )", regex=True).str[0].str.replace(NUMBERS, "…", regex=True)
    groups = lost.groupby([lost.end, short], sort=False)
    for (end, reason), group in sorted(groups, key=lambda item: -len(item[1])):
        first = group.iloc[0]
        where = f"seed {first.seed} {'inside' if first.inside else 'outside'} the ranges"
        yield reported(f"{end}: {reason}", len(group), f"the first: {where}: “{first.reason}”")


@panels(6.0, 4.0)
def _ends(found: pd.DataFrame, ax):
    """How the scenes of each kind of model end: those inside and outside the documented ranges together.
    Designs are refused where the plane would reach the base plane below their largest load.
    """
    parts = 100.0 * pd.crosstab(found.model, found.end, normalize="index")
    left = np.zeros(len(parts))
    for end, colour in zip(ENDS, ("C0", "C1", "C4", "C3"), strict=True):
        width = parts.get(end, 0.0 * left)
        ax.barh(parts.index, width, left=left, color=colour, label=end)
        left += width
    ax.set(xlabel="part of the scenes [%]", xlim=(0, 100))
    ax.figure.legend(frameon=False, loc="outside lower center", ncols=4)
