"""Sums over the sites of a bounded lattice by fast Fourier transforms.

The lattice is padded with zeros to at least twice its size, so that the cyclic convolutions equal the sums.
The zeros and the unused half of a result are not computed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.sums.fourier import halved, padded


class Plan(NamedTuple):
    """Sites of a lattice, roots of unity, and transforms of the influence with their scale.

    The lattice is padded to numbers of rows and columns that are multiples of 4 and have no prime factor
    above 5. The transforms of even functions are real, those of the slopes imaginary; only their real or
    imaginary parts are given, (rows * (columns/2 + 1),).
    """

    at: np.ndarray  # index of each site in the array of pairs of rows, (n,)
    odd: np.ndarray  # whether its row is the second one of the pair, (n,)
    row_root: np.ndarray  # of the padded number of rows, see `fourier`
    column_root: np.ndarray  # of the padded number of columns
    influence: np.ndarray
    laplacian: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray


@compiled
def transform(plan, source):
    """Return the real and imaginary parts of twice the transform of sources (n,) on the padded lattice.

    They are (rows * (columns/2 + 1),) each, for the padded numbers of rows and columns.
    """
    rows, columns, bins = (
        plan.row_root.shape[1],
        plan.column_root.shape[1],
        plan.column_root.shape[1] // 2 + 1,
    )
    pairs = rows // 4
    size = max(rows * bins, columns * pairs)
    re, im, other_re, other_im = np.zeros(size), np.zeros(size), np.empty(size), np.empty(size)
    # two rows of the lattice are one complex row: transposed, for transforms over the columns
    for i in range(source.size):
        if plan.odd[i]:
            im[plan.at[i]] = source[i]
        else:
            re[plan.at[i]] = source[i]
    re, im, other_re, other_im = padded(columns, pairs, plan.column_root, re, im, other_re, other_im)
    for k in range(bins):
        one, two = k * pairs, (columns - k) % columns * pairs
        for i in range(pairs):
            a, b, c, d = re[one + i], im[one + i], re[two + i], im[two + i]
            even = 2 * i * bins + k
            other_re[even], other_im[even] = a + c, b - d
            other_re[even + bins], other_im[even + bins] = b + d, c - a
    re, im, _, _ = padded(rows, bins, plan.row_root, other_re, other_im, re, im)
    return re, im


@compiled
def back(plan, re, im):
    """Return the values at the sites (n,) of a transform, which is overwritten; scaled by rows * columns."""
    rows, columns, bins = (
        plan.row_root.shape[1],
        plan.column_root.shape[1],
        plan.column_root.shape[1] // 2 + 1,
    )
    pairs = rows // 4
    # exchanging real and imaginary parts inverts a transform
    im, re, other_im, other_re = halved(
        rows, bins, plan.row_root, im, re, np.empty(re.size), np.empty(re.size)
    )
    for k in range(bins):
        one, two = k * pairs, (columns - k) % columns * pairs
        for i in range(pairs):
            even = 2 * i * bins + k
            a, b, c, d = re[even], im[even], re[even + bins], im[even + bins]
            other_re[two + i], other_im[two + i] = a + d, c - b
            other_re[one + i], other_im[one + i] = a - d, b + c
    im, re, _, _ = halved(columns, pairs, plan.column_root, other_im, other_re, im, re)
    found = np.empty(plan.at.size)
    for i in range(found.size):
        found[i] = im[plan.at[i]] if plan.odd[i] else re[plan.at[i]]
    return found


@compiled
def field(plan, load_re, load_im):
    """Return the Laplacian and the two slopes of the displacement at the sites, for transformed loads."""
    size = plan.influence.size
    re, im = np.empty(load_re.size), np.empty(load_re.size)
    for q in range(size):
        re[q], im[q] = plan.laplacian[q] * load_re[q], plan.laplacian[q] * load_im[q]
    laplacian = back(plan, re, im)
    for q in range(size):  # the derivative at the displaced end is the opposite of that at the source
        re[q], im[q] = plan.slope_x[q] * load_im[q], -plan.slope_x[q] * load_re[q]
    x = back(plan, re, im)
    for q in range(size):
        re[q], im[q] = plan.slope_y[q] * load_im[q], -plan.slope_y[q] * load_re[q]
    return laplacian, x, back(plan, re, im)


@compiled
def displacement(plan, load_re, load_im):
    """Return the displacements at the sites (n,) by transformed loads."""
    re, im = np.empty(load_re.size), np.empty(load_re.size)
    for q in range(plan.influence.size):
        re[q], im[q] = plan.influence[q] * load_re[q], plan.influence[q] * load_im[q]
    return back(plan, re, im)


@compiled
def displacement_of_all(plan, load_re, load_im, size, x, y):
    """Return the displacements at the sites (n,) by transformed loads, by sizes and by moments (n,) each."""
    total_re, total_im = np.empty(load_re.size), np.empty(load_re.size)
    re, im = transform(plan, size)
    for q in range(plan.influence.size):
        total_re[q] = plan.influence[q] * load_re[q] + plan.laplacian[q] * re[q]
        total_im[q] = plan.influence[q] * load_im[q] + plan.laplacian[q] * im[q]
    re, im = transform(plan, x)
    for q in range(plan.influence.size):
        total_re[q] -= plan.slope_x[q] * im[q]
        total_im[q] += plan.slope_x[q] * re[q]
    re, im = transform(plan, y)
    for q in range(plan.influence.size):
        total_re[q] -= plan.slope_y[q] * im[q]
        total_im[q] += plan.slope_y[q] * re[q]
    return back(plan, total_re, total_im)
