"""Assignment of the heights of a design to its sites according to a layout."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from metafem import _validate as check
from metafem._validate import IntArray
from metafem.errors import refuse_if
from metafem.inversion.placement.arrange import arrange
from metafem.inversion.placement.objectives import FollowLaw, InsensitiveToTilt, Objective, WeightedObjectives
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.notes import information
from metafem.progress import doing
from metafem.surface import STEEPEST, Surface

if TYPE_CHECKING:
    from metafem.inversion.candidate import Candidate
    from metafem.inversion.problem import Problem
    from metafem.inversion.search.target_law import TargetLaw

# Number of loads for the law (see `FollowLaw`), and for its change by tilts. Each load for the tilts requires
# seven equilibria. With only six loads a third of the gain is lost at intermediate loads.
LAW_LOADS, TILT_LOADS = 20, 10

NO_EFFECT = (
    "the random assignment of heights to sites was kept: without interaction it does not change the law"
)


@dataclass(frozen=True)
class Layout:
    """Objectives for the assignment of heights to the sites of a design, which is otherwise random.

    Parameters
    ----------
    follow_law : bool
        Whether to minimise the change of the law by interaction; default: True. This objective has no effect
        on independent asperities, and is always included under a model with interaction.
    tilt : float, optional
        Misalignment [rad], up to pi/4, for which the change of the law is minimised. Default: None; this
        change is not minimised.
    tilt_weight : float
        Positive weight of the mean square change by the tilt, relative to the weight of the mean square
        deviation from the law; default: 1.

    Raises
    ------
    InvalidInput
        If neither objective is chosen, or a value is outside its range.

    Examples
    --------
    >>> import math
    >>> Layout(tilt=math.radians(0.1)).follow_law
    True
    """

    follow_law: bool = True
    tilt: float | None = None
    tilt_weight: float = 1.0

    def __post_init__(self) -> None:
        check.instance("follow_law", self.follow_law, bool, "True or False")
        check.member(self, "tilt_weight", above=0.0)
        check.member(self, "tilt", optional=True, above=0.0, at_most=STEEPEST)
        aimless = self.tilt is None and not self.follow_law
        refuse_if(aimless, "the layout has no aim: set follow_law = True or tilt, or leave it out")


def arranged(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with its heights arranged by the layout.

    The candidate then also states the misfits before and after the arrangement, and has a note on them. The
    `gradient_model` replaces a model without gradients.
    """
    layout, model = problem.layout, problem.model.gradient_model
    if layout is None:
        return candidate
    surface = candidate.surface(problem.template)
    aims = aims_of(layout, surface, model, candidate.target_law)
    if not aims:
        return replace(candidate, notes=(*candidate.notes, information(NO_EFFECT)))
    with doing("assigning heights to sites"):
        objective = WeightedObjectives([part for _, part, _ in aims], [weight for _, _, weight in aims])
        found = arrange(surface, objective, model, rng)
        changes = [
            f"{words} from {_percent(part, surface, model)} to {_percent(part, found.surface, model)} %"
            for words, part, _ in aims
        ]
    under = "" if model == problem.model else f" under the model {model.name}"
    note = (
        f"the sites of the heights were chosen{under}, before any refinement: this changed "
        f"{' and '.join(changes)} (rms)"
    )
    return replace(
        candidate,
        height=found.surface.height,
        radius=found.surface.radius,
        cap=found.surface.cap,
        parameters={**candidate.parameters, "layout_before": found.before, "layout_after": found.after},
        notes=(*candidate.notes, information(note)),
    )


def aims_of(
    layout: Layout, surface: Surface, model: Model, law: TargetLaw
) -> list[tuple[str, Objective, float]]:
    """Return the aims of a layout: for each aim its name, its objective and its weight."""
    aims: list[tuple[str, Objective, float]] = []
    if model.couples:  # also with a tilt: otherwise the refinement would undo the layout
        independent = Independent(contact=contact_of(model))
        some, area = _some(len(law.load), LAW_LOADS), independent.curve(surface, law.load).area
        friction = law.law(area)[some]
        # a poor fit can decrease with the load; the law of independent asperities then replaces it
        rises = friction[0] > 0.0 and (np.diff(friction) > 0.0).all()
        follow = FollowLaw(law.load[some], friction if rises else area[some])
        aims.append(("the deviation from the law", follow, 1.0))
    if layout.tilt is not None:
        words = f"the change by a tilt of {math.degrees(layout.tilt):.3g} deg"
        load = law.load[_some(len(law.load), TILT_LOADS)]
        aims.append((words, InsensitiveToTilt(load, layout.tilt), layout.tilt_weight))
    return aims


def _some(count: int, most: int) -> IntArray:
    """Return at most `most` evenly spaced indices, including both ends."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def _percent(objective: Objective, surface: Surface, model: Model) -> str:
    residual = objective.residual(surface, model)
    return f"{100.0 * float(np.linalg.norm(residual)):.2g}"
