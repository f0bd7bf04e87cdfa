"""Targets with straight branches, defined by slopes or friction coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.inversion.laws import Target
from metafem.inversion.target_law import TargetLaw
from metafem.inversion.wording import RESCALED, LoadRange, Wording
from metafem.surface import Friction, Material

# Number of loads at which a line is compared with the law of a design. Its misfit is the largest difference.
# With thirty loads, new contacts form between them and change the law there. With this number, the misfit is
# within a tenth of the largest difference at any load (measured).
LINE_POINTS = 100

# Total number of loads at which branches with free intercepts are compared with the law of a design, and
# minimum number for one branch.
POINTS, FEWEST_POINTS = 30, 4


class StraightLaw(Target):
    """A law with the slopes of `lines` at large loads, or the `lines` themselves over a range of loads."""

    load_range: LoadRange | None

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope [-] and load range [mm^2] of each line; empty without a load range."""
        if self.load_range is None:
            return ()
        low, high = self.load_range
        ends = [low, *(start for _, start in self.lines[1:]), high]
        return tuple((slope, part) for (slope, _), part in zip(self.lines, pairwise(ends), strict=True))

    @property
    def marked_loads(self) -> dict[str, tuple[tuple[float, ...], ...]]:
        """Crossovers and load range by name [mm^2]."""
        crossovers = tuple((start,) for _, start in self.lines[1:])
        ends = () if self.load_range is None else (self.load_range,)
        found = {"crossover": crossovers, "load range": ends}
        return {name: loads for name, loads in found.items() if loads}

    def line(self, rescaled_load: FloatArray) -> FloatArray:
        """Return the friction of the lines at rescaled loads, (k,) [mm^2]."""
        starts = [*(start for _, start in self.lines), np.inf]
        parts = (np.clip(rescaled_load, low, high) - low for low, high in pairwise(starts))
        return np.asarray(sum(slope * part for (slope, _), part in zip(self.lines, parts, strict=True)))

    def near(self, load: FloatArray, friction: FloatArray) -> Target | None:
        """Return None: a law that is not straight is no target of this kind."""
        return None

    def curve(self) -> TargetLaw | None:
        """Return the lines over the load range; None without a range, when the target defines only slopes."""
        if self.load_range is None:
            return None
        each = LINE_POINTS // len(self.branches)
        load = np.unique(np.concatenate([np.geomspace(*ends, each) for _, ends in self.branches]))
        return TargetLaw.of(load, self.line(load), pointwise=True)


@dataclass(frozen=True, init=False)
class LinearLaw(StraightLaw):
    """A straight law with one slope: with a free intercept, or through the origin over a range of loads.

    Parameters
    ----------
    slope : float
        m, slope of rescaled friction over rescaled load [-], positive; ``mu = sigma B / E* m``.
    load_range : (float, float), optional
        Smallest and largest P/E* [mm^2], positive and increasing. Over this range the target is the line
        ``F = m P`` through the origin, to be met within 1 %. Default: None; the heights then follow the
        exponential density whose law has this slope at large loads and its own intercept.

    Examples
    --------
    >>> law = LinearLaw.from_friction_coefficient(1.5, Material(1.36), Friction(0.358, 0.85))
    >>> round(law.slope, 3), law.friction_coefficient
    (6.704, 1.5)
    >>> LinearLaw(7.0, load_range=(0.05, 0.2)).title
    'Friction proportional to load: slope 7 from 0.05 to 0.2 mm²'
    """

    slope: float
    load_range: LoadRange | None = None
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        slope: float,
        load_range: ArrayLike | None = None,
        wording: Wording = RESCALED,
    ) -> None:
        slope = check.number("slope", slope, above=0.0)
        self._set(wording, slope=slope, load_range=_optional_range(load_range))

    @classmethod
    def from_friction_coefficient(
        cls,
        friction_coefficient: float,
        material: Material,
        friction: Friction,
        load_range_N: ArrayLike | None = None,
    ) -> LinearLaw:
        """Return the target with a friction coefficient mu [-] of a material pair, ``m = mu E* / (sigma B)``.

        With a range of loads P [N], the target is ``F = mu P`` over this range. Titles and messages state
        friction coefficients and loads in N.
        """
        wording = Wording.of(material, friction)
        mu = check.number("friction_coefficient", friction_coefficient, above=0.0)
        return cls(wording.slope(mu), wording.range_from_newtons(load_range_N), wording)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> LinearLaw:
        """Return the target with the slope of the line fitted to points P_i, F_i, (k >= 2,) [N]."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force, "a slope", 2)
        return cls(float(np.polyfit(x, y, 1)[0]), wording=wording)

    @property
    def friction_coefficient(self) -> float | None:
        """Friction coefficient mu [-]; None unless the law was defined by it or by forces."""
        return None if self.wording.per_slope is None else self.wording.coefficient(self.slope)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        words = self.wording.slopes(self.slope)
        if self.load_range is None:
            return f"Linear friction law of {words}"
        loads = self.wording.title_loads(*self.load_range)
        return f"Friction proportional to load: {words} from {loads}"

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope [-] of the line through the origin, and the load 0 at which it starts."""
        return ((self.slope, 0.0),)


