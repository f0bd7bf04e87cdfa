"""Target law with several straight branches and free intercepts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import Infeasible, refuse_if
from metafem.inversion.bounds import ROUNDING
from metafem.inversion.feasibility import margin_words, refuse_load
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.targets.target import Target
from metafem.inversion.targets.wording import RESCALED, LoadRange, Wording
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from metafem.inversion.bounds import Bounds
    from metafem.inversion.candidate import Parameter
    from metafem.inversion.problem import Problem

# Total number of loads at which the branches are compared with the law of a design, and minimum number for
# one branch.
POINTS, FEWEST_POINTS = 30, 4


@dataclass(frozen=True, init=False)
class MultilinearLaw(Target):
    """Consecutive straight branches with prescribed slopes and a free intercept.

    Parameters
    ----------
    slopes : array_like, (b,)
        Slopes of the branches [-], positive, in any order.
    crossover_loads : sequence, (b - 1,)
        Crossovers between consecutive branches [mm^2], increasing. Each crossover is a load P/E* at which
        two branches meet, or a pair of loads: the end of one branch and the start of the next. Between the
        loads of a pair the law is free, and the next branch has its own free intercept.
    load_range : (float, float)
        Start of the first and end of the last branch, P/E* [mm^2].

    Examples
    --------
    >>> law = MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
    >>> law.branches
    ((9.5, (0.03, 0.07)), (7.0, (0.18, 0.26)))
    """

    slopes: tuple[float, ...]
    crossover_loads: tuple[LoadRange, ...]
    load_range: LoadRange
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        slopes: ArrayLike,
        crossover_loads: Sequence[object],
        load_range: ArrayLike,
        wording: Wording = RESCALED,
    ) -> None:
        values = check.array("slopes", slopes, shape=(None,))
        least = values.min()
        refuse_if(least <= 0.0, f"holds {least:g}; all must be greater than 0", key="slopes")
        listed = isinstance(crossover_loads, (list, tuple, np.ndarray))
        refuse_if(
            not listed or len(crossover_loads) != len(values) - 1,
            f"must hold {len(values) - 1} loads or pairs of loads for {len(values)} {wording.keys[1]}",
            key="crossover_loads",
            value=f"{crossover_loads!r:.60}",
        )
        ends = check.interval("load_range", load_range)
        pairs = tuple(_crossover(f"crossover_loads[{i}]", given) for i, given in enumerate(crossover_loads))
        self._set(wording, slopes=tuple(values.tolist()), crossover_loads=pairs, load_range=ends)
        for i, (_, (start, end)) in enumerate(self.branches, start=1):
            words = f"branch {i} would run from {wording.loads(start, end)}"
            refuse_if(not start < end, f"must increase within load_range: {words}", key="crossover_loads")

    @classmethod
    def from_friction_coefficients(
        cls,
        friction_coefficients: ArrayLike,
        crossover_loads_N: Sequence[object],
        load_range_N: ArrayLike,
        material: Material,
        friction: Friction,
    ) -> MultilinearLaw:
        """Return the target whose branches have friction coefficients dF/dP [-] of a material pair.

        The crossovers and the range are loads P [N], not P/E* [mm^2]. Titles and messages state friction
        coefficients and loads in N.
        """
        wording = Wording.of(material, friction)
        slopes = wording.given_slopes(friction_coefficients, None)
        pairs = (_crossover(f"crossover_loads_N[{i}]", given) for i, given in enumerate(crossover_loads_N))
        crossovers = [tuple(map(wording.from_newtons, pair)) for pair in pairs]
        return cls(slopes, crossovers, wording.range_from_newtons(load_range_N) or (), wording)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> MultilinearLaw:
        """Return the target with the slopes of the straight lines between points P, F, (b + 1,) [N]."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force, "a branch", 2)
        return cls(np.diff(y) / np.diff(x), x[1:-1].tolist(), (float(x[0]), float(x[-1])), wording)

    @property
    def friction_coefficients(self) -> tuple[float, ...] | None:
        """Friction coefficients dF/dP [-]; None unless the law was defined by them or by forces."""
        return self.wording.coefficients(self.slopes)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        return f"Friction law of {self.wording.slopes(*self.slopes)}"

    @property
    def last_load(self) -> float:
        """Last rescaled load of the target [mm^2]."""
        return self.load_range[1]

    @property
    def marked_loads(self) -> dict[str, tuple[tuple[float, ...], ...]]:
        """Crossovers and load range by name [mm^2]."""
        crossovers = tuple((low,) if low == high else (low, high) for low, high in self.crossover_loads)
        found = {"crossover": crossovers, "load range": (self.load_range,)}
        return {name: loads for name, loads in found.items() if loads}

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope [-] and load range [mm^2] of each branch."""
        ends = [load for pair in self.crossover_loads for load in pair]
        path = iter([self.load_range[0], *ends, self.load_range[1]])
        return tuple(zip(self.slopes, zip(path, path, strict=True), strict=True))

    def _is_connected(self, i: int) -> bool:
        """Return whether branch i begins at the load at which the previous branch ends."""
        return i > 0 and self.branches[i][1][0] == self.branches[i - 1][1][1]

    def curve(self) -> TargetLaw:
        """Return the branches as a target law with a free intercept for each group of connected branches."""
        each = max(FEWEST_POINTS, POINTS // len(self.slopes))
        loads: list[FloatArray] = []
        base: list[FloatArray] = []
        group: list[int] = []
        column, offset = 0, 0.0
        for i, (slope, (start, end)) in enumerate(self.branches):
            load = np.linspace(start, end, each)
            if self._is_connected(i):
                load = load[1:]
                offset += (self.slopes[i - 1] - slope) * start
            elif i:
                column, offset = column + 1, 0.0
            loads.append(load)
            base.append(offset + slope * load)
            group += [column] * len(load)
        free = np.eye(column + 1)[group]
        return TargetLaw(np.concatenate(loads), np.concatenate(base), free, np.ones(len(group)))

    def guesses(self, law: TargetLaw, bounds: Bounds, fractions: tuple[float, ...]) -> list[FloatArray]:
        """Return the branches with several intercepts, for which the first group lies within the bounds."""
        (low, high), found = bounds.region(law.load), []
        for fraction in fractions:
            guess = np.empty_like(law.load)
            for column in range(law.free.shape[1]):
                rows = np.flatnonzero(law.free[:, column])
                base, load = law.base[rows], law.load[rows]
                if column == 0:
                    least, most = float((low[rows] - base).max()), float((high[rows] - base).min())
                    level = least + fraction * (most - least)
                else:  # between two groups of branches, friction is assumed proportional to the load
                    last = rows[0] - 1
                    level = float(guess[last] * load[0] / law.load[last] - base[0])
                guess[rows] = base + level
            found.append(guess)
        return found

    def open_parameters(self, law: TargetLaw, area: FloatArray) -> dict[str, Parameter]:
        """Return the fitted intercepts, one for each group of connected branches [mm^2]."""
        return {"intercepts": law.open_parameters(area)}

    def refuse(self, problem: Problem, margin: float) -> None:
        """Raise Infeasible if connected branches exceed the bounds with every intercept."""
        bounds, wording = problem.bounds, self.wording
        refuse_load(self.load_range[1], problem, wording)
        slack = margin + ROUNDING
        offset, low, high = 0.0, -math.inf, math.inf
        for i, (slope, (start, end)) in enumerate(self.branches):
            if self._is_connected(i):
                offset += (self.slopes[i - 1] - slope) * start
            else:
                offset, low, high = 0.0, -math.inf, math.inf
            # F = c + offset + slope p is straight, and both bounds are concave functions of p. The lower
            # bound is therefore most restrictive at the ends or where its slope equals that of F, and the
            # upper bound at the ends
            load = np.array([start, end, min(max(bounds.tangent_load(slope), start), end)])
            least, most = bounds.friction(load)
            low = max(low, float((least * (1.0 - slack) - offset - slope * load).max()))
            high = min(high, float((most * (1.0 + slack) - offset - slope * load)[:2].min()))
            # F/p^b cannot decrease, so c + offset <= slope p (1/b - 1), most restrictive at the start
            if bounds.least_exponent > 0.0:
                high = min(high, slope * start * (1.0 / bounds.least_exponent - 1.0 + slack) - offset)
            if low > high:
                raise Infeasible(
                    f"branch {i + 1} of {wording.slopes(slope)} from {wording.loads(start, end)} leaves the "
                    f"range of {problem.count} asperities of {problem.tools} for every intercept"
                    f"{margin_words(margin)}"
                )


def _crossover(name: str, given: object) -> LoadRange:
    """Return the two checked loads of a crossover; a single load is returned twice."""
    if check.scalar(given):
        load = check.number(name, given, above=0.0)
        return load, load
    several = isinstance(given, (list, tuple, np.ndarray)) and all(check.scalar(end) for end in given)
    refuse_if(not several, "must be a load or a pair of loads", key=name, value=f"{given!r:.60}")
    low, high = check.array(name, given, shape=(2,)).tolist()
    return (low, high) if low == high > 0.0 else check.interval(name, given)
