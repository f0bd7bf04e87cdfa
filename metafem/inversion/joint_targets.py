"""Surfaces for two targets at once, and the trade-off between their misfits."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem import drawing
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, percent
from metafem.errors import refuse_if
from metafem.inversion.adjustment.first_heights import first_heights
from metafem.inversion.adjustment.on_sites import OnSites
from metafem.inversion.adjustment.refinement import refined
from metafem.inversion.candidate import Candidate
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Problem
from metafem.inversion.quantities.quantity import words
from metafem.inversion.search.asperities import OfRadii
from metafem.inversion.search.levenberg_marquardt import descend, search
from metafem.inversion.search.nearest_law import GOAL, LawSearch, residual_of_heights
from metafem.inversion.search.spaces import Heights, LateResidual, Residual
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies import tools as strategy
from metafem.inversion.targets.target import LEVEL_FRACTIONS, Target
from metafem.inversion.tools.kit import Given
from metafem.inversion.tools.radii import Radii
from metafem.models import Model
from metafem.progress import each
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Default weights of the first target in the sum of squares.
WEIGHTS = (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99)

# Number of random changes for each weight, each about 5 ms. The best surfaces of other weights are initial
# guesses as well.
CHANGES = 10

# The same number for heights on the sites of a template, under a model with interaction. The worst of five
# pairs of laws of random surfaces is met to .12 %; with 10 changes, to .6 %.
SITE_CHANGES = 40

# Heights and radii, (n,) each [mm].
Pair = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False, repr=False)
class TradeOff(Value):
    """Surfaces that meet two targets with different weights.

    Attributes
    ----------
    targets : (Target, Target)
    surfaces : tuple of Surface, (m,)
        None is better than another for both targets; those with a smaller misfit of the first target are
        first.
    misfits : ndarray, (m, 2)
        Root mean square of the relative differences of each surface from both targets [-].
    best : int
        Index of the surface whose larger misfit is smallest.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> friction = mf.PowerLaw(0.9, (0.05, 0.2))
    >>> stiffness = mf.PowerLaw(0.5, (0.05, 0.2), of="stiffness")
    >>> found = mf.trade_off(friction, stiffness, template)
    >>> bool(found.misfits[found.best].max() < 0.1)
    True
    """

    targets: tuple[Target, Target]
    surfaces: tuple[Surface, ...]
    misfits: FloatArray

    def __post_init__(self) -> None:
        self.misfits.flags.writeable = False

    def __repr__(self) -> str:
        first, second = (percent(float(value), ".2g") for value in self.misfits[self.best])
        return f"<TradeOff: {len(self.surfaces)} surfaces, misfits {first} and {second} of the best>"

    @property
    def best(self) -> int:
        """Index of the surface whose larger misfit is smallest."""
        return int(self.misfits.max(axis=1).argmin())

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the misfit of the second target against that of the first, and mark the best surface."""
        ax = drawing.axes(ax)
        names = [f"misfit of the {words(target.of)} [%]" for target in self.targets]
        drawing.trade_off(ax, 100.0 * self.misfits, self.best, names)
        return ax


