"""Targets of straight branches, given by slopes or friction coefficients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_class
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.inversion.targets.wording import RESCALED, Wording, in_title
from metafem.surface import Friction, Material

__all__ = ["BilinearLaw", "LinearLaw", "MultilinearLaw"]

LoadRange = tuple[float, float]


@checked_class
@dataclass(frozen=True, init=False)
class LinearLaw:
    """A straight law of one slope: with a free intercept, or through the origin over a range of loads.

    Parameters
    ----------
    slope : float
        m, slope of rescaled friction over rescaled load [-], positive; ``mu = sigma B / E* m``.
    load_range : (float, float), optional
        P/E* [mm^2], positive and increasing, over which the target is the line ``F = m P`` through the
        origin, within 1 %. Default: none; the heights are then those of the exponential density whose law
        has the slope at large loads, with its own intercept.

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
        self, slope: float, load_range: ArrayLike | None = None, wording: Wording = RESCALED
    ) -> None:
        object.__setattr__(self, "slope", check.number("slope", slope, above=0.0))
        ends = None if load_range is None else check.interval("load_range", load_range)
        object.__setattr__(self, "load_range", ends)
        object.__setattr__(self, "wording", Wording.checked(wording))

    @classmethod
    def from_friction_coefficient(
        cls,
        friction_coefficient: float,
        material: Material,
        friction: Friction,
        load_range: ArrayLike | None = None,
    ) -> LinearLaw:
        """Law of a friction coefficient mu [-] of a material pair, ``m = mu E* / (sigma B)``.

        With a `load_range`, ``F = mu P`` over it. Titles and messages state friction coefficients and
        newtons.
        """
        wording = Wording.of(material, friction)
        mu = check.number("friction_coefficient", friction_coefficient, above=0.0)
        return cls(wording.slope(mu), load_range, wording)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> LinearLaw:
        """Law with the least-squares slope through points P_i, F_i, (k >= 2,) [N]."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force)
        if len(x) < 2:
            raise InvalidInput(f"load holds {len(x)} value; a slope needs at least 2 points")
        return cls(float(np.polyfit(x, y, 1)[0]), wording=wording)

    @property
    def friction_coefficient(self) -> float | None:
        """Friction coefficient mu [-] of a law that was given by it or by forces; otherwise None."""
        return None if self.wording.per_slope is None else self.wording.coefficient(self.slope)

    @property
    def title(self) -> str:
        """What is asked for, in one line."""
        words = self.wording.slopes(self.slope)
        if self.load_range is None:
            return f"Linear friction law of {words}"
        return f"Friction proportional to load: {words} from {in_title(self.wording.loads(*self.load_range))}"

    @property
    def last_load(self) -> float | None:
        """Last rescaled load asked for [mm^2]; None where the inversion decides it."""
        return None if self.load_range is None else self.load_range[1]

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope of the line through the origin, and the load 0 from which it holds."""
        return ((self.slope, 0.0),)

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope and load range of the line; none without a load range."""
        return () if self.load_range is None else ((self.slope, self.load_range),)

    def line(self, rescaled_load: FloatArray) -> FloatArray:
        """Return the friction of the line at rescaled loads, (k,) [mm^2]."""
        return np.asarray(self.slope * rescaled_load)


@checked_class
@dataclass(frozen=True, init=False)
class BilinearLaw:
    """Two straight branches that meet at a crossover load.

    Parameters
    ----------
    slopes : (float, float)
        m_1 below and m_2 above the crossover [-], positive.
    crossover_load : float
        P_c/E* [mm^2], positive.
    load_range : (float, float), optional
        P/E* [mm^2], increasing, with the crossover inside, over which the target is ``F = m_1 P`` below
        and ``m_1 P_c + m_2 (P - P_c)`` above the crossover, within 1 %. Default: none; the heights are
        then those of a density of two exponentials whose law has these slopes at large loads.

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
        object.__setattr__(self, "slopes", pair)
        load = check.number("crossover_load", crossover_load, above=0.0)
        object.__setattr__(self, "crossover_load", load)
        ends = None if load_range is None else check.interval("load_range", load_range)
        object.__setattr__(self, "wording", Wording.checked(wording))
        if ends is not None and not ends[0] < load < ends[1]:
            raise InvalidInput(
                f"crossover_load = {wording.loads(load)} must lie inside load_range, from "
                f"{wording.loads(*ends)}"
            )
        object.__setattr__(self, "load_range", ends)

    @classmethod
    def from_friction_coefficients(
        cls,
        friction_coefficients: ArrayLike,
        crossover_load: float,
        material: Material,
        friction: Friction,
        load_range: ArrayLike | None = None,
    ) -> BilinearLaw:
        """Law of two friction coefficients dF/dP [-] of a material pair, below and above the crossover.

        Titles and messages state friction coefficients and newtons.
        """
        wording = Wording.of(material, friction)
        slopes = _slopes(check.array("friction_coefficients", friction_coefficients, shape=(2,)), wording)
        return cls(slopes, crossover_load, load_range, wording)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> BilinearLaw:
        """Law through points P_i, F_i, (3,) [N]: on the first branch, at the crossover, on the second."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force)
        if len(x) != 3:
            raise InvalidInput(f"load holds {len(x)} values; two branches need exactly 3 points")
        return cls(np.diff(y) / np.diff(x), float(x[1]), wording=wording)

    @property
    def friction_coefficients(self) -> tuple[float, ...] | None:
        """Friction coefficients dF/dP [-] of a law that was asked for by them, or by forces; else None."""
        return _coefficients(self.slopes, self.wording)

    @property
    def title(self) -> str:
        """What is asked for, in one line."""
        words = f"Bilinear friction law of {self.wording.slopes(*self.slopes)}"
        if self.load_range is None:
            return words
        return f"{words} through the origin from {in_title(self.wording.loads(*self.load_range))}"

    @property
    def last_load(self) -> float | None:
        """Last rescaled load asked for [mm^2]; None where the inversion decides it."""
        return None if self.load_range is None else self.load_range[1]

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope of each line, and the load from which it holds [mm^2]."""
        return (self.slopes[0], 0.0), (self.slopes[1], self.crossover_load)

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope and load range of each line; none without a load range."""
        if self.load_range is None:
            return ()
        (first, second), (low, high) = self.slopes, self.load_range
        return (first, (low, self.crossover_load)), (second, (self.crossover_load, high))

    def line(self, rescaled_load: FloatArray) -> FloatArray:
        """Return the friction of the lines at rescaled loads, (k,) [mm^2]."""
        below = np.minimum(rescaled_load, self.crossover_load)
        return np.asarray(self.slopes[0] * below + self.slopes[1] * (rescaled_load - below))


@checked_class
@dataclass(frozen=True, init=False)
class MultilinearLaw:
    """Consecutive straight branches of given slopes, with a free intercept.

    Parameters
    ----------
    slopes : array_like, (b,)
        Slopes of the branches [-], positive, in any order.
    crossover_loads : sequence, (b - 1,)
        Crossover from each branch to the next [mm^2], increasing: one load P/E* at which they meet, or a
        pair (end of the branch, start of the next). Between the loads of a pair the law is free, and so is
        the intercept of the next branch.
    load_range : (float, float)
        P/E* from the start of the first to the end of the last branch [mm^2].

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
        if values.min() <= 0.0:
            raise InvalidInput(f"slopes holds {values.min():g}; all must be greater than 0")
        listed = isinstance(crossover_loads, (list, tuple, np.ndarray))
        if not listed or len(crossover_loads) != len(values) - 1:
            raise InvalidInput(
                f"crossover_loads = {crossover_loads!r:.60} must hold {len(values) - 1} loads or pairs of "
                f"loads for {len(values)} {wording.keys[1]}"
            )
        ends = check.interval("load_range", load_range)
        pairs = tuple(_crossover(i, given) for i, given in enumerate(crossover_loads))
        object.__setattr__(self, "wording", Wording.checked(wording))
        path = [ends[0], *(load for pair in pairs for load in pair), ends[1]]
        for i in range(0, len(path), 2):
            if not path[i] < path[i + 1]:
                raise InvalidInput(
                    f"branch {i // 2 + 1} would run from {wording.loads(path[i], path[i + 1])}; "
                    "crossover_loads must increase within load_range"
                )
        object.__setattr__(self, "slopes", tuple(values.tolist()))
        object.__setattr__(self, "crossover_loads", pairs)
        object.__setattr__(self, "load_range", ends)

    @classmethod
    def from_friction_coefficients(
        cls,
        friction_coefficients: ArrayLike,
        crossover_loads: Sequence[object],
        load_range: ArrayLike,
        material: Material,
        friction: Friction,
    ) -> MultilinearLaw:
        """Law of friction coefficients dF/dP [-] of a material pair, one for each branch.

        Titles and messages state friction coefficients and newtons.
        """
        wording = Wording.of(material, friction)
        slopes = _slopes(check.array("friction_coefficients", friction_coefficients, shape=(None,)), wording)
        return cls(slopes, crossover_loads, load_range, wording)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> MultilinearLaw:
        """Law of the slopes of the straight lines between points P, F, (b + 1,) [N]."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force)
        if len(x) < 2:
            raise InvalidInput(f"load holds {len(x)} value; a branch needs 2 points")
        return cls(np.diff(y) / np.diff(x), x[1:-1].tolist(), (float(x[0]), float(x[-1])), wording)

    @property
    def friction_coefficients(self) -> tuple[float, ...] | None:
        """Friction coefficients dF/dP [-] of a law that was asked for by them, or by forces; else None."""
        return _coefficients(self.slopes, self.wording)

    @property
    def title(self) -> str:
        """What is asked for, in one line."""
        return f"Friction law of {self.wording.slopes(*self.slopes)}"

    @property
    def last_load(self) -> float:
        """Last rescaled load asked for [mm^2]."""
        return self.load_range[1]

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope and load range of each branch."""
        path = [
            self.load_range[0],
            *(load for pair in self.crossover_loads for load in pair),
            self.load_range[1],
        ]
        return tuple((m, (path[2 * i], path[2 * i + 1])) for i, m in enumerate(self.slopes))


def _coefficients(slopes: tuple[float, ...], wording: Wording) -> tuple[float, ...] | None:
    return None if wording.per_slope is None else tuple(wording.coefficient(slope) for slope in slopes)


def _slopes(coefficients: FloatArray, wording: Wording) -> list[float]:
    """Return the slopes of friction coefficients."""
    return [
        wording.slope(check.number(f"friction_coefficients[{i}]", mu, above=0.0))
        for i, mu in enumerate(coefficients.tolist())
    ]


def _crossover(i: int, given: object) -> LoadRange:
    name = f"crossover_loads[{i}]"
    if check.scalar(given):
        load = check.number(name, given, above=0.0)
        return load, load
    if not isinstance(given, (list, tuple, np.ndarray)) or not all(check.scalar(end) for end in given):
        raise InvalidInput(f"{name} = {given!r:.60} must be a load or a pair of loads")
    low, high = check.array(name, given, shape=(2,)).tolist()
    return (low, high) if low == high > 0.0 else check.interval(name, given)
