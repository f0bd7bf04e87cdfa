"""Targets with straight branches, defined by slopes or friction coefficients."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.inversion.target_law import Target, TargetLaw
from metafem.inversion.wording import LoadRange, Wording
from metafem.surface import Friction, Material

# Number of loads at which a line is compared with the law of a design. Its misfit is the largest difference.
# With thirty loads, new contacts form between them and change the law there. With this number, the misfit is
# within a tenth of the largest difference at any load (measured).
LINE_POINTS = 100

# Total number of loads at which branches with free intercepts are compared with the law of a design, and
# minimum number for one branch.
POINTS, FEWEST_POINTS = 30, 4


class StraightLaw(Target):
    """A law of consecutive straight branches, each from one corner of the law to the next."""

    fewest: ClassVar[int] = 2

    load_range: LoadRange | None

    @property
    def _slopes(self) -> tuple[float, ...]:
        """Slope of each branch [-]."""
        target: Any = self
        return tuple(target.slopes)

    @property
    def _corners(self) -> tuple[LoadRange, ...]:
        """End of each branch but the last, and start of the next [mm^2]; between them the law is free."""
        return ()

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope [-] of each line and the load [mm^2] at which it starts; empty if intercepts are free."""
        return () if self.free_name else tuple(zip(self._slopes, self._starts, strict=True))

    @property
    def _starts(self) -> list[float]:
        """Load at which each branch starts [mm^2], the first at 0."""
        return [0.0, *(start for _, start in self._corners)]

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope [-] and load range [mm^2] of each branch; empty without a load range."""
        if self.load_range is None:
            return ()
        low, high = self.load_range
        path = iter([low, *(load for pair in self._corners for load in pair), high])
        return tuple(zip(self._slopes, zip(path, path, strict=True), strict=True))

    def line(self, rescaled_load: FloatArray) -> FloatArray:
        """Return the friction of the lines through the origin at rescaled loads, (k,) [mm^2]."""
        ends = pairwise([*self._starts, np.inf])
        parts = (np.clip(rescaled_load, low, high) - low for low, high in ends)
        return np.asarray(sum(slope * part for slope, part in zip(self._slopes, parts, strict=True)))

    def curve(self) -> TargetLaw | None:
        """Return the lines over the load range; None without a range, when the target defines only slopes."""
        if self.load_range is None:
            return None
        each = LINE_POINTS // len(self.branches)
        load = np.unique(np.concatenate([np.geomspace(*ends, each) for _, ends in self.branches]))
        return TargetLaw.of(load, self.line(load), pointwise=True)


@dataclass(frozen=True, eq=False, repr=False)
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
    >>> round(law.slope, 3)
    6.704
    >>> LinearLaw(7.0, load_range=(0.05, 0.2)).title
    'Friction proportional to load: slope 7 from 0.05 to 0.2 mm²'
    """

    slope: float
    load_range: LoadRange | None = None

    def _checked(self) -> dict[str, Any]:
        slope = check.number("slope", self.slope, above=0.0)
        return {"slope": slope, "load_range": _optional_range(self.load_range)}

    @classmethod
    def from_friction_coefficient(
        cls,
        friction_coefficient: float,
        material: Material,
        friction: Friction,
        load_range_N: ArrayLike | None = None,
    ) -> Self:
        """Return the target with a friction coefficient mu [-] of a material pair, ``m = mu E* / (sigma B)``.

        With a range of loads P [N], the target is ``F = mu P`` over this range. Titles and messages state
        friction coefficients and loads in N.
        """
        wording = Wording.of(material, friction)
        mu = check.number("friction_coefficient", friction_coefficient, above=0.0)
        ends = None
        if load_range_N is not None:
            low, high = check.interval("load_range_N", load_range_N)
            ends = low / material.composite_modulus, high / material.composite_modulus
        return cls(wording.given_slopes([mu], 1)[0], ends, wording=wording)

    @classmethod
    def _through(cls, load: FloatArray, friction: FloatArray) -> tuple[Any, ...]:
        return (float(np.polyfit(load, friction, 1)[0]),)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        words = self.wording.slopes(self.slope)
        if self.load_range is None:
            return f"Linear friction law of {words}"
        loads = self.wording.title_loads(*self.load_range)
        return f"Friction proportional to load: {words} from {loads}"

    @property
    def _slopes(self) -> tuple[float, ...]:
        return (self.slope,)


