"""Means, deviations and quantiles from sums over batches, with their sampling errors.

Each draw of a quantity y has the relative change ``u = y/nominal - 1``, and the linear response c of u, with
mean 0 and a known variance V. With x = c/sqrt(V), the sums contain the four numbers
``z = (u, u^2, x, x^2 - 1)`` of each draw. The mean and the second moment of u follow by regression on the
last two numbers, which have mean zero (control variates). The errors follow from the scatter of the means of
independent batches.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from metafem._validate import FloatArray

# With fewer draws than this, the sample means are used without regression.
FEWEST_REGRESSED = 100

# Histogram of the slope m over u = m/nominal - 1, from -FARTHEST to FARTHEST, with bins of equal width in
# asinh(u/FINEST). The bins are 1e-6 wide in u near the nominal slope, and 1 % of u elsewhere.
FINEST, FARTHEST, BINS = 1e-4, 30.0, 2600


# Sums for the quantities (q,). `count` and `failed` are the numbers of draws with and without a solution,
# and `batches` is the number of batches with a solution. `first` (q, 4) and `second` (q, 4, 4) are the sums
# of z and of its products over all draws. `between_first` and `between_second` are the sums of the batch
# means of z and of their products over all batches. `histogram` (BINS,) has the number of slopes in each bin.
Sums = dict[str, np.ndarray]


class Estimate(NamedTuple):
    """An estimate and its standard sampling error, of the same shape."""

    value: Any
    error: Any


class Moments(NamedTuple):
    """Mean and standard deviation of y/nominal - 1, (2, q), their errors, and savings.

    The saving is the number of plain random draws that one draw replaces at the same error.
    """

    value: FloatArray
    error: FloatArray
    saving: FloatArray


def sums_of(difference: FloatArray, response: FloatArray) -> Sums:
    """Return the sums of one batch, from u (m, q) and x (m, q); draws with nan count as failed.

    The histogram counts the first quantity, the slope.
    """
    solved = np.isfinite(difference).all(axis=1)
    u, x = difference[solved], response[solved]
    z = np.stack([u, u * u, x, x * x - 1.0], axis=-1)
    position = np.arcsinh(u[:, 0] / FINEST) / np.arcsinh(FARTHEST / FINEST)
    bins = np.clip((0.5 * BINS * (1.0 + position)).astype(np.int64), 0, BINS - 1)
    first, count = z.sum(axis=0), len(u)
    mean = first / max(count, 1)
    return {
        "count": np.asarray(count),
        "failed": np.asarray(len(difference) - count),
        "batches": np.asarray(int(count > 0)),
        "first": first,
        "second": np.einsum("mqi,mqj->qij", z, z),
        "between_first": mean,
        "between_second": mean[..., :, None] * mean[..., None, :],
        "histogram": np.bincount(bins, minlength=BINS),
    }


def added(total: Sums, batch: Sums) -> Sums:
    """Return a total with the sums of a batch added; the total is empty before the first batch."""
    return {name: total.get(name, 0) + batch[name] for name in batch}


def moments(sums: Sums, *, plain: bool = False) -> Moments:
    """Return mean and standard deviation with their errors; without control variates if `plain`.

    If `plain`, the errors follow from the scatter of single draws instead of batches.
    """
    count = max(int(sums["count"]), 1)
    mean, within = _centred(sums["first"], sums["second"], count)
    if plain:
        between, independent = within, max(count - 1, 1)
    else:
        batches = max(int(sums["batches"]), 1)
        between = _centred(sums["between_first"], sums["between_second"], batches)[1]
        independent = max(batches - 1, 1)
    keep = _adjustment(within, 0 if plain else count)
    shift, square = (keep @ mean[..., None])[..., 0].T
    scatter = keep @ between @ np.swapaxes(keep, -1, -2) / independent
    # correct a bias: on average, the square of the sample mean exceeds that of the exact mean by its variance
    sd = np.sqrt(np.maximum(square - shift**2 + scatter[..., 0, 0], 0.0))
    rate = np.stack([-shift, np.full_like(shift, 0.5)], axis=-1)
    rate /= np.where(sd > 0.0, sd, np.inf)[..., None]
    found, usual = (
        np.sqrt(np.maximum([each[..., 0, 0], np.einsum("qi,qij,qj->q", rate, each, rate)], 0.0))
        for each in (scatter, within[..., :2, :2] / count)  # usual: of as many plain draws
    )
    saving = np.divide(usual**2, found**2, out=np.ones_like(found), where=found > 0.0)
    return Moments(np.array([shift, sd]), found, saving)


def _centred(first: FloatArray, second: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Return means (q, 4) and covariances (q, 4, 4) from sums."""
    mean = first / count
    return mean, second / count - mean[..., :, None] * mean[..., None, :]


def _adjustment(within: FloatArray, count: int) -> FloatArray:
    """Return the matrices (q, 2, 4) from z to u and u^2 minus their regressions on the control variates."""
    keep = np.zeros((len(within), 2, 4))
    keep[:, 0, 0] = keep[:, 1, 1] = 1.0
    controls = within[:, 2:, 2:]
    # without a linear response, both control variates are constant
    usable = (count >= FEWEST_REGRESSED) & (controls[:, 0, 0] > 0.0)
    keep[usable, :, 2:] = -np.swapaxes(np.linalg.solve(controls[usable], within[usable, 2:, :2]), -1, -2)
    return keep


def quantiles(sums: Sums, probability: FloatArray) -> Estimate:
    """Return quantiles (p,) of slope/nominal - 1, with the errors that plain random draws would have."""
    edges = FINEST * np.sinh(np.arcsinh(FARTHEST / FINEST) * np.linspace(-1.0, 1.0, BINS + 1))
    within, count = np.flatnonzero(sums["histogram"]), int(sums["count"])
    used = slice(within[0], within[-1] + 2)  # edges from the first to the last bin in use
    share = np.concatenate([[0.0], np.cumsum(sums["histogram"]) / count])[used]
    half = np.sqrt(probability * (1.0 - probability) / count)
    below, value, above = (np.interp(probability + s * half, share, edges[used]) for s in (-1.0, 0.0, 1.0))
    return Estimate(value, 0.5 * (above - below))
