"""Correction of the illumination: a smooth surface is fitted to the grey levels between the contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from metafem._validate import FloatArray

# Degree of the polynomial in each coordinate. Degree 2 describes a gradient, and a lamp or lens that is
# darker towards the corners.
DEGREE = 2

# Number of blocks along the shorter side of the image, smallest size of a block [pixels], and number of
# pixels that are read along each side of a block.
BLOCKS, LEAST_BLOCK, READ = 96, 4, 7

# Largest distance between a block of the ground and the surface, in standard deviations. Largest number of
# iterations.
CLIPPED, ROUNDS = 3.0, 12

# Smallest share of the blocks for a fit.
ENOUGH = 0.03

# Weight of the blocks on the bright side of the surface in the initial guess. With this weight, contacts may
# cover up to two thirds of the image.
WEIGHT = 50.0

# Ratio of the median absolute deviation to the standard deviation of a normal distribution.
MAD = 0.6745

# Limit for the division of an image by its ground. An image with bright contacts is divided if the grey level
# of the ground exceeds FAINT times the contrast, which is not the case in a dark field. An image with dark
# contacts is divided unless grey levels lie below zero by more than FAINT times the ground, or the ground
# lies below FAINT² times its mean level.
FAINT = 0.2


@dataclass(frozen=True)
class Ground:
    """Image with corrected illumination, and properties of its ground.

    `corrected` is the image without the illumination: 1 on the ground, and smaller in the contacts.
    `structure` is the standard deviation of the residuals of the polynomial, on the scale of a block. `level`
    is the mean grey level of the ground. `divided` states whether the image was divided by the ground;
    otherwise the ground was subtracted. `span` is the range of the corrected blocks, extended by its own
    width at both ends; bad pixels lie outside of it.
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
    """Return the image with corrected illumination, inverted if the contacts are bright.

    The ground is a polynomial of degree 2 in each coordinate. It is fitted to the interquartile means of
    blocks; clipping excludes the blocks that contain contacts.
    """
    grid, error, y, x = _blocks(image)
    sign = -1.0 if bright_contacts else 1.0
    terms = np.asarray(legendre.legvander2d(y, x, [DEGREE, DEGREE]), dtype=np.float64)
    above = sign * (grid.ravel() - terms @ _envelope(terms, grid.ravel(), sign))
    # neither initial guess suits both large gradients and large contacts, so the better of two fits is used
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
    """Return which blocks Otsu's threshold assigns to the ground; all blocks if they differ only by noise."""
    return guess >= (otsu(guess) if np.ptp(guess) > CLIPPED * error else -np.inf)


def _fitted(
    terms: FloatArray, grid: FloatArray, sign: float, bright: NDArray[np.bool_], error: float
) -> tuple[FloatArray, NDArray[np.bool_], float]:
    """Return the coefficients of the ground, a mask of the fitted blocks, and their standard deviation."""
    on_ground = _clear_of(~bright)
    for _ in range(ROUNDS):
        used = terms[on_ground.ravel()]
        coefficients = np.linalg.solve(used.T @ used, used.T @ grid[on_ground])
        height = sign * (grid - (terms @ coefficients).reshape(grid.shape))
        # contacts lie on one side of the surface, so blocks on the other side are ground
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
    """Return the coefficients of a surface near the blocks that differ most from contacts (an expectile).

    Blocks on the bright side, or for bright contacts on the dark side, have larger weights.
    """
    weight = np.ones(levels.size)
    for _ in range(ROUNDS):
        normal = terms.T * weight
        coefficients = np.linalg.solve(normal @ terms, normal @ levels)
        weight = np.where(sign * (levels - terms @ coefficients) > 0.0, WEIGHT, 1.0)
    return np.asarray(coefficients, dtype=np.float64)


def _clear_of(dark: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which blocks are not dark and, if enough such blocks exist, have no dark neighbour."""
    clear = ~binary_dilation(dark, np.ones((3, 3)))
    enough = np.count_nonzero(clear) >= ENOUGH * dark.size
    return np.asarray(clear if enough else ~dark)


def _structure(residual: FloatArray, error: float) -> float:
    """Return the standard deviation of residuals (nan in contacts) without the noise of single blocks.

    Neighbouring blocks have independent noise, so the noise cancels in the mean product of their residuals.
    The error of this mean is subtracted.
    """
    products = np.concatenate(
        [(residual[:, 1:] * residual[:, :-1]).ravel(), (residual[1:] * residual[:-1]).ravel()]
    )
    products = products[~np.isnan(products)]
    if not products.size:
        return 0.0
    return math.sqrt(max(float(products.mean()) - 2.0 * error**2 / math.sqrt(products.size), 0.0))


def _scaled(pixel: FloatArray, count: int) -> FloatArray:
    """Return pixel coordinates scaled to the range -1 to 1."""
    return 2.0 * pixel / count - 1.0


def _blocks(image: NDArray[np.float32]) -> tuple[FloatArray, float, FloatArray, FloatArray]:
    """Return the grey levels of blocks, the standard error of a level, and the blocks' y and x centres."""
    size = max(min(image.shape) // BLOCKS, LEAST_BLOCK)
    step = max(size // READ, 1)
    rows, columns = (n // size for n in image.shape)
    cut = image[: rows * size, : columns * size].reshape(rows, size, columns, size)[:, ::step, :, ::step]
    values = np.sort(cut.transpose(0, 2, 1, 3).reshape(rows * columns, -1), axis=1).astype(np.float64)
    count = values.shape[1]
    low = count // 4
    middle = values[:, low : count - low]
    levels = middle.mean(axis=1)
    # The interquartile range of a normal distribution is 2 MAD standard deviations. The standard error of an
    # interquartile mean of many values is 1.1 times the standard error of their mean.
    noise = np.median(values[:, count - 1 - low] - values[:, low]) / (2.0 * MAD)
    y, x = np.meshgrid(
        _scaled((np.arange(rows) + 0.5) * size, image.shape[0]),
        _scaled((np.arange(columns) + 0.5) * size, image.shape[1]),
        indexing="ij",
    )
    return levels.reshape(rows, columns), float(1.1 * noise / np.sqrt(count)), y.ravel(), x.ravel()
