"""Illumination of an image: a smooth surface through the grey levels of the ground between the contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from metafem._validate import FloatArray

# Degree of the polynomial in each coordinate: a tilt, and a lamp or a lens that is darker towards the
# corners.
DEGREE = 2

# Blocks of the coarse grid along the shorter side, their least size [pixels], and pixels that are read along
# each side of a block.
BLOCKS, LEAST_BLOCK, READ = 96, 4, 7

# Largest distance of a block of the ground from the surface, in standard deviations; rounds of the fit.
CLIPPED, ROUNDS = 3.0, 12

# Smallest share of the blocks for a fit.
ENOUGH = 0.03

# Weight of the blocks on the bright side of the surface in its initial guess. It admits contacts that cover
# two thirds of the image.
WEIGHT = 50.0

# Median absolute deviation of a normal distribution over its standard deviation.
MAD = 0.6745

# Smallest grey level of the ground over the contrast for a division by the ground; in a dark field it is
# smaller. Grey levels below zero by more than this share of the ground, or a ground below its square, are not
# intensities.
FAINT = 0.2


@dataclass(frozen=True)
class Ground:
    """The ground of an image.

    `corrected` is the image with the illumination removed: 1 on the ground, and smaller in the contacts.
    `span` is the range of its blocks, wider by itself on both sides: single bad pixels lie outside of it.
    `structure` is the standard deviation of the residual of the polynomial, on the scale of a block.
    `divided` states whether the image was divided by the ground; otherwise the ground was subtracted.
    """

    corrected: NDArray[np.float32]
    structure: float
    level: float
    divided: bool
    span: tuple[float, float]

    def otsu(self) -> float:
        """Return Otsu's threshold of the corrected image."""
        return otsu(np.clip(self.corrected, *self.span))


def without_illumination(image: NDArray[np.float32], bright_contacts: bool) -> Ground:
    """Return the image over its ground, inverted if the contacts are bright.

    The ground is a polynomial of degree 2 in each coordinate, fitted to the interquartile means of blocks;
    the blocks that hold contacts are left out by clipping.
    """
    grid, error, y, x = _blocks(image)
    sign = -1.0 if bright_contacts else 1.0
    terms = np.asarray(legendre.legvander2d(y, x, [DEGREE, DEGREE]), dtype=np.float64)
    above = sign * (grid.ravel() - terms @ _envelope(terms, grid.ravel(), sign))
    # the first guess is better for large gradients, the second for large contacts
    guesses = [sign * grid, above.reshape(grid.shape)]
    fits = [_fitted(terms, grid, sign, _brighter(guess, error), error) for guess in guesses]
    coefficients, on_ground, scale = min(fits, key=lambda fit: fit[2])
    residual = grid - (terms @ coefficients).reshape(grid.shape)
    structure = _structure(np.where(on_ground, residual, np.nan), error)
    rows, columns = (
        legendre.legvander(_scaled(np.arange(n, dtype=np.float64) + 0.5, n), DEGREE) for n in image.shape
    )
    ground = (rows @ coefficients.reshape(DEGREE + 1, -1) @ columns.T).astype(np.float32)
    level, least = float(coefficients[0]), float(ground.min())
    contrast = float(np.abs(residual).max())
    if bright_contacts:
        divided = least > FAINT * contrast
    else:
        negative = (grid < -CLIPPED * error - FAINT * (grid - residual)).any()
        divided = least > FAINT**2 * level and not negative
    surface = grid - residual
    if divided:
        corrected, blocks, scale = image / ground, grid / surface, abs(level)
    else:
        scale = contrast or 1.0
        corrected, blocks = 1.0 + (image - ground) / np.float32(scale), 1.0 + residual / scale
    if bright_contacts:
        corrected, blocks = 2.0 - corrected, 2.0 - blocks
    low, high = float(blocks.min()), float(blocks.max())
    span = (2.0 * low - high, 2.0 * high - low)
    return Ground(corrected, structure / scale, level, divided, span)


def _brighter(guess: FloatArray, error: float) -> NDArray[np.bool_]:
    """Return which blocks are ground by Otsu's threshold; all, if they differ only by noise."""
    return guess >= (otsu(guess) if np.ptp(guess) > CLIPPED * error else -np.inf)


