"""Gaussian posterior of the unknowns by linear updates, repeated until they converge.

The prior of the unknowns z is the standard normal distribution. Measured values have Gaussian errors. The
indentation of a contact that was found open is at most 0. This step function in the likelihood is replaced by
the Gaussian factor that gives the same mean and variance of the indentation (expectation propagation; Minka,
Proc. 17th Conf. Uncertainty in Artificial Intelligence, 362 (2001), arXiv:1301.2294).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import erfcx, log_ndtr

from metafem._validate import FloatArray
from metafem.calibration.diagnosis.linearised import Linear

# The update ends when no mean changes by more than this fraction of its standard deviation.
STILL = 1e-4

# Number of full steps, and largest number of steps. After the full steps, the damping increases with each
# step.
FULL_STEPS, MOST_STEPS = 15, 60

# Largest change of an unknown in one step, in prior standard deviations.
LONGEST = 10.0

# Fraction of the computed change of the Gaussian factors that one step applies.
DAMPING = 0.7

# Gap of an open contact, in standard deviations, beyond which the contact has no effect on the posterior.
FAR = 8.0

# A posterior has converged if its last step is below this number of standard deviations. If a contact
# alternately opens and closes, the steps do not vanish, but steps below this bound hardly change an interval.
NEARLY = 0.1


@dataclass(frozen=True, eq=False)
class Posterior:
    """Mean (p,) and covariance (p, p) of the unknowns, and the residuals at the mean."""

    mean: FloatArray
    covariance: FloatArray
    linear: Linear  # at the mean
    log_evidence: float
    change: float  # size of the last step, in standard deviations


def update(linear: Callable[[FloatArray, FloatArray], Linear], size: int) -> Posterior:
    """Return the posterior of `size` unknowns, with residuals linearised at the posterior mean."""
    mean, covariance, log_open, least = np.zeros(size), np.eye(size), 0.0, math.inf
    factors = np.zeros((2, 0))
    for step in range(MOST_STEPS):
        at = linear(mean, covariance)
        if step == 0:
            factors = np.zeros((2, len(at.indentation)))
        precision_open, shift_open = factors
        cost = float(0.5 * (at.residual @ at.residual + mean @ mean) - log_open)
        gradient, gap_gradient = at.gradient, at.indentation_gradient
        precision = gradient.T @ gradient + np.eye(size)
        precision += (gap_gradient.T * precision_open) @ gap_gradient
        # Newton step from the current mean
        force = gradient.T @ at.residual - mean
        force += gap_gradient.T @ (shift_open - precision_open * at.indentation)
        factor = cho_factor(precision, lower=True)
        if step == 0 or (step >= FULL_STEPS and cost < least):
            least = cost if step else math.inf
            best = mean, factor, log_open
        move, covariance = cho_solve(factor, force), cho_solve(factor, np.eye(size))
        whole = float((np.abs(move) / np.sqrt(np.diag(covariance))).max())
        move *= min(1.0, LONGEST / max(float(np.abs(move).max()), 1e-300))
        move *= 1.0 if step < FULL_STEPS else FULL_STEPS / (step + 1.0)
        new, log_open = _factors(at, move, covariance, factors)
        moved = np.abs(new[0] - precision_open).max(initial=0.0) / (1.0 + precision_open.max(initial=0.0))
        factors = factors + DAMPING * (new - factors)
        mean = mean + move
        change = max(whole, float(moved))
        if change <= STILL:
            break
    if change > NEARLY:  # an adhesive contact alternately closes and opens
        mean, factor, log_open = best
        covariance = cho_solve(factor, np.eye(size))
    at = linear(mean, covariance)
    log_det = 2.0 * float(np.log(np.diag(factor[0])).sum())
    log_evidence = log_open - 0.5 * (at.residual @ at.residual + mean @ mean + log_det)
    log_evidence -= float(np.log(at.sd).sum()) + 0.5 * len(at.sd) * math.log(2.0 * math.pi)
    return Posterior(mean, covariance, at, float(log_evidence), change)


def _factors(
    at: Linear, move: FloatArray, covariance: FloatArray, factors: FloatArray
) -> tuple[FloatArray, float]:
    """Return precision and shift (2, c) of factors ``exp(-precision g^2 / 2 + shift g)``, and a logarithm.

    Each open contact has one factor. The last value is the logarithm of the product of the normalised factors
    at the mean of the indentations g.
    """
    gradient = at.indentation_gradient
    mean = at.indentation + gradient @ move
    variance = ((gradient @ covariance) * gradient).sum(axis=1)
    active = mean > -FAR * np.sqrt(variance)
    new = np.zeros_like(factors)
    if not active.any():
        return new, 0.0
    g, v, (tau, nu) = mean[active], variance[active], factors[:, active]
    # variance and mean of the distribution without the contact's own factor
    without = 1.0 / np.maximum(1.0 / v - tau, 1e-6 / v)
    centre = without * (g / v - nu)
    width = np.sqrt(without + at.resolution[active] ** 2)
    u = -centre / width
    log_mass = log_ndtr(u)
    ratio = math.sqrt(2.0 / math.pi) / erfcx(-u / math.sqrt(2.0))  # n(u)/N(u), accurate for every u
    matched = centre - without * ratio / width
    narrowed = without - (without / width) ** 2 * ratio * (ratio + u)
    narrowed = np.clip(narrowed, 1e-9 * without, without)
    tau, nu = 1.0 / narrowed - 1.0 / without, matched / narrowed - centre / without
    new[:, active] = tau, nu
    rest = 0.5 * ((centre / without + nu) ** 2 / (1.0 / without + tau) - centre**2 / without)
    log = log_mass + 0.5 * np.log1p(tau * without) - rest - 0.5 * tau * g**2 + nu * g
    return new, float(log.sum())
