"""Robust designs: heights and sites that minimise the expected misfit of the manufactured surface.

The law of the heights h has the relative differences r(h) (k,) from the target. With random errors D of the
manufactured surface and of its alignment, the expected squared misfit is

    E |r(h + D)|^2 = |E r|^2 + tr Cov r,        Cov r = J C J' to first order,             (1)

with the Jacobian J = dr/dh and the covariance C of the errors of the heights. The mean E r differs from r(h)
by half of the second derivatives times C: errors smooth a law, most at small loads. A suitable change of the
heights can cancel this difference.

Linear response. For independent asperities of one radius R, n of them in contact with indentations d_i, the
sensitivities of A0 at fixed load are ``g_i = pi R (1 - sqrt(d_i)/<sqrt(d)>)``, see `Independent`. As
``A0 = pi R n <d>`` and ``A0' = dA0/d(P/E*) = pi sqrt(R)/(2 <sqrt(d)>)``, the sum of the squares of g_i is

    sum_i g_i^2 = (4/pi) A0 A0'^2 - (pi R)^2 n.                                            (2)

The target determines the first term. It also determines the number of contacts n at each load, up to the
scatter from single contacts. No heights with this law can therefore remove the linear response to independent
errors of the heights. The response to a tilt, with the components ``sum_i g_i x_i`` and ``sum_i g_i y_i``,
depends on the sites. Exchanges of asperities and small changes of the heights reduce this response.

Method. The expectation is approximated by a mean over fixed errors. For errors of d dimensions these are the
rows of random orthogonal matrices times sqrt(d), each with both signs. The mean is exact for a law that is
linear in the errors. With independent random errors, the heights would be fitted to the sample (measured:
with 8 pairs the root mean square over the sample fell to a third, but the expectation did not fall). The
residuals for all errors are stacked, with exact Jacobians, and the Levenberg–Marquardt method minimises their
squares. To save time, the triangular factor of a QR decomposition replaces the stack. This factor gives the
same sum of squares and has at most n + 1 rows. The errors smooth the kinks of the law at heights at which a
contact opens.

Limits. The errors are assumed independent of the heights. The minimum is local. If there are few errors for
many dimensions, the heights are still partly fitted to the sample. The gain is therefore measured on other
errors in pairs of both signs, which are the same for the plain and the robust design.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.special import ndtr

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.inversion.adjustment.pinned import space_of
from metafem.inversion.assessment import DesignStatus, model_misfit, status_of
from metafem.inversion.candidate import Candidate, Parameter, below_limit
from metafem.inversion.placement.exchange import EXCHANGE_GAIN, FEW_SITES, FORECAST_SITES, swap
from metafem.inversion.problem import Problem
from metafem.inversion.search.levenberg_marquardt import descend
from metafem.inversion.search.spaces import Heights, LateResidual
from metafem.notes import Note, information
from metafem.prediction.perturbation import Tolerances
from metafem.progress import doing, each
from metafem.surface import Surface

# A gain is significant if it exceeds this number of its standard errors.
SIGNIFICANT = 3.0

# Number of surfaces solved between two progress reports.
AT_ONCE = 100

# Minimum and maximum number of fixed errors for the expectation, each with both signs. If their number is a
# multiple of the dimension of the errors, the mean is exact for a linear response.
FEWEST_ERRORS, MOST_ERRORS = 32, 128

# Heights are changed only up to this number of asperities: with more, the errors average out.
MOST_ROBUST = 128

# Maximum number of target loads, and number of rounds of site exchanges, each followed by a new search.
LOADS, ROUNDS = 30, 1

# The gain is measured on this number of other errors, each with both signs, for up to `FEW_SITES` asperities.
# With more asperities the number decreases to the second value.
FRESH_ERRORS, FEWEST_FRESH = 1000, 20


def made_robust(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with heights and sites for the smallest expected misfit.

    Heights on levels do not change, and neither do the heights of many asperities. Their sites change only
    if the tolerances include an angle.
    """
    count = problem.tolerances.dimensions(candidate.surface(problem.template))
    if count == 0:
        return candidate
    with doing("lowering the expected misfit"):
        if (candidate.stepped and not problem.model.couples) or len(candidate.height) > MOST_ROBUST:
            return _exchanged(problem, candidate, rng) if problem.tolerances.angle else candidate
        unit = _with_both_signs(_orthogonal(count, FEWEST_ERRORS, MOST_ERRORS, rng))
        best, misfit = _lowered(problem, candidate, unit)
        for _ in each("exchange of sites", range(ROUNDS if problem.tolerances.angle else 0)):
            found = _lowered(problem, _exchanged(problem, best, rng), unit)
            best, misfit = found if found[1] < misfit else (best, misfit)
    return best


