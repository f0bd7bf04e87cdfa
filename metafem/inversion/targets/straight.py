"""Linear and bilinear targets, defined by slopes or friction coefficients."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies import exponential, proportional
from metafem.inversion.targets.target import Target
from metafem.inversion.targets.wording import RESCALED, LoadRange, Wording
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from metafem.inversion.candidate import Candidate
    from metafem.inversion.problem import Problem

# Number of loads at which a line is compared with the law of a design. Its misfit is the largest difference.
# With thirty loads, new contacts form between them and change the law there. With this number, the misfit is
# within a tenth of the largest difference at any load (measured).
LINE_POINTS = 100


class StraightLaw(Target):
    """A law with the slopes of `lines` at large loads, or the `lines` themselves over a range of loads."""

    load_range: LoadRange | None

    @property
    def last_load(self) -> float | None:
        """Last rescaled load of the target [mm^2]; None without a load range: the density determines it."""
        return None if self.load_range is None else self.load_range[1]

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

    def curve(self) -> TargetLaw:
        """Return the lines over the load range as a target law.

        Without a load range the target defines only slopes. The reference law is then the law of the height
        density, `Design.target_law`, which also depends on the template and the limits.
        """
        if self.load_range is None:
            raise InvalidInput(
                "the target has no load_range: its law is that of the height density, design.target_law"
            )
        each = LINE_POINTS // len(self.branches)
        load = np.unique(np.concatenate([np.geomspace(*ends, each) for _, ends in self.branches]))
        return TargetLaw.fixed(load, self.line(load), pointwise=True)

    def candidate(self, problem: Problem, rng: np.random.Generator, restarts: int | None = None) -> Candidate:
        """Return heights for the lines over the load range, or heights of a density if there is no range."""
        if self.load_range is None:
            return exponential.candidate(self, problem)
        return super().candidate(problem, rng, restarts)

    def refuse(self, problem: Problem, margin: float) -> None:
        """Raise Infeasible if the lines over the load range exceed a bound by more than a relative margin."""
        if self.load_range is not None:
            proportional.refuse_line(self, problem, margin)


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


def _optional_range(load_range: ArrayLike | None) -> LoadRange | None:
    return None if load_range is None else check.interval("load_range", load_range)