def trade_off(
    first: Target,
    second: Target,
    template: Surface,
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    *,
    tools: Given | None = None,
    weights: Sequence[float] = WEIGHTS,
) -> TradeOff:
    """Return surfaces that meet two targets together, such as a friction law and a stiffness.

    For each weight w, ``w m_1^2 + (1 - w) m_2^2`` is minimised over the heights, and the radii if several are
    allowed; m_1 and m_2 are the root mean squares of the relative differences from the targets. The minima
    are local.

    Parameters
    ----------
    first, second : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw or Band
        Two targets, usually of different quantities. Lines need a load range.
    template : Surface
        As in `design`.
    model : Model, optional
        Model under which both targets are met; default: `Independent()`. Under a model with interaction, the
        heights on the sites of the template are searched, with the sensitivities of its `gradient_model`;
        the misfits are those under the model itself. The radii are then those found for one target alone.
    limits : Limits, optional
        Range of the heights, as in `design`. `height_step` is not used.
    rng : int or numpy Generator
        Seed of the search and of the assignment of heights to sites.
    tools : sequence of Tool or of float, or RadiusRange, optional
        Tools of one shape, as in `design`.
    weights : sequence of float
        Weights w of the first target [-], between 0 and 1.

    Returns
    -------
    TradeOff

    Raises
    ------
    InvalidInput
        For arguments outside their range, pinned heights, or quantities that are not known under the model.

    Examples
    --------
    The friction and the stiffness of one known surface can be met together.

    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> known = template.replaced(height=0.12 * np.linspace(0.3, 1.0, 64))
    >>> law = mf.friction_law(known, load=np.linspace(0.05, 0.4, 12))
    >>> friction = mf.SampledLaw(law.rescaled_load, law.area)
    >>> stiffness = mf.SampledLaw(law.rescaled_load, law.rescaled_stiffness, of="stiffness")
    >>> found = trade_off(friction, stiffness, template, weights=[0.5])
    >>> bool(found.misfits.max() < 0.005)
    True
    """
    shares = check.array("weights", weights, shape=(None,))
    check.refuse_entries("weights", shares, ~((shares > 0.0) & (shares < 1.0)), "must be between 0 and 1")
    problems = [Problem.checked(target, template, model, limits, tools=tools) for target in (first, second)]
    words = "must have caps of one shape and one friction for two targets"
    refuse_if(not isinstance(problems[0].tools, Radii), words, key="tools")
    refuse_if(bool(problems[0].pins.rows.size), "limits.pinned cannot be used with two targets", key="limits")
    generator = check.generator(rng)
    kind: type[_Both] | type[_BothOnSites] = _Both
    if any(problem.model.couples for problem in problems):
        kind = _BothOnSites
    both: Any = kind(problems, [target.curve() for target in (first, second)], generator)
    starts = both.alone()
    found: list[Any] = []
    for weight in each("weight", shares.tolist()):
        found.append(both.nearest(weight, [*found[::-1], *starts]))
    every = [*found, *starts]
    misfits = np.array([both.misfits(one) for one in every])
    kept = _undominated(misfits)
    sites = generator.permutation(template.count).astype(np.int64)
    surfaces = tuple(both.surface(every[i], sites) for i in kept)
    return TradeOff((first, second), surfaces, misfits[kept])


@dataclass(frozen=True)
class _Both:
    """The problems of two targets, and their laws."""

    problems: list[Problem]
    laws: list[TargetLaw]
    rng: np.random.Generator

    def alone(self) -> list[Pair]:
        """Return heights and radii that are nearest to one target each."""
        found = []
        for problem, law in zip(self.problems, self.laws, strict=True):
            guesses = problem.target.guesses(law, problem.bounds, LEVEL_FRACTIONS)
            found.append(LawSearch(problem, law, guesses, problem.restarts, self.rng).nearest(problem.radii))
        return found

    def misfits(self, pair: Pair) -> tuple[float, ...]:
        """Return the misfit of heights and radii for each target [-]."""
        given = zip(self.problems, self.laws, strict=True)
        return tuple(law.misfit(problem.independent.curve_of(*pair, law.load).area) for problem, law in given)

    def nearest(self, weight: float, starts: list[Pair]) -> Pair:
        """Return heights and radii (n,) each [mm] with the least weighted sum of squares."""
        problem, span = self.problems[0], self.problems[0].limits.span
        radii, count, options = problem.radii, problem.count, problem.options
        shares = (weight, 1.0 - weight)
        if radii.single:
            parts = [
                residual_of_heights(each.independent, radii.low, law)
                for each, law in zip(self.problems, self.laws, strict=True)
            ]
            heights = [height for height, _ in starts]
            given = heights, Heights(span, count), GOAL / 10.0, CHANGES, self.rng, options
            found = search(_weighted(parts, self.laws, shares), *given).unknowns
            return found - found.max(), np.full(len(found), radii.low)
        depth = float(problem.independent.curve_of(*starts[-1], self.laws[0].load[-1:]).approach[0])
        space = OfRadii(span, count, radii=radii, depth=depth)
        parts = [
            space.residual(each.independent, law) for each, law in zip(self.problems, self.laws, strict=True)
        ]
        unknowns = [space.joined(*start) for start in starts]
        summed = _weighted(parts, self.laws, shares)
        found = search(summed, unknowns, space, GOAL / 10.0, CHANGES, self.rng, options).unknowns
        height, radius = space.split(found)
        return height - height.max(), radius

    def surface(self, pair: Pair, sites: IntArray) -> Surface:
        """Return the surface of heights relative to the tallest and radii, on the first of some sites."""
        height, radius = pair
        template, limits = self.problems[0].template, self.problems[0].limits
        used = sites[: len(height)]
        raised = np.maximum(limits.top + height, limits.foot)
        return template.replaced(position=template.position[used], height=raised, radius=radius)


