"""Base class of all target laws."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps import Cap
from metafem.errors import InvalidInput
from metafem.inversion.candidate import Branch, Candidate, Parameter
from metafem.inversion.search.nearest_law import LawSearch
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.targets.wording import LoadRange, Wording

if TYPE_CHECKING:
    from metafem.inversion.bounds import Bounds
    from metafem.inversion.problem import Problem

# If the level of the target is free, levels at these fractions of the feasible range are tried: of its
# logarithm for a power law, of the range itself for straight branches.
LEVEL_FRACTIONS = (0.5, 0.25, 0.75, 0.1, 0.9)


class Target:
    """Base class of target friction laws, in rescaled loads P/E* and frictions F/(sigma B) [mm^2]."""

    # whether the law must pass through all points, to rounding
    exact: ClassVar[bool] = False

    wording: Wording

    def _set(self, wording: Wording, **members: Any) -> None:
        """Set the attributes of a frozen target."""
        check.instance("wording", wording, Wording, "a Wording, as from_friction_coefficient sets it")
        for name, value in {**members, "wording": wording}.items():
            object.__setattr__(self, name, value)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        raise NotImplementedError

    @property
    def last_load(self) -> float | None:
        """Last rescaled load of the target [mm^2]; None if the inversion determines it."""
        raise NotImplementedError

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope [-] of each line, and the load [mm^2] at which it starts; the first line starts at 0."""
        return ()

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope [-] and range of rescaled loads [mm^2] of each straight branch."""
        return ()

    @property
    def marked_loads(self) -> dict[str, tuple[tuple[float, ...], ...]]:
        """Crossovers and load ranges of the target by name, as single loads or pairs of loads [mm^2]."""
        return {}

    def curve(self) -> TargetLaw:
        """Return the target law at the loads at which it is compared with the law of a design."""
        raise NotImplementedError

    @property
    def law(self) -> tuple[FloatArray, FloatArray] | None:
        """Rescaled loads and frictions, both (k,) [mm^2]; None if the target does not fix them completely."""
        try:
            law = self.curve()
        except InvalidInput:  # the law is that of a height density
            return None
        return None if law.is_open else (law.load, law.base)

    def guesses(self, law: TargetLaw, bounds: Bounds, fractions: tuple[float, ...]) -> list[FloatArray]:
        """Return frictions for initial guesses at the loads of `law`, each (k,) [mm^2].

        If the level of the target is free, there is one guess at each fraction of the feasible range.
        """
        return [law.base]

    def open_parameters(self, law: TargetLaw, area: FloatArray) -> dict[str, Parameter]:
        """Return the free parameters of the target, fitted to A0 (k,) at the loads of `law`."""
        return {}

    def refuse(self, problem: Problem, margin: float) -> None:
        """Raise Infeasible if the target violates a proven bound by more than a relative margin."""

    def candidate(self, problem: Problem, rng: np.random.Generator, restarts: int | None = None) -> Candidate:
        """Return the heights and radii of independent asperities whose law is nearest to the target.

        Targets with a different strategy override this method, and raise Infeasible if the strategy fails.
        """
        law = self.curve()
        sought = law.thinned(problem.effort.searched_loads)
        guesses = self.guesses(sought, problem.bounds, LEVEL_FRACTIONS)
        most = problem.restarts if restarts is None else restarts
        height, radius = LawSearch(problem, sought, guesses, most, rng).nearest(problem.radii)
        return self.of_heights(problem, law, problem.limits.top + height, radius)

    def of_heights(
        self,
        problem: Problem,
        law: TargetLaw,
        height: FloatArray,
        radius: FloatArray,
        cap: Cap | None = None,
    ) -> Candidate:
        """Return the candidate with heights, radii [mm] and caps for the curve `law` of the target."""
        parameters: dict[str, Parameter] = {"span": float(np.ptp(height))}
        branches = tuple(
            # if the law has no free parameter, each branch has a fixed intercept
            Branch(
                slope,
                ends,
                None if law.is_open else float(np.interp(ends[0], law.load, law.base)) - slope * ends[0],
            )
            for slope, ends in self.branches
        )
        candidate = Candidate(height, radius, parameters, law, branches, cap=cap)
        if law.is_open:
            curve = problem.uncoupled.curve(candidate.surface(problem.template), law.load)
            parameters |= self.open_parameters(law, curve.area)
        return candidate

    def judged(self, problem: Problem, candidate: Candidate) -> Candidate:
        """Return the refined candidate with notes on the target, or raise Infeasible."""
        return candidate
