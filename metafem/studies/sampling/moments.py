"""Means, deviations and quantiles from sums over batches, with their sampling errors.

For each quantity y the sums contain ``u = y/nominal - 1`` and its linear response c, with mean 0 and a known
variance V. With x = c/sqrt(V), each draw has the four numbers ``z = (u, u^2, x, x^2 - 1)``. The mean and the
second moment of u follow by regression on the last two, which have mean zero (control variates). Errors come
from the scatter of the batches' means, which are independent.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray, IntArray

# With fewer draws the sample means are used, without regression.
FEWEST_REGRESSED = 100

# Bins of the histogram of a slope m: equal steps of asinh((m/nominal - 1)/FINEST), up to 30 times the nominal
# slope. Near the nominal slope they are 1e-6 of it wide, elsewhere 1 % of the difference.
FINEST, FARTHEST, BINS = 1e-4, 30.0, 2600


class Estimate(NamedTuple):
    """An estimate and its standard sampling error, of one shape."""

    value: FloatArray
    error: FloatArray


@dataclass(frozen=True, eq=False)
class Sums:
    """Sums over draws and over batches, of quantities (q,) at levels (l,).

    `first` (l, q, 4) and `second` (l, q, 4, 4) are the sums over draws of z and of its products,
    `between_first` and `between_second` those over batches of the means of z. `count` and `failed` (l,) are
    the numbers of draws with and without a solution, `batches` (l,) of batches with a solution, `histogram`
    (l, BINS) of slopes in each bin.
    """

    count: IntArray
    failed: IntArray
    batches: IntArray
    first: FloatArray
    second: FloatArray
    between_first: FloatArray
    between_second: FloatArray
    histogram: IntArray

    @staticmethod
    def of(difference: FloatArray, response: FloatArray) -> dict[str, np.ndarray]:
        """Return the sums of one batch at one level, from u (m, q) and x (m, q); rows with nan have failed.

        The histogram is of the first quantity, the slope.
        """
        solved = np.isfinite(difference).all(axis=1)
        u, x = difference[solved], response[solved]
        z = np.stack([u, u * u, x, x * x - 1.0], axis=-1)
        position = np.arcsinh(u[:, 0] / FINEST) / np.arcsinh(FARTHEST / FINEST)
        bins = np.clip((0.5 * BINS * (1.0 + position)).astype(np.int64), 0, BINS - 1)
        return {
            "count": np.asarray(len(u)),
            "failed": np.asarray(len(difference) - len(u)),
            "first": z.sum(axis=0),
            "second": np.einsum("mqi,mqj->qij", z, z),
            "histogram": np.bincount(bins, minlength=BINS),
        }

    @staticmethod
    def of_batch(batch: dict[str, np.ndarray]) -> Sums:
        """Return the sums of one batch, stacked from the sums of its levels."""
        count = batch["count"]
        mean = batch["first"] / np.maximum(count, 1)[:, None, None]
        products = mean[..., :, None] * mean[..., None, :]
        return Sums(
            **batch, batches=(count > 0).astype(np.int64), between_first=mean, between_second=products
        )

    def plus(self, other: Sums) -> Sums:
        """Return the sums over both."""
        return Sums(**{f.name: getattr(self, f.name) + getattr(other, f.name) for f in fields(self)})


@dataclass(frozen=True, eq=False)
class Moments:
    """Moments of y/nominal - 1, (l, q), and for each the plain draws of equal error per draw used."""

    mean: Estimate
    sd: Estimate
    saving_of_mean: FloatArray
    saving_of_sd: FloatArray


def moments(sums: Sums, *, plain: bool = False) -> Moments:
    """Return means and standard deviations (l, q) with their errors; without control variates if `plain`.

    The errors of plain draws follow from the scatter of single draws.
    """
    count = np.maximum(sums.count, 1)[:, None, None]
    mean = sums.first / count
    within = sums.second / count[..., None] - mean[..., :, None] * mean[..., None, :]
    if plain:
        between, independent = within, np.maximum(sums.count - 1, 1)
    else:
        batches = np.maximum(sums.batches, 1)[:, None, None]
        middle = sums.between_first / batches
        between = sums.between_second / batches[..., None] - middle[..., :, None] * middle[..., None, :]
        independent = np.maximum(sums.batches - 1, 1)
    keep = _adjustment(within, np.zeros_like(sums.count) if plain else sums.count)
    shift, square = np.moveaxis((keep @ mean[..., None])[..., 0], -1, 0)
    scatter = keep @ between @ np.swapaxes(keep, -1, -2) / independent[:, None, None, None]
    # the square of the mean exceeds the square of the exact mean by the sampling variance
    sd = np.sqrt(np.maximum(square - shift**2 + scatter[..., 0, 0], 0.0))
    of_draws = within[..., :2, :2] / count[..., None]  # of the means of as many plain draws
    rate = np.stack([-shift, np.full_like(shift, 0.5)], axis=-1)
    rate /= np.where(sd > 0.0, sd, np.inf)[..., None]

    def errors(covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the standard errors of mean and standard deviation."""
        of_sd = np.einsum("lqi,lqij,lqj->lq", rate, covariance, rate)
        return np.sqrt(np.maximum(covariance[..., 0, 0], 0.0)), np.sqrt(np.maximum(of_sd, 0.0))

    found, usual = errors(scatter), errors(of_draws)
    saving = [
        np.divide(u**2, f**2, out=np.ones_like(f), where=f > 0.0) for f, u in zip(found, usual, strict=True)
    ]
    return Moments(Estimate(shift, found[0]), Estimate(sd, found[1]), *saving)


def _adjustment(within: FloatArray, count: IntArray) -> FloatArray:
    """Return the matrices (l, q, 2, 4) that map z to u and u^2 minus their regressions on the controls."""
    keep = np.zeros((*within.shape[:2], 2, 4))
    keep[..., 0, 0] = keep[..., 1, 1] = 1.0
    controls = within[..., 2:, 2:]
    # without linear response both controls are constant
    usable = (count[:, None] >= FEWEST_REGRESSED) & (controls[..., 0, 0] > 0.0)
    safe = np.where(usable[..., None, None], controls, np.eye(2))
    slopes = np.linalg.solve(safe, within[..., 2:, :2])
    keep[..., 2:] = np.where(usable[..., None, None], -np.swapaxes(slopes, -1, -2), 0.0)
    return keep


def quantiles(sums: Sums, probability: FloatArray) -> Estimate:
    """Return quantiles (l, p) of the slope over the nominal one, minus 1, with the errors of plain draws."""
    edges = FINEST * np.sinh(np.arcsinh(FARTHEST / FINEST) * np.linspace(-1.0, 1.0, BINS + 1))
    value, error = np.full((2, len(sums.count), len(probability)), np.nan)
    for level, (histogram, count) in enumerate(zip(sums.histogram, sums.count.tolist(), strict=True)):
        if count == 0:
            continue
        within = np.flatnonzero(histogram)
        used = slice(within[0], within[-1] + 2)  # the edges of the bins from the first to the last in use
        share = np.concatenate([[0.0], np.cumsum(histogram) / count])[used]
        half = np.sqrt(probability * (1.0 - probability) / count)
        value[level] = np.interp(probability, share, edges[used])
        above, below = (np.interp(probability + s * half, share, edges[used]) for s in (1.0, -1.0))
        error[level] = 0.5 * (above - below)
    return Estimate(value, error)
