"""Influence between the sites of a block, from solutions on a quarter of the block."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.fe.block3d.cache import BlockInfluence
from metafem.fe.block3d.elasticity import Quarter
from metafem.fe.block3d.grading import quarter_lines
from metafem.progress import each
from metafem.surface import Block

# Cell size of the second mesh, which serves the error estimate, over that of the first mesh.
COARSER = 1.6

# Step of the finite differences, over the distance from the site to the nearest face of the block. The field
# is analytic within this distance. The relative errors in the Laplacian are 2e-5 by truncation and 1e-11 by
# rounding.
STEP = 0.02

# Signs of a load's mirror images in x = 0 and in y = 0.
PARITIES = ((1, 1), (1, -1), (-1, 1), (-1, -1))

# Number of positions evaluated at once; the fields on the faces of the largest mesh then take 100 MB.
MOST_PLACES = 256

# Positions closer than this fraction of the thickness are treated as one position.
SAME = 1e-12


def site_influence(
    block: Block, poisson_ratio: float, position: FloatArray, cell: float, edge_cell: float
) -> BlockInfluence:
    """Return the influence between sites (n, 2) [mm], computed on two meshes; see `Block3D`."""
    lines, stretch = quarter_lines(block, position, cell, edge_cell)
    coarser = COARSER * stretch
    fewer, _ = quarter_lines(block, position, coarser * cell, coarser * edge_cell)
    ((value, *slopes), residual), (coarse, other) = (
        _remainder(block, poisson_ratio, position, mesh) for mesh in each("mesh", (lines, fewer))
    )
    dx, dy = (position[:, None] - position).transpose(2, 0, 1)
    r = np.hypot(dx, dy)
    np.fill_diagonal(r, math.inf)
    point = 1.0 / (math.pi * r)
    return BlockInfluence(
        matrix=point + 0.5 * (value + value.T),
        gradient_x=slopes[0] - point * dx / r**2,
        gradient_y=slopes[1] - point * dy / r**2,
        laplacian=slopes[2] + point / r**2,
        asymmetry=float(np.abs(value - value.T).max()),
        error_estimate=float(np.abs(value - coarse[0]).max()),
        residual=max(residual, other),
        notes=(f"cells are {stretch:.3g} times as large as stated, to limit their number",)
        if stretch > 1.0
        else (),
    )


def _remainder(
    block: Block, poisson_ratio: float, position: FloatArray, lines: list[FloatArray]
) -> tuple[FloatArray, float]:
    """Return value, gradient and Laplacian of w between sites, (4, n, n), and the residual.

    For each of the four parities, the load and its three mirror images with the signs of the parity are
    applied together. A single load is a quarter of the sum over the parities.
    """
    quarter = Quarter.on(lines, poisson_ratio)
    folded = np.abs(position)
    square = block.width == block.length
    if square:  # append the sites mirrored in the diagonal
        folded = np.concatenate([folded, folded[:, ::-1]])
    site, orbit = _distinct(folded, SAME * block.thickness)
    step = STEP * np.minimum(0.5 * np.array([block.width, block.length]) - site, block.thickness).min(axis=1)
    own, turned = orbit[: len(position)], orbit[-len(position) :]
    side = np.where(position < 0.0, -1.0, 1.0)
    total, worst = np.zeros((4, len(position), len(position))), 0.0
    # in a square block, the parity (-1, 1) is (1, -1) with x and y exchanged
    solved = [parity for parity in PARITIES if not (square and parity == (-1, 1))]
    for parity in each("load case", solved):
        result, residual = _parity_remainder(quarter, parity, site, step)
        worst = max(worst, residual)
        total += _unfolded(result, own, side, parity)
        if square and parity == (1, -1):
            mirrored = result[[0, 2, 1, 3]]
            total += _unfolded(mirrored, turned, side, (-1, 1))
    return total, worst


def _distinct(site: FloatArray, same: float) -> tuple[FloatArray, IntArray]:
    """Return the distinct positions, and the index of each position among them."""
    _, first, orbit = np.unique(np.rint(site / same), axis=0, return_index=True, return_inverse=True)
    return site[first], orbit


def _parity_remainder(
    quarter: Quarter, parity: tuple[int, int], site: FloatArray, step: FloatArray
) -> tuple[FloatArray, float]:
    """Return value, gradient and Laplacian of w under mirrored loads, (4, m, m), and the residual."""
    offset = np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
    points = (site + offset[:, None] * step[:, None]).reshape(-1, 2)
    field = quarter.solve(parity, site)
    parts = np.array_split(points, -(-len(points) // MOST_PLACES))
    values = np.concatenate([quarter.influence(field, part) for part in parts])
    w, east, west, north, south = values.reshape(5, len(site), -1)
    h = step[:, None]
    slopes = (east - west) / (2.0 * h), (north - south) / (2.0 * h)
    return np.stack([w, *slopes, (east + west + north + south - 4.0 * w) / h**2]), field.residual


def _unfolded(result: FloatArray, orbit: IntArray, side: FloatArray, parity: tuple[int, int]) -> FloatArray:
    """Return the contribution of one parity to the influence, from its values at folded positions."""
    sign = np.prod(np.where(np.array(parity) < 0, side, 1.0), axis=1)
    part = np.asarray(0.25 * result[:, orbit[:, None], orbit] * sign[:, None] * sign)
    part[1] *= side[:, :1]
    part[2] *= side[:, 1:]
    return part