@dataclass(frozen=True, eq=False, repr=False)
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

    def _checked(self) -> dict[str, Any]:
        slopes = check.array("slopes", self.slopes, shape=(2,), positive=True)
        load = check.number("crossover_load", self.crossover_load, above=0.0)
        low, high = ends = _optional_range(self.load_range) or (0.0, np.inf)
        words = f"must lie inside load_range, from {self.wording.loads(*ends)}"
        given = self.wording.loads(load)
        refuse_if(not low < load < high, words, key="crossover_load", value=given)
        found = None if self.load_range is None else ends
        return {"slopes": tuple(slopes.tolist()), "crossover_load": load, "load_range": found}

    @classmethod
    def _through(cls, load: FloatArray, friction: FloatArray) -> tuple[Any, ...]:
        check.array("load", load, shape=(3,))  # the second point is the crossover
        return (np.diff(friction) / np.diff(load)).tolist(), float(load[1])

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        words = f"Bilinear friction law of {self.wording.slopes(*self.slopes)}"
        if self.load_range is None:
            return words
        return f"{words} through the origin from {self.wording.title_loads(*self.load_range)}"

    @property
    def _corners(self) -> tuple[LoadRange, ...]:
        return ((self.crossover_load, self.crossover_load),)


@dataclass(frozen=True, eq=False, repr=False)
class MultilinearLaw(StraightLaw):
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

    slopes: Any
    crossover_loads: Any
    load_range: LoadRange

    def _checked(self) -> dict[str, Any]:
        slopes = check.array("slopes", self.slopes, shape=(None,), positive=True)
        pairs = _crossovers(self.crossover_loads)
        words = f"must hold {len(slopes) - 1} loads or pairs of loads for {len(slopes)} branches"
        given = f"{self.crossover_loads!r:.60}"
        refuse_if(len(pairs) != len(slopes) - 1, words, key="crossover_loads", value=given)
        low, high = check.interval("load_range", self.load_range)
        path = [low, *(load for pair in pairs for load in pair), high]
        for i, (start, end) in enumerate(zip(path[::2], path[1::2], strict=True), start=1):
            words = f"branch {i} would run from {self.wording.loads(start, end)}"
            refuse_if(not start < end, f"must increase within load_range: {words}", key="crossover_loads")
        return {"slopes": tuple(slopes.tolist()), "crossover_loads": pairs, "load_range": (low, high)}

    @classmethod
    def _through(cls, load: FloatArray, friction: FloatArray) -> tuple[Any, ...]:
        return np.diff(friction) / np.diff(load), load[1:-1].tolist(), (load[0], load[-1])

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        return f"Friction law of {self.wording.slopes(*self.slopes)}"

    @property
    def _corners(self) -> tuple[LoadRange, ...]:
        return tuple(self.crossover_loads)

    def curve(self) -> TargetLaw:
        """Return the branches as a target law with a free intercept for each group of connected branches."""
        each = max(FEWEST_POINTS, POINTS // len(self.slopes))
        load = np.unique(np.concatenate([np.linspace(*ends, each) for _, ends in self.branches]))
        gaps = np.array([end for end, start in self.crossover_loads if end < start])
        group = (load[:, None] > gaps).sum(axis=1)
        return TargetLaw.of(load, self.line(load), free=np.eye(len(gaps) + 1)[group])


def _optional_range(load_range: ArrayLike | None) -> LoadRange | None:
    """Return a checked range of rescaled loads [mm^2], or None."""
    return None if load_range is None else check.interval("load_range", load_range)


def _crossovers(given: Any) -> tuple[LoadRange, ...]:
    """Return the two checked loads of each crossover; a single load is returned twice."""
    pairs = list[LoadRange]()
    for i, each in enumerate(given if isinstance(given, (list, tuple, np.ndarray)) else ()):
        name = f"crossover_loads[{i}]"
        if check.scalar(each):
            pairs.append((check.number(name, each, above=0.0),) * 2)
        else:
            low, high = check.array(name, each, shape=(2,), positive=True).tolist()
            pairs.append((low, high) if low == high else check.interval(name, each))
    return tuple(pairs)
