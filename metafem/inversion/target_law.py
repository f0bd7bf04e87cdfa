"""What all targets have: a law or a band at a list of loads, possibly with free parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg.lapack import dgels

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.inversion.wording import RESCALED, LoadRange, Wording
from metafem.surface import Friction, Material

# Relative differences (k,) [-] from a law, and a function that returns their Jacobian (k, n) [1/mm]. The
# Jacobian takes longer to compute than the differences, and many steps do not need it.
LateResidual = tuple[FloatArray, Callable[[], FloatArray]]

# Number of iterations for the free parameters. The weights of each iteration are relative to the law of the
# previous iteration. After two iterations the weights have converged to within a digit of the residual.
ROUNDS = 3

# Part of the width of a band at which a search aims, so that its result lies inside by a margin.
INNER = 0.5

# Format of the numbers of a target that is designed: 11 digits, more than any is known to. A design then
# does not depend on the rounding errors by which a target was computed.
DIGITS = "%.10e"

# If the nearest law is not positive, it is raised to at least this fraction of the area curve, which makes
# the differences large.
FAR = 0.1


@dataclass(frozen=True, eq=False, repr=False)
class Target(Value):
    """Base class of target friction laws, in rescaled loads P/E* and frictions F/(sigma B) [mm^2].

    A target is data: `curve` returns the law with its loads, its bounds and its free parameters.
    """

    # whether the law must pass through all points, to rounding
    exact: ClassVar[bool] = False
    # whether a target that a search misses is refused, with the nearest law, or else stated as missed
    refused: ClassVar[bool] = False
    # name of the free parameters of the law; "" if there are none
    free_name: ClassVar[str] = ""
    # smallest number of points by which the law is defined, and whether their friction must increase
    fewest: ClassVar[int] = 1
    rising: ClassVar[bool] = True

    wording: Wording = field(default=RESCALED, kw_only=True, compare=False, repr=False)

    def __post_init__(self) -> None:
        check.instance("wording", self.wording, Wording, "a Wording, as from_friction_coefficient sets it")
        for name, value in self._checked().items():
            object.__setattr__(self, name, value)

    def _checked(self) -> dict[str, Any]:
        """Return the checked members."""
        raise NotImplementedError

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction, **rest: Any
    ) -> Self:
        """Return the target for loads P and friction forces F, both (k,) [N], of a material pair.

        A line, a power or consecutive branches are fitted to the points. `rest` are other arguments of the
        target, such as `weight` and `relative_error` of samples.
        """
        wording = Wording.of(material, friction)
        points = wording.rescaled(load, friction_force, cls.fewest, cls.rising)
        return cls(*cls._through(*points), **rest, wording=wording)

    @classmethod
    def _through(cls, load: FloatArray, friction: FloatArray) -> tuple[Any, ...]:
        """Return the arguments of the target through, or nearest to, points (k,) [mm^2]."""
        return load, friction

    def rounded(self) -> Self:
        """Return the target with 11 digits of each number."""
        members = {each.name: getattr(self, each.name) for each in fields(self) if each.name != "wording"}
        given: dict[str, Any] = {
            name: np.char.mod(DIGITS, value).astype(float)
            for name, value in members.items()
            if value is not None
        }
        return replace(self, **given)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        raise NotImplementedError

    @property
    def last_load(self) -> float | None:
        """Last rescaled load of the target [mm^2]; None if the height density determines it."""
        law = self.curve()
        return None if law is None else float(law.load[-1])

    @property
    def lines(self) -> tuple[tuple[float, float], ...]:
        """Slope [-] of each line and the load [mm^2] at which it starts; empty if intercepts are free."""
        return ()

    @property
    def branches(self) -> tuple[tuple[float, LoadRange], ...]:
        """Slope [-] and range of rescaled loads [mm^2] of each straight branch."""
        return ()

    def curve(self) -> TargetLaw | None:
        """Return the law at the loads at which it is compared; None if a height density determines it."""
        raise NotImplementedError

    def near(self, load: FloatArray, friction: FloatArray) -> Target | None:
        """Return the target of this kind with a law, (k,) each [mm^2]; None if there is none."""
        return None

    @property
    def law(self) -> tuple[FloatArray, FloatArray] | None:
        """Rescaled loads and frictions, both (k,) [mm^2]; None if the target does not fix them completely."""
        law = self.curve()
        return None if law is None or law.is_open else (law.load, law.middle)


@dataclass(frozen=True, eq=False)
class TargetLaw:
    """Law ``lower + free @ c <= A0 <= upper + free @ c`` at loads (k,), with free parameters c (q,).

    For one law `lower` and `upper` are equal; a band has no free parameters.
    """

    load: FloatArray  # (k,) P/E* [mm^2], increasing
    lower: FloatArray  # (k,) F/(sigma B) [mm^2]
    upper: FloatArray  # (k,) [mm^2]
    free: FloatArray  # (k, q), factors of the free parameters
    weight: FloatArray  # (k,), weights of the squared relative differences, of mean 1
    pointwise: bool = False  # whether the misfit is the largest difference, or else the root mean square
    noise: float = 0.0  # weighted root mean square of the relative errors of the law itself

    @classmethod
    def of(
        cls,
        load: FloatArray,
        lower: FloatArray,
        upper: FloatArray | None = None,
        free: FloatArray | None = None,
        weight: FloatArray | None = None,
        *,
        pointwise: bool = False,
        noise: float = 0.0,
    ) -> TargetLaw:
        """Return a law or a band; default: one law without free parameters and with equal weights."""
        free = np.empty((len(load), 0)) if free is None else free
        weight = np.ones(len(load)) if weight is None else weight / weight.mean()
        return cls(load, lower, lower if upper is None else upper, free, weight, pointwise, noise)

    @property
    def is_open(self) -> bool:
        """Whether the target has free parameters."""
        return bool(self.free.shape[1])

    @cached_property
    def is_band(self) -> bool:
        """Whether the target is a band."""
        return bool((self.lower < self.upper).any())

    @property
    def middle(self) -> FloatArray:
        """Middle of the band, or the law without its free part, (k,) [mm^2]."""
        return np.asarray(0.5 * (self.lower + self.upper))

    @property
    def aim(self) -> TargetLaw:
        """The law at which a search aims: the inner part of a band, or the law itself."""
        if not self.is_band:
            return self
        low, high = (self.middle + INNER * (end - self.middle) for end in (self.lower, self.upper))
        return replace(self, lower=low, upper=high)

    def thinned(self, most: int) -> TargetLaw:
        """Return the law at no more than `most` of its loads, evenly spaced by index and with both ends."""
        if len(self.load) <= most:
            return self
        rows = np.unique(np.linspace(0, len(self.load) - 1, most).round().astype(np.int64))
        names = ("load", "lower", "upper", "free")
        part = {name: getattr(self, name)[rows] for name in names}
        return replace(self, **part, weight=self.weight[rows] / self.weight[rows].mean())

    def divided(self, ratio: FloatArray) -> TargetLaw:
        """Return the law divided by a ratio (k,) [-]."""
        low, high = self.lower / ratio, self.upper / ratio
        return replace(self, lower=low, upper=high, free=self.free / ratio[:, None])

    def open_parameters(self, area: FloatArray) -> FloatArray:
        """Return the free parameters for which the law is nearest to an area curve (k,) [mm^2], (q,)."""
        return _nearest(self.free, self.law(area) - self.lower)

    def law(self, area: FloatArray) -> FloatArray:
        """Return the law of the target that is nearest to an area curve, (k,) [mm^2]."""
        if not self.is_open:
            return np.clip(area, self.lower, self.upper)
        law = np.where(area > 0.0, area, area.max())
        for _ in range(ROUNDS):
            scale = np.sqrt(self.weight) / law
            c = _nearest(scale[:, None] * self.free, scale * (area - self.lower))
            law = self.lower + self.free @ c
            if law.min() <= 0.0:  # the curve is far from any law of this kind
                return np.asarray(np.maximum(law, FAR * area))
        return np.asarray(law)

    def laws(self, area: FloatArray) -> FloatArray:
        """Return `law` for each of many area curves (m, k), (m, k)."""
        if not self.is_open:
            return np.clip(area, self.lower, self.upper)
        return np.array([self.law(row) for row in area])

    def residual(self, area: FloatArray, gradient: Callable[[], FloatArray]) -> LateResidual:
        """Return the weighted relative differences (k,) [-], and a function that returns their Jacobian.

        Both are those for the best free parameters; gradient: function that returns dA0/dh [mm], (k, n).
        """
        law = self.law(area)
        scale = np.sqrt(self.weight) / law
        r = scale * (area - law)
        if self.is_band:  # within the band the law may change freely
            scale = np.where(r == 0.0, 0.0, scale)
        if not self.is_open:
            return r, lambda: scale[:, None] * gradient()
        free = scale[:, None] * self.free

        def without_free(values: FloatArray) -> FloatArray:
            return np.asarray(values - free @ _nearest(free, values))

        return without_free(r), lambda: without_free(scale[:, None] * gradient())

    def difference(self, area: FloatArray) -> FloatArray:
        """Return the relative differences of an area curve from the law, (k,) [-]."""
        return np.asarray(area / self.law(area) - 1.0)

    def misfit(self, area: FloatArray) -> float:
        """Return the largest relative difference [-] if the law is pointwise, or the root mean square."""
        difference = self.difference(area)
        if self.pointwise:
            return float(np.abs(difference).max())
        return float(np.sqrt((self.weight * difference**2).mean()))


def _nearest(free: FloatArray, values: FloatArray) -> FloatArray:
    """Return the coefficients (q, ...) for which a sum of columns (k, q) is nearest to values (k, ...)."""
    count = free.shape[1]
    if len(free) >= count:
        _, found, failed = dgels(free, values)  # a fifth of the time of `lstsq`
        if not failed:
            return np.asarray(found[:count])
    return np.asarray(np.linalg.lstsq(free, values, rcond=None)[0])