def compared(problem: Problem, plain: Candidate, robust: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the robust candidate, or the plain candidate if the gain is not significant.

    The expected misfits are added to its parameters. The mean square misfits of the two candidates are
    compared for each pair of errors with opposite signs.
    """
    count = problem.tolerances.dimensions(plain.surface(problem.template))
    if count == 0:
        return replace(plain, notes=(*plain.notes, information("the tolerances of the robust design are 0")))
    # the time for a curve grows at least with the square of the number of asperities
    draws = FRESH_ERRORS * FEW_SITES**2 // max(FEW_SITES, len(plain.height)) ** 2
    unit = _with_both_signs(rng.standard_normal((max(FEWEST_FRESH, draws), count)))
    before = _mean_squares(problem, plain, unit)
    after = _mean_squares(problem, robust, unit)
    # if an equilibrium did not converge, its pair of errors is omitted for both candidates
    solved = np.isfinite(before + after)
    before, after = before[solved], after[solved]
    if len(before) < 2:  # a single value has no standard error
        words = "the expected misfit is unknown: the equilibria of the made surfaces did not converge"
        return replace(plain, notes=(*plain.notes, Note(words)))
    # avoids division by zero: an exact law that does not respond to the errors has no misfit
    scale = max(float(before.mean()), np.finfo(float).tiny)
    gain = float((before - after).mean()) / scale
    error = float((before - after).std(ddof=1)) / math.sqrt(len(before)) / scale
    gained = gain > SIGNIFICANT * error
    chosen, squares = (robust, after) if gained else (plain, before)
    if gained:  # the target counts as reached if the plain heights reach it
        status = status_of(plain, model_misfit(problem, plain))
        chosen = replace(chosen, robust=status is not DesignStatus.MISSED)
    expected = max(float(squares.mean()), np.finfo(float).tiny)
    some = unit[:: len(unit) // AT_ONCE + 1]
    share = _irreducible(problem, chosen, some) / expected
    parameters: dict[str, Parameter] = {
        **chosen.parameters,
        "expected_misfit": math.sqrt(expected),
        "plain_expected_misfit": math.sqrt(scale),
        "robust_gain": gain if gained else 0.0,
        "robust_gain_error": error,
        "irreducible_share": share,
    }
    model, lost = problem.model, len(solved) - len(before)
    parts = [
        f"the expected misfit of the made surface is lowered from {percent(math.sqrt(scale), '.3g')} to "
        f"{percent(math.sqrt(expected), '.3g')} (rms), its square by {percent(gain)} with a standard error "
        f"of {percent(error)}"
        if gained
        else "the heights are those of the plain design, because the gain of robust ones is below three "
        f"standard errors: the expected misfit of the made surface is {percent(math.sqrt(scale))} (rms), and "
        f"robust heights change its square by {percent(-gain, '+.2g')} with a standard error of "
        f"{percent(error)}",
        f"{percent(share, '.3g')} of the square is the linear response to errors of single asperities, which "
        "no heights with this law remove",
    ]
    if model.gradient_model != model:
        parts.append(f"these numbers are those of the model {model.gradient_model.name}")
    if lost:
        parts.append(f"{lost} pairs of draws did not converge and are left out")
    return replace(
        chosen,
        parameters=parameters,
        notes=(*chosen.notes, information("; ".join(parts))),
    )


def _orthogonal(count: int, fewest: int, most: int, rng: np.random.Generator) -> FloatArray:
    """Return `fewest` to `most` rows of random orthogonal matrices times sqrt(count), (s, count).

    The mean square of the rows of each complete matrix is 1 in every direction.
    """
    parts = []
    for _ in range(-(-fewest // count)):
        q, r = np.linalg.qr(rng.standard_normal((count, count)))
        # with the signs of the triangular factor, all orthogonal matrices are equally likely
        parts.append(math.sqrt(count) * q * np.sign(np.diagonal(r)))
    return np.concatenate(parts)[:most]


def _with_both_signs(normal: FloatArray) -> FloatArray:
    """Return the points in the unit cube for normal deviates (s, d) and their negatives, (2 s, d)."""
    return np.asarray(ndtr(np.concatenate([normal, -normal])))


def _exchanged(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate after site exchanges, each of which reduces the linear response to tilts.

    The response is ``M = G x`` (k, 2), with the Jacobian G (k, N) of the residual and the sites x (N, 2). An
    exchange of the asperities at the sites a and b changes M by ``(g_a - g_b) (x_b - x_a)'``. An empty site
    has g = 0. Prescribed heights remain on their sites.
    """
    law, template = candidate.target_law, problem.template
    found = problem.model.gradient_model.sensitivity(candidate.surface(template), law.load)
    position, total = template.position, problem.count
    gradient, order = np.zeros((len(law.load), total)), np.full(total, -1)
    gradient[:, candidate.sites] = law.residual(found.curve.area, found.gradient)[1]
    order[candidate.sites] = np.arange(len(candidate.sites))
    for _ in range(total):
        few = total <= FORECAST_SITES
        sites = np.arange(total) if few else rng.choice(total, FORECAST_SITES, replace=False)
        if candidate.held.size:
            sites = np.setdiff1d(sites, candidate.held)
        if not sites.size:
            break
        moment = gradient @ position
        x, g = position[sites], gradient[:, sites]
        moved, changed = x[None, :] - x[:, None], g[:, :, None] - g[:, None, :]
        change = 2.0 * np.einsum("kc,kab,abc->ab", moment, changed, moved, optimize=True)
        change += (changed**2).sum(axis=0) * (moved**2).sum(axis=2)
        a, b = np.unravel_index(int(change.argmin()), change.shape)
        if not change[a, b] < -EXCHANGE_GAIN * (moment**2).sum():
            break
        i, j = sites[a], sites[b]
        gradient[:, [i, j]] = gradient[:, [j, i]]
        swap(order, i, j)
    sites = np.flatnonzero(order >= 0)
    rows = order[sites]
    return replace(candidate.taken(rows), sites=sites)


def _errors(tolerances: Tolerances, surface: Surface, unit: FloatArray) -> list[tuple[Surface, FloatArray]]:
    """Return for each sample the surface with its radii and positions, and the height errors (n,) [mm]."""
    drawn = tolerances.perturbed(surface, unit)
    parts = [surface] * len(unit)
    for name in ("radius", "position"):
        values = getattr(drawn, name)
        if values is not None:
            parts = [part.replaced(**{name: value}) for part, value in zip(parts, values, strict=True)]
    return list(zip(parts, drawn.height - surface.height, strict=True))


def _lowered(problem: Problem, start: Candidate, unit: FloatArray) -> tuple[Candidate, float]:
    """Return the candidate with the least mean square misfit over the errors, and the root of this misfit."""
    model, limits, options = problem.model, problem.limits, problem.options
    law, surface = start.target_law.thinned(LOADS), start.surface(problem.template)
    solver, errors = model.gradient_model, _errors(problem.tolerances, surface, unit)
    held = space_of(problem, start) if start.held.size else None

    def placed(height: FloatArray) -> FloatArray:
        return below_limit(height, limits) if held is None else height

    def residual(height: FloatArray) -> LateResidual:
        rows = []
        for part, shift in errors:
            found = solver.sensitivity(part, law.load, placed(height) + shift)
            r, jacobian = law.residual(found.curve.area, found.gradient)
            rows.append(np.column_stack([jacobian, r]))
        stacked = np.concatenate(rows)
        factor = np.asarray(np.linalg.qr(stacked, mode="r"))
        factor *= math.sqrt(len(factor) / len(stacked))  # so that the mean square is that of the stack
        return factor[:, -1], lambda: factor[:, :-1]

    found = descend(residual, start.height, held or Heights(limits.span), 0.0, options=options)
    return start.with_heights(placed(found.unknowns)), found.misfit


def _mean_squares(problem: Problem, candidate: Candidate, unit: FloatArray) -> FloatArray:
    """Return the mean square misfit of the two surfaces of each pair of errors with opposite signs, (s,)."""
    surface, law = candidate.surface(problem.template), candidate.target_law
    squares = []
    for rows in each("draws, part", np.array_split(np.arange(len(unit)), -(-len(unit) // AT_ONCE))):
        drawn = problem.tolerances.perturbed(surface, unit[rows])
        area = problem.model.gradient_model.areas(surface, law.load, *drawn)
        solved = np.isfinite(area).all(axis=1)
        square = np.full(len(area), np.nan)
        square[solved] = (law.weight * (area[solved] / law.laws(area[solved]) - 1.0) ** 2).mean(axis=1)
        squares.append(square)
    return np.asarray(np.concatenate(squares).reshape(2, -1).mean(axis=0))


def _irreducible(problem: Problem, candidate: Candidate, unit: FloatArray) -> float:
    """Return the mean square misfit due to the linear response to errors of single heights and radii.

    For the heights, the linear response uses the mean Jacobian over normal errors. The result is then the
    variance of the best linear function of the errors (Stein, Ann. Stat. 9, 1135 (1981),
    doi:10.1214/aos/1176345632). The Jacobian of the exact heights is unsuitable, because it has a jump where
    a contact opens. For the radii, the linear response is that of the exact heights, by finite differences.
    """
    surface, law = candidate.surface(problem.template), candidate.target_law
    solver, count = problem.model.gradient_model, surface.count
    total = np.zeros((len(law.load), count))
    for part, shift in _errors(problem.tolerances, surface, unit):
        found = solver.sensitivity(part, law.load, surface.height + shift)
        total += law.residual(found.curve.area, found.gradient)[1]
    response = problem.tolerances.height_sd * total / len(unit)
    squares = float((response**2).sum())
    if problem.tolerances.radius_sd > 0.0:
        step = problem.tolerances.radius_sd * np.eye(count)
        height = np.broadcast_to(surface.height, (2 * count, count))
        area = solver.areas(
            surface, law.load, height, np.concatenate([surface.radius + step, surface.radius - step])
        )
        high, low = np.split(area, 2)
        nominal = solver.areas(surface, law.load, height[:1])[0]
        squares += float((law.residual(nominal, 0.5 * (high - low).T)[1] ** 2).sum())
    return squares / len(law.load)