@dataclass(frozen=True)
class _BothOnSites:
    """The problems of two targets under a model with interaction, and their laws."""

    problems: list[Problem]
    laws: list[TargetLaw]
    rng: np.random.Generator

    def alone(self) -> list[Candidate]:
        """Return heights on sites that are near one target each, and have one target under the model."""
        found = []
        for problem in self.problems:
            if problem.first_under_model:
                candidate = first_heights(problem, self.rng)
            else:
                sites = self.rng.permutation(problem.count)
                candidate = strategy.candidate(problem, self.rng)
                candidate = candidate.placed(sites[: len(candidate.height)], problem.limits.foot)
            found.append(refined(problem, candidate, self.rng))
        return found

    def misfits(self, candidate: Candidate) -> tuple[float, ...]:
        """Return the misfit of a candidate for each target under the model [-]."""
        surface = self.surface(candidate)
        laws = zip(self.problems, self.laws, strict=True)
        return tuple(law.misfit(one.model.curve(surface, law.load).rescaled_friction) for one, law in laws)

    def nearest(self, weight: float, starts: list[Candidate]) -> Candidate:
        """Return heights on sites with the least weighted sum of squares that was found."""
        shares = np.array([weight, 1.0 - weight])
        start = min(starts, key=lambda one: float(shares @ np.square(self.misfits(one))))
        every, given = OnSites.of(self.problems[0], start), (self.laws, (weight, 1.0 - weight))
        pairs = list(zip([problem.model for problem in self.problems], self.laws, strict=True))
        residual = _weighted([every.residual(model.gradient_model, law) for model, law in pairs], *given)
        goal = GOAL / 10.0
        found = search(residual, [every.whole.height], every.space, goal, SITE_CHANGES, self.rng).unknowns
        if any(model.gradient_model != model for model, _ in pairs):
            residual = _weighted([every.residual_of_model(*pair) for pair in pairs], *given)
            found = descend(residual, found, every.space, goal).unknowns
        return every.candidate(found)

    def surface(self, candidate: Candidate, sites: IntArray | None = None) -> Surface:
        """Return the surface of a candidate."""
        return candidate.surface(self.problems[0].template)


def _weighted(parts: list[Residual], laws: list[TargetLaw], shares: tuple[float, float]) -> Residual:
    """Return the residual whose mean square is the weighted sum of the mean squares of two residuals."""
    total = sum(len(law.load) for law in laws)
    factors = [math.sqrt(w * total / len(law.load)) for w, law in zip(shares, laws, strict=True)]

    def residual(unknowns: FloatArray) -> LateResidual:
        values, jacobians = zip(*(part(unknowns) for part in parts), strict=True)

        def scaled(every: list[FloatArray]) -> FloatArray:
            return np.concatenate([f * value for f, value in zip(factors, every, strict=True)])

        late: tuple[Callable[[], FloatArray], ...] = jacobians
        return scaled(list(values)), lambda: scaled([jacobian() for jacobian in late])

    return residual


def _undominated(misfits: FloatArray) -> list[int]:
    """Return the indices of points (m, 2) than which no other is better in both, by their first value."""
    kept: list[int] = []
    for i in np.lexsort((misfits[:, 1], misfits[:, 0])).tolist():
        if not kept or misfits[i, 1] < misfits[kept[-1], 1]:
            kept.append(i)
    return kept