def _fitted(
    terms: FloatArray, grid: FloatArray, sign: float, bright: NDArray[np.bool_], error: float
) -> tuple[FloatArray, NDArray[np.bool_], float]:
    """Return coefficients, the blocks they were fitted to, and the standard deviation of these blocks."""
    on_ground = _clear_of(~bright)
    for _ in range(ROUNDS):
        used = terms[on_ground.ravel()]
        coefficients = np.linalg.solve(used.T @ used, used.T @ grid[on_ground])
        height = sign * (grid - (terms @ coefficients).reshape(grid.shape))
        # blocks on the side of the surface opposite to the contacts are ground
        beyond = height[on_ground & (height > 0.0)]
        scale = float(max(np.median(beyond) / MAD if beyond.size else 0.0, error))
        now = _clear_of(height < -CLIPPED * scale) & (height < 2.0 * CLIPPED * scale)
        if np.array_equal(now, on_ground) or now.sum() < 2 * terms.shape[1]:
            break
        on_ground = now
    return np.asarray(coefficients, dtype=np.float64), on_ground, scale


def otsu(values: NDArray[Any]) -> float:
    """Return Otsu's threshold."""
    from skimage.filters import threshold_otsu

    return float(threshold_otsu(values))  # type: ignore[no-untyped-call]


def _envelope(terms: FloatArray, levels: FloatArray, sign: float) -> FloatArray:
    """Return the coefficients of a surface near the blocks that are least like contacts: an expectile.

    The blocks on one side of it have larger weights.
    """
    weight = np.ones(levels.size)
    for _ in range(ROUNDS):
        normal = terms.T * weight
        coefficients = np.linalg.solve(normal @ terms, normal @ levels)
        weight = np.where(sign * (levels - terms @ coefficients) > 0.0, WEIGHT, 1.0)
    return np.asarray(coefficients, dtype=np.float64)


def _clear_of(dark: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which blocks are not dark and, if enough blocks remain, have no dark neighbour."""
    clear = ~binary_dilation(dark, np.ones((3, 3)))
    enough = np.count_nonzero(clear) >= ENOUGH * dark.size
    return np.asarray(clear if enough else ~dark)


def _structure(residual: FloatArray, error: float) -> float:
    """Return the standard deviation of residuals, nan in contacts, without the noise of single blocks.

    The noise of neighbouring blocks is independent, so the mean product of their residuals is free of it. Its
    own error is subtracted.
    """
    products = np.concatenate(
        [(residual[:, 1:] * residual[:, :-1]).ravel(), (residual[1:] * residual[:-1]).ravel()]
    )
    products = products[~np.isnan(products)]
    if not products.size:
        return 0.0
    return math.sqrt(max(float(products.mean()) - 2.0 * error**2 / math.sqrt(products.size), 0.0))


def _scaled(pixel: FloatArray, count: int) -> FloatArray:
    """Return coordinates from -1 to 1."""
    return 2.0 * pixel / count - 1.0


def _blocks(image: NDArray[np.float32]) -> tuple[FloatArray, float, FloatArray, FloatArray]:
    """Return the grey levels of blocks, their standard error from noise, and the centres of the blocks."""
    size = max(min(image.shape) // BLOCKS, LEAST_BLOCK)
    step = max(size // READ, 1)
    rows, columns = (n // size for n in image.shape)
    cut = image[: rows * size, : columns * size].reshape(rows, size, columns, size)[:, ::step, :, ::step]
    values = np.sort(cut.transpose(0, 2, 1, 3).reshape(rows * columns, -1), axis=1).astype(np.float64)
    count = values.shape[1]
    low = count // 4
    middle = values[:, low : count - low]
    levels = middle.mean(axis=1)
    # the interquartile range of a normal distribution is 2 MAD standard deviations; the interquartile mean of
    # many values has 1.1 times the standard error of their mean
    noise = np.median(values[:, count - 1 - low] - values[:, low]) / (2.0 * MAD)
    y, x = np.meshgrid(
        _scaled((np.arange(rows) + 0.5) * size, image.shape[0]),
        _scaled((np.arange(columns) + 0.5) * size, image.shape[1]),
        indexing="ij",
    )
    return levels.reshape(rows, columns), float(1.1 * noise / np.sqrt(count)), y.ravel(), x.ravel()
