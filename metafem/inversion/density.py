"""Exponential densities of heights, whose laws are straight at large loads (eqs. S2 to S8).

All formulas are those of Hertz contacts of one radius, ``A = pi R d`` and ``P/E* = 4/3 sqrt(R) d^(3/2)``.
`from_density` returns the heights for linear laws (eqs. S3 to S5) and bilinear laws (eqs. S6 to S8).
Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import gammainc, hyp1f1

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.errors import Infeasible, InvalidInput, refuse_if
from metafem.inversion.limits import Limits
from metafem.inversion.lines import BilinearLaw
from metafem.inversion.problem import Branch, Candidate, Parameter, Problem, misfit
from metafem.inversion.target_law import TargetLaw
from metafem.inversion.tools import Given, Tools
from metafem.models.model import PARABOLOID, checked_contact
from metafem.notes import Note
from metafem.surface import Surface

# A straight line is fitted to a branch beyond this fraction of its load range. At smaller loads the law still
# bends towards its asymptote. With this range the surfaces of Aymard et al. have their published slopes and
# scatter.
BRANCH_START = 0.25

# Largest slope, relative to the slope of the uniform density. The scale decreases with the inverse square of
# the slope. At this slope it is as small as the rounding error of the largest height.
STEEPEST = 1e7

# Number of separations, from the top to the foot of a density, at which its law is compared with the law of
# the heights.
SEPARATIONS = 61

# The nearest reachable slope is inside its bound by this relative distance, and an end of a range that is
# stated with six digits by this one.
INSIDE, STATED = 1e-6, 1e-5

# Crossover loads that are tried for a pair of slopes that is refused, over the load at the foot, and number
# of depths of a crossover height, evenly spaced in logarithms.
TRIED, DEPTHS = np.arange(1, 100) / 100, 1000

# Finest scale of a density over the standard deviation of the heights: below it their density is no longer
# exponential. This is a rule of thumb of Aymard et al., doi:10.1126/science.adk4234.
FINEST_SCALE_IN_SD = 10.0

# Smallest relative tolerance that brentq accepts.
TIGHTEST = 4.0 * np.finfo(float).eps


@dataclass(frozen=True)
class ExponentialDensity:
    """Exponential density of heights up to a maximum, with a different factor below a crossover height.

    The density is ``alpha_2 exp(-h/lambda)`` on [h_c, h_m] and ``alpha_1 exp(-h/lambda)`` on [0, h_c]. Here
    ``alpha_2 = u / (lambda (1 - exp(-h_m/lambda)))``, and alpha_1 makes the total mass 1 (eq. S6). Without a
    crossover height it is the truncated exponential density.

    Examples
    --------
    >>> density = ExponentialDensity(0.040, 0.120)
    >>> round(density.asymptotic_slope(0.526), 3), round(density.intercept(64, 0.526), 4)
    (6.875, 0.2617)
    >>> round(float(ExponentialDensity(0.0357, 0.120, 0.0153, 0.149).mass(0.0, 0.120)), 12)
    1.0
    """

    scale: float  # lambda [mm], positive
    max_height: float  # h_m [mm], positive
    crossover_height: float = 0.0  # h_c [mm], below h_m
    weight: float = 1.0  # u [-], positive, and so small that the mass of the upper branch is at most 1

    def __post_init__(self) -> None:
        check.number("scale", self.scale, above=0.0)
        top = check.number("max_height", self.max_height, above=0.0)
        middle = check.number("crossover_height", self.crossover_height, at_least=0.0)
        check.number("weight", self.weight, above=0.0)
        refuse_if(middle >= top, f"crossover_height = {middle:g} must be below max_height = {top:g}")
        refuse_if(
            self.upper_mass > 1.0 + 1e-12,  # allows for rounding of a weight at its limit
            f"weight = {self.weight:g} puts {self.upper_mass:.4g} of the asperities above the crossover "
            "height; it must be small enough for at most 1",
        )

    @property
    def upper_mass(self) -> float:
        """Fraction of the asperities above the crossover height."""
        whole = _mass(0.0, self.max_height, self.scale)
        return self.weight * float(_mass(self.crossover_height, self.max_height, self.scale) / whole)

    @property
    def pieces(self) -> tuple[tuple[float, float, float], ...]:
        """Ends [mm] and factor alpha [1/mm] of each branch ``alpha exp(-h/lambda)``, from the foot up."""
        lam, top, mid = self.scale, self.max_height, self.crossover_height
        upper = self.weight / (lam * float(_mass(0.0, top, lam)))  # eq. S6, alpha_2
        if mid == 0.0:
            return ((0.0, top, upper),)
        lower = max(0.0, 1.0 - self.upper_mass) / (lam * float(_mass(0.0, mid, lam)))  # alpha_1
        return (0.0, mid, lower), (mid, top, upper)

    def mass(self, low: ArrayLike, high: ArrayLike) -> FloatArray:
        """Return the probability [-] of a height between `low` and `high` [mm]."""
        parts = (
            alpha * self.scale * _mass(np.clip(low, start, end), np.clip(high, start, end), self.scale)
            for start, end, alpha in self.pieces
        )
        return np.asarray(sum(parts))

    def moment(self, power: float, separation: ArrayLike) -> FloatArray:
        """Return the mean of ``max(h - delta, 0)^power`` [mm^power] at separations from 0 to h_m [mm].

        A piece from a to b contributes ``lambda^(q+1) alpha e^(-delta/lambda) Gamma(q+1)`` times
        ``gamma(q+1, (b - delta)/lambda) - gamma(q+1, (a - delta)/lambda)``.
        """
        delta = np.asarray(separation, dtype=np.float64)
        if not ((delta >= 0.0) & (delta <= self.max_height)).all():
            words = f"must lie within the density, from 0 to {self.max_height:g} mm"
            raise InvalidInput(words, key="separation", value=f"{separation!r:.60}")
        lam, q = self.scale, power + 1.0

        def below(height: float) -> FloatArray:
            return np.asarray(gammainc(q, np.maximum(height - delta, 0.0) / lam))

        total = sum(alpha * (below(high) - below(low)) for low, high, alpha in self.pieces)
        return np.asarray(lam**q * math.gamma(q) * np.exp(-delta / lam) * total)

    def area(self, separation: ArrayLike, count: float, radius: float) -> FloatArray:
        """Return the expected real contact area A0 = N pi R <d> [mm^2] (eq. S2, F/(sigma B))."""
        return count * math.pi * radius * self.moment(1.0, separation)

    def rescaled_load(self, separation: ArrayLike, count: float, radius: float) -> FloatArray:
        """Return the expected load P/E* = N 4/3 sqrt(R) <d^(3/2)> [mm^2] (eq. S2)."""
        return count * 4.0 / 3.0 * math.sqrt(radius) * self.moment(1.5, separation)

    def slope(self, separation: ArrayLike, radius: float) -> FloatArray:
        """Return the slope dA0/d(P/E*) = pi sqrt(R)/2 <1>/<sqrt d> [-] at separations below h_m [mm]."""
        share = self.mass(separation, self.max_height)
        return np.asarray(0.5 * math.pi * math.sqrt(radius) * share / self.moment(0.5, separation))

    def asymptotic_slope(self, radius: float) -> float:
        """Return the slope [-] of the only or first branch at large loads (eqs. S3, S7).

        It is the slope of the truncated exponential density when the plane reaches the foot.
        """
        excess = float(slope_excess(self.max_height / self.scale))
        return uniform_slope(radius, self.max_height) * (1.0 + excess)

    def asymptotic_slopes(self, radius: float) -> tuple[float, float]:
        """Return the slopes m_1 and m_2 [-] of two branches at large loads (eqs. S7, S8).

        m_2 is the slope when the plane reaches the foot.
        """
        return self.asymptotic_slope(radius), float(self.slope(0.0, radius))

    def intercept(self, count: float, radius: float) -> float:
        """Return the intercept [mm^2] of the asymptote of a truncated exponential density.

        It is ``pi N R lambda Gamma(x)`` with x = h_m/lambda and
        ``Gamma(x) = x e^-x/(1 - e^-x) (4/(3 sqrt(pi)) sqrt(x) g(x) - 1)``. The bracket is `slope_excess`.
        """
        x = self.max_height / self.scale
        factor = x * math.exp(-x) / -math.expm1(-x) * float(slope_excess(x))
        return count * math.pi * radius * self.scale * factor

    def crossover_load(self, count: float, radius: float) -> float:
        """Return the load P_c/E* [mm^2] at which the plane reaches the crossover height (eq. S8)."""
        return float(self.rescaled_load(self.crossover_height, count, radius))


def slope_excess(x: ArrayLike) -> FloatArray:
    """Return m(x) / m(0) - 1 [-]: the relative excess of the slope over that of a uniform density.

    Here x = h_m / lambda, ``m = sqrt(pi R / lambda) g(x)`` (eqs. S3, S4) and ``m(0) = 3 pi/4 sqrt(R/h_m)``.
    The ratio is ``sqrt(x) (1 - e^-x) / (Gamma(5/2) gamma(3/2, x))``, where ``k(x) = gamma(3/2, x)`` (eq. S5).
    It increases with x, as 1 + x/10 for small x, and is a quotient of Kummer's functions, M(1, 2, x) over
    M(1, 5/2, x).

    Examples
    --------
    >>> slope_excess([0.0, 1e-9, 3.0]).round(13)
    array([0.00000000e+00, 1.00000000e-10, 3.93611793e-01])
    """
    value = np.asarray(x, dtype=np.float64)
    large = np.maximum(value, 1.0)
    direct = np.sqrt(large) * -np.expm1(-large) / (math.gamma(2.5) * gammainc(1.5, large)) - 1.0
    small = np.minimum(value, 1.0)
    # M(1, b, x) - 1 = x/b M(1, b + 1, x), which keeps the digits of the difference
    first, second = (small / b * hyp1f1(1.0, b + 1.0, small) for b in (2.0, 2.5))
    return np.asarray(np.where(value < 1.0, (first - second) / (1.0 + second), direct))


def scale_from_slope(slope: float, radius: float, max_height: float) -> float:
    """Return the scale lambda [mm] of the truncated exponential density that has a slope (eqs. S3, S7).

    The slope must exceed `uniform_slope`, the slope of the uniform density.
    """
    bound = uniform_slope(radius, max_height)
    excess = (slope - bound) / bound
    # as k(x) <= 1, the ratio exceeds sqrt(x) (1 - e^-x)/Gamma(5/2), and the root lies below `upper`
    upper = 2.0 * (math.gamma(2.5) * (1.0 + excess)) ** 2
    # small x is about 10 times the excess, so the absolute tolerance is proportional to the excess
    given = {"xtol": TIGHTEST * excess, "rtol": TIGHTEST}
    x = brentq(lambda x: float(slope_excess(x)) - excess, 0.0, upper, **given)
    return max_height / float(x)  # eq. S3 solved for lambda


def uniform_slope(radius: float, max_height: float) -> float:
    """Return the slope ``3 pi/4 sqrt(R/h_m)`` [-] of uniformly distributed heights, the least of all."""
    return 0.75 * math.pi * math.sqrt(radius / max_height)


def middles(density: ExponentialDensity, low: float, high: float, count: int) -> FloatArray:
    """Return the middles of intervals of equal mass between two heights, tallest first, (count,) [mm]."""
    lam = density.scale
    # e^(-(h - low)/lambda) decreases linearly with the mass between the lower end and h
    fallen = np.arange(1, count) / count * -math.expm1((low - high) / lam)
    ends = np.concatenate([[low], low - lam * np.log1p(-fallen), [high]])
    return np.asarray(0.5 * (ends[1:] + ends[:-1])[::-1])


def level_counts(density: ExponentialDensity, count: int, step: float) -> tuple[FloatArray, IntArray]:
    """Return levels at the middles of height steps, (l,) [mm], and the numbers of asperities on them, (l,).

    The numbers are the expected numbers rounded to integers. Until their sum is `count`, single numbers are
    changed by 1. Each change is made where the relative difference from the expected number is then smallest.
    The highest level includes the mass up to the maximum height.
    """
    number = max(1, math.floor(density.max_height / step + 0.5))
    levels = np.asarray(step * (np.arange(number) + 0.5), dtype=np.float64)
    ends = np.append(step * np.arange(len(levels)), density.max_height)
    expected = count * density.mass(ends[:-1], ends[1:])
    counts = np.rint(expected).astype(np.int64)
    while (missing := count - int(counts.sum())) != 0:
        changed = counts + (1 if missing > 0 else -1)
        error = np.full(len(counts), np.inf)
        np.divide(np.abs(changed - expected), expected, out=error, where=(changed >= 0) & (expected > 0.0))
        best = int(error.argmin())
        counts[best] = changed[best]
    return levels, counts


def crossing(
    plain: ExponentialDensity, load: float, depth: float, count: int, radius: float
) -> ExponentialDensity:
    """Return the density with the first slope of `plain` up to a crossover load [mm^2] (eq. S8).

    Its crossover height is at a depth [mm] below the top. P_c is proportional to the weight u, so the load
    determines u for each depth.
    """
    middle = plain.max_height - depth
    weight = load / float(plain.rescaled_load(middle, count, radius))  # eq. S8, P_c/E*
    return ExponentialDensity(plain.scale, plain.max_height, middle, weight)


def crossing_ends(
    plain: ExponentialDensity, load: float, count: int, radius: float
) -> list[tuple[float, float]] | None:
    """Return the least and largest depth [mm] of a crossover, each with m_2 [-]; None if there are none.

    Each branch has at least half an asperity. Equal asperities of the maximum height carry the crossover load
    at the least depth that is tried.
    """
    least, top = float((0.75 * load / count / math.sqrt(radius)) ** (2.0 / 3.0)), plain.max_height
    if least >= top or load >= plain.rescaled_load(0.0, count, radius):
        return None
    depth = np.geomspace(least, top * (1.0 - 1e-6), DEPTHS)
    carried = plain.rescaled_load(top - depth, count, radius)
    if not carried[0]:  # double precision does not resolve the load
        return None
    share = load / carried * plain.mass(top - depth, top)
    some = depth[(share >= 0.5 / count) & (share <= 1.0 - 0.5 / count)].tolist()
    if len(some) < 2:
        return None
    ends = [
        (end, crossing(plain, load, end, count, radius).asymptotic_slopes(radius)[1])
        for end in (some[0], some[-1])
    ]
    return ends if ends[0][1] < ends[1][1] else None


def _mass(low: ArrayLike, high: ArrayLike, scale: float) -> FloatArray:
    """Return the integral [-] of exp(-h/lambda)/lambda between two heights [mm]."""
    lo, hi = np.asarray(low, dtype=np.float64), np.asarray(high, dtype=np.float64)
    return np.asarray(-np.exp(-lo / scale) * np.expm1((lo - hi) / scale))


def achievable_friction_coefficients(
    template: Surface,
    limits: Limits,
    tools: Given | None = None,
    contact: Contact = PARABOLOID,
) -> tuple[float, float]:
    """Return the smallest and largest friction coefficient of linear laws from exponential height densities.

    Uniformly distributed heights have the smallest coefficient, ``3 pi/4 sqrt(R/h_m) sigma B / E*`` with
    Hertz contacts. The density with the smallest scale that can be manufactured, ten times
    `limits.height_sd`, has the largest coefficient; without a `height_sd` it is infinite. If several radii
    are allowed, the lower bound is that of the smallest radius and the upper bound that of the largest one.

    Parameters
    ----------
    template : Surface
        Template with a friction, and with one common radius unless `tools` is given.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity, as in `design`; default: the radius and cap of the template.
    contact : Contact
        Hertz's law (default) or JKR's, whose adhesion is ignored.

    Returns
    -------
    low, high : float
        Friction coefficients mu [-].

    Raises
    ------
    InvalidInput
        If the template has no friction, if it has several radii and `tools` is not given, or if a radius is
        not positive.

    Notes
    -----
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(
    ...     0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    ... )
    >>> limits = Limits(max_height=0.120, height_sd=0.0009)
    >>> [round(mu, 3) for mu in achievable_friction_coefficients(template, limits)]
    [1.104, 3.032]
    """
    check.instance("limits", limits, Limits, "metafem.Limits")
    if template.friction is None:
        raise InvalidInput("template has no friction; a friction coefficient needs metafem.Friction")
    stress = template.friction.stress
    choice = Tools.of(tools, template, checked_contact(contact))
    words = f"needs Hertz contacts without adhesion or with it, not {choice.law}"
    refuse_if(choice.law.without_adhesion.power != 2.0, words, key="contact")
    per_slope = stress / template.material.composite_modulus
    radii = [summit for _, summit in choice.laws]
    low, high = uniform_slope(min(radii), limits.span), math.inf
    if limits.height_sd:
        finest = ExponentialDensity(FINEST_SCALE_IN_SD * limits.height_sd, limits.span)
        high = finest.asymptotic_slope(max(radii))
    return low * per_slope, high * per_slope


def from_density(problem: Problem, rng: np.random.Generator) -> Candidate:
    """Return heights that follow a density of one or two branches whose law has the target slopes.

    The density is that of Hertz contacts; under another law the heights are then refined. Of several tools,
    the one is used whose heights have the nearest law.
    """
    found, reasons = list[Candidate](), list[Infeasible]()
    for tool in problem.tools.tried.tolist():
        try:
            found.append(_of_tool(problem, tool, rng))
        except Infeasible as reason:
            reasons.append(reason)
    if not found:
        raise reasons[0]
    return min(found, key=lambda one: misfit(problem, one.asperities, one.law, problem.uncoupled))


def _of_tool(problem: Problem, index: int, rng: np.random.Generator) -> Candidate:
    """Return heights of asperities made by one tool, or raise Infeasible."""
    lines, limits, count = problem.target.lines, problem.limits, problem.count
    tool, (law, _) = problem.tools.all[index], problem.tools.laws[index]
    try:
        radius = float(tool.cap.summit_radius(np.array([tool.radius]))[0])
        refuse_if(law.without_adhesion.power not in (None, 2.0), f"{law} has no curvature")
    except InvalidInput as error:
        words = "without load_range the heights follow the density of Hertz contacts"
        raise Infeasible(f"{problem.target.title}: {words}, and {error}; give load_range") from None
    plain = ExponentialDensity(_scale(problem, radius), limits.span)
    found: dict[str, Parameter] = {"scale": plain.scale}
    density, intercept, stepped, top = plain, None, False, limits.span
    if len(lines) == 1:
        found["intercept"] = intercept = plain.intercept(count, radius)
        height = middles(plain, 0.0, top, count)
        if limits.height_step is not None:
            levels, numbers = level_counts(plain, count, limits.height_step)
            height, stepped, used = np.repeat(levels, numbers)[::-1], True, numbers > 0
            found |= {"levels": limits.foot + levels[used], "counts": numbers[used]}
    else:
        density = _two_branches(problem, plain, radius)
        middle = density.crossover_height
        upper = min(max(round(count * density.upper_mass), 1), count - 1)  # N_1 of regime 1, h > h_c
        height = np.append(middles(density, middle, top, upper), middles(density, 0.0, middle, count - upper))
        found |= {"weight": density.weight, "crossover_height": limits.foot + middle}
        found |= {"counts": np.array([upper, count - upper])}
    found["foot_load"] = end = float(density.rescaled_load(0.0, count, radius))
    branches = tuple(
        Branch(slope, (start + BRANCH_START * (stop - start), stop), intercept)
        for (slope, start), stop in zip(lines, [*(start for _, start in lines[1:]), end], strict=True)
    )
    at = problem.placed(height - height[0], np.full(count, index), rng, top=limits.foot + height[0])
    return Candidate(
        at, law_of(density, branches, count, radius), found=found, branches=branches,
        density=density, notes=_notes(problem, plain.scale, radius), stepped=stepped,
    )  # fmt: skip


def law_of(density: ExponentialDensity, branches: Sequence[Branch], count: int, radius: float) -> TargetLaw:
    """Return the law of a density at evenly spaced separations, from the start of the first fit."""
    separation = density.max_height * (1.0 - np.arange(SEPARATIONS) / (SEPARATIONS - 1))
    load = density.rescaled_load(separation, count, radius)
    inside = load >= branches[0].load_range[0]
    return TargetLaw.of(load[inside], density.area(separation[inside], count, radius))


def _scale(problem: Problem, radius: float) -> float:
    """Return the scale [mm] at which the truncated exponential has the only or first slope of a target."""
    target: Any = problem.target
    slope, wording, span = target.lines[0][0], target.wording, problem.limits.span
    bound, least = uniform_slope(radius, span), (1.0 + INSIDE) * uniform_slope(radius, span)
    if bound < slope <= STEEPEST * bound:
        return scale_from_slope(slope, radius, span)
    given, stated, name = wording.slopes(slope), f"{wording.coefficient(bound):.6g}", wording.name()
    pair = "" if wording.per_slope is None else " sigma B/E*"
    if slope > bound:
        raise Infeasible(
            f"{given} exceeds {STEEPEST:g} times the bound {stated}: the heights would differ by less than "
            f"double precision resolves; lower the {name}",
        )
    # 3 pi/4 sqrt(R/h) has the slope at this radius, and at this height
    smaller, higher = radius * (slope / bound) ** 2, span * (bound / slope) ** 2
    one = len(target.lines) == 1
    nearest = {"slope": least} if one else {"slopes": (least, target.slopes[1])}
    raise Infeasible(
        f"{given} is not above the bound 3 pi/4 sqrt(R/h_m){pair} = {stated} of asperities of radius R = "
        f"{radius:g} mm within h_m = {span:g} mm of height; use a radius below {smaller:.3g} mm, heights of "
        f"more than {higher:.3g} mm, or a larger {name}",
        replace(target, **nearest),
    )


def _notes(problem: Problem, scale: float, radius: float) -> tuple[Note, ...]:
    finest = FINEST_SCALE_IN_SD * (problem.limits.height_sd or 0.0)
    if scale >= finest:
        return ()
    steepest = ExponentialDensity(finest, problem.limits.span).asymptotic_slope(radius)
    text = (
        f"the scale {scale:.4g} mm is below {FINEST_SCALE_IN_SD:g} times height_sd, {finest:.4g} mm: height "
        f"errors will change the law; they will not for {problem.target.wording.slopes(steepest)} and below"
    )
    return (Note(text, quantity="scale", value=scale, bound=finest, remedies=("slope",)),)


def _two_branches(problem: Problem, plain: ExponentialDensity, radius: float) -> ExponentialDensity:
    """Return the density with the slopes and crossover load of a target, or raise Infeasible.

    `plain` is the truncated exponential density with the first slope. Eq. S8 is solved for h_c.
    """
    target, count, wording = cast(BilinearLaw, problem.target), problem.count, problem.target.wording
    (first, second), load = target.slopes, target.crossover_load

    def missing(depth: float) -> float:
        return crossing(plain, load, depth, count, radius).asymptotic_slopes(radius)[1] - second

    ends = crossing_ends(plain, load, count, radius)
    if ends is not None and ends[0][1] <= second <= ends[1][1]:
        given = {"xtol": TIGHTEST * plain.max_height, "rtol": TIGHTEST}
        return crossing(plain, load, brentq(missing, ends[0][0], ends[1][0], **given), count, radius)
    # ends that are stated with six digits are inside by more than their rounding
    inwards, full = np.array([1.0 + STATED, 1.0 - STATED]), float(plain.rescaled_load(0.0, count, radius))
    tried = [(each, crossing_ends(plain, each, count, radius)) for each in full * TRIED]
    within = [each for each, other in tried if other is not None and other[0][1] <= second <= other[1][1]]
    words, nearest = "; use more asperities", None
    if len(within) > 1:
        low, high = np.array([within[0], within[-1]]) * inwards
        words = f"; with these slopes crossover_load can be from {wording.loads(low, high)}"
        nearest = replace(target, crossover_load=float(np.clip(load, low, high)))
    reason = f"leaves a branch less than one of {count} asperities: the law ends at {wording.loads(full)}"
    if ends is not None:
        low, high = np.array([slope for _, slope in ends]) * inwards
        nearest = replace(target, slopes=(first, float(np.clip(second, low, high))))
        stated = " to ".join(f"{wording.coefficient(end):.6g}" for end in (low, high))
        words = f"; the second {wording.name()} can be from {stated}{words}"
        key = wording.name(2).replace(" ", "_")
        reason = f"does not allow {key}[1] = {wording.coefficient(second):g}"
    start = f"crossover_load = {wording.loads(load)} after {wording.slopes(first)}"
    raise Infeasible(f"{start} {reason}{words}", nearest)