@dataclass(frozen=True, init=False)
class BilinearLaw(StraightLaw):
    """Two straight branches that meet at a crossover load.

    Parameters
    ----------
    slopes : (float, float)
        Slopes m_1 below and m_2 above the crossover [-], positive.
    crossover_load : float
        P_c/E* [mm^2], positive.
    load_range : (float, float), optional
        Smallest and largest P/E* [mm^2], increasing, with the crossover between them. Over this range the
        target is ``F = m_1 P`` below and ``F = m_1 P_c + m_2 (P - P_c)`` above the crossover, to be met
        within 1 %. Default: None; the heights then follow a density of two exponential branches whose law has
        these slopes at large loads.

    Examples
    --------
    >>> BilinearLaw((7.15, 12.52), 0.0380).slopes
    (7.15, 12.52)
    >>> BilinearLaw((6.0, 9.0), 0.08, load_range=(0.04, 0.2)).line(np.array([0.04, 0.1])).round(3)
    array([0.24, 0.66])
    """

    slopes: tuple[float, float]
    crossover_load: float
    load_range: LoadRange | None = None
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        slopes: ArrayLike,
        crossover_load: float,
        load_range: ArrayLike | None = None,
        wording: Wording = RESCALED,
    ) -> None:
        values = check.array("slopes", slopes, shape=(2,))
        pair = tuple(check.number(f"slopes[{i}]", value, above=0.0) for i, value in enumerate(values))
        load = check.number("crossover_load", crossover_load, above=0.0)
        ends = _optional_range(load_range)
        self._set(wording, slopes=pair, crossover_load=load, load_range=ends)
        refuse_if(
            ends is not None and not ends[0] < load < ends[1],
            f"must lie inside load_range, from {wording.loads(*(ends or ()))}",
            key="crossover_load",
            value=wording.loads(load),
        )

    @classmethod
    def from_friction_coefficients(
        cls,
        friction_coefficients: ArrayLike,
        crossover_load_N: float,
        material: Material,
        friction: Friction,
        load_range_N: ArrayLike | None = None,
    ) -> BilinearLaw:
        """Return the target with friction coefficients dF/dP [-] below and above the crossover.

        They are those of a material pair. The crossover load and the range are loads P [N], not P/E* [mm^2].
        Titles and messages state friction coefficients and loads in N.
        """
        wording = Wording.of(material, friction)
        slopes = wording.given_slopes(friction_coefficients, 2)
        crossover = check.number("crossover_load_N", crossover_load_N, above=0.0)
        ends = wording.range_from_newtons(load_range_N)
        return cls(slopes, wording.from_newtons(crossover), ends, wording)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> BilinearLaw:
        """Return the target for three points P_i, F_i, (3,) [N]; the second point is the crossover."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force)
        words = f"holds {len(x)} values; two branches need exactly 3 points"
        refuse_if(len(x) != 3, words, key="load")
        return cls(np.diff(y) / np.diff(x), float(x[1]), wording=wording)

    @property
    def friction_coefficients(self) -> tuple[float, ...] | None:
        """Friction coefficients dF/dP [-]; None unless the law was defined by them or by forces."""
        return self.wording.coefficients(self.slopes)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        words = f"Bilinear friction law of {self.wording.slopes(*self.slopes)}"
        if self.load_range is None:
            return words
        loads = self.wording.title_loads(*self.load_range)
        return f"{words} through the origin from {loads}"

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope [-] of each line, and the load [mm^2] at which it starts."""
        return (self.slopes[0], 0.0), (self.slopes[1], self.crossover_load)


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

    free_name: ClassVar[str] = "intercepts"

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
        return TargetLaw.of(np.concatenate(loads), np.concatenate(base), free=free)


def _optional_range(load_range: ArrayLike | None) -> LoadRange | None:
    return None if load_range is None else check.interval("load_range", load_range)


def _crossover(name: str, given: object) -> LoadRange:
    """Return the two checked loads of a crossover; a single load is returned twice."""
    if check.scalar(given):
        load = check.number(name, given, above=0.0)
        return load, load
    several = isinstance(given, (list, tuple, np.ndarray)) and all(check.scalar(end) for end in given)
    refuse_if(not several, "must be a load or a pair of loads", key=name, value=f"{given!r:.60}")
    low, high = check.array(name, given, shape=(2,)).tolist()
    return (low, high) if low == high > 0.0 else check.interval(name, given)
