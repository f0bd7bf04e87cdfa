"""Threshold of an image, dark level of the contacts and blur of their edges."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, distance_transform_edt, find_objects, gaussian_filter, label
from scipy.special import chndtr

from metafem._validate import FloatArray
from metafem.calibration.images.boundary import Contours, at_edge, contours, pixels_of, single
from metafem.calibration.images.errors import EDGE_CURVATURE, EDGE_INTERPOLATION
from metafem.calibration.images.illumination import MAD, Ground
from metafem.errors import InvalidInput

# Smallest standard deviation of the smoothing [pixels], because pixels do not resolve narrower kernels. It is
# also used before the blur is known.
LEAST_SMOOTHING = 1.0

# Number of standard deviations at which the smoothing kernel is truncated. The truncation is included in the
# variance.
CUT_OFF = 3.0

# Largest number of contacts used for the levels, and the smallest ratio of their depth to the largest depth.
# The depth of a contact is the distance from its edge to its deepest pixel.
MOST, AS_DEEP = 64, 0.5

# Depth [pixels] beyond which a contact shows its dark level: four standard deviations of an edge after a blur
# of 1.5 pixels and the first smoothing. Number of corrections if contacts have no pixels at this depth.
CORE, ROUNDS = 7.0, 3

# Smallest depth, in standard deviations of the smoothed edge, at which a contact shows its dark level.
DEEP = 3.0

# Distance between pixels with nearly independent noise in a smoothed image, in standard deviations of the
# smoothing; the correlation is exp(-9/4), about 0.1. Smallest number of pairs of blocks that determine the
# noise.
INDEPENDENT, PAIRS = 3.0, 100

# Error of the blur if it cannot be measured [pixels]; typical optics have a blur of 0.5 to 2 pixels.
UNKNOWN_BLUR = 0.5

# Otsu's threshold is invalid (within the noise of the ground) if its distance from the ground level is less
# than IN_NOISE standard deviations of a pixel's noise and less than the share SHALLOW of the contrast of the
# darkest region. This happens if contacts cover less than about 0.5 % of an image.
IN_NOISE, SHALLOW = 2.0, 0.25

# Standard deviation of the smoothing before the search for the darkest region [pixels]. In their centres, the
# smallest measured contacts (radius 2 s_t > 4 pixels) retain 9/10 of their contrast, a single bad pixel only
# 1/25.
WIDE = 2.0

# The noise is estimated from every n-th pixel along each side.
EVERY = 5


@dataclass(frozen=True)
class Levels:
    """Ground level, threshold and dark level over the ground level, and blur of the edges [pixels].

    `dark_scatter` is the standard deviation of the dark level among contacts, `blur_error` the standard
    deviation of the blur. `narrow` states that no contact is wide enough to show its dark level, `cut` that
    all contacts are at the edge or merged, and `sparse` that contacts cover too little of the image for
    Otsu's threshold.
    """

    ground: float
    threshold: float
    dark: float
    blur: float
    dark_scatter: float = 0.0
    blur_error: float = 0.0
    narrow: bool = False
    cut: bool = False
    sparse: bool = False

    @property
    def half(self) -> float:
        """Grey level half-way between ground and dark level, in single precision like the images."""
        return float(np.float32(0.5 * (1.0 + self.dark)))


def smoothed(corrected: NDArray[np.float32], width: float) -> tuple[NDArray[np.float32], float]:
    """Return a smoothed image with a border of one ground pixel, and the variance of the Gaussian kernel."""
    bordered = np.ones((corrected.shape[0] + 2, corrected.shape[1] + 2), dtype=np.float32)
    gaussian_filter(corrected, width, output=bordered[1:-1, 1:-1], mode="nearest", truncate=CUT_OFF)
    reach = int(CUT_OFF * width + 0.5)
    place = np.arange(-reach, reach + 1)
    weight = np.exp(-0.5 * (place / width) ** 2)
    return bordered, float((weight * place**2).sum() / weight.sum())


def smoothed_noise(bordered: NDArray[np.float32], labels: NDArray[np.int32], width: float) -> float:
    """Return the standard deviation of the noise of a smoothed image, from differences on its ground.

    The image is divided into blocks that are so large that the middle pixels of neighbouring blocks have
    independent noise. Only pairs of blocks that are away from contacts are used.
    """
    size = int(np.ceil(INDEPENDENT * width))
    rows, columns = (n // size for n in bordered.shape)
    dark = np.zeros((rows, columns), dtype=bool)
    for row in (0, size // 2, size - 1):
        for column in (0, size // 2, size - 1):
            dark |= labels[row::size, column::size][:rows, :columns] > 0
    middle = bordered[size // 2 :: size, size // 2 :: size][:rows, :columns].astype(np.float64)
    for distance in (2, 1, 0):
        clear = ~np.asarray(binary_dilation(dark, iterations=distance) if distance else dark)
        difference = np.concatenate(
            [
                np.diff(middle, axis=1)[clear[:, 1:] & clear[:, :-1]],
                np.diff(middle, axis=0)[clear[1:] & clear[:-1]],
            ]
        )
        if difference.size >= PAIRS:
            break
    if not difference.size:
        return 0.0
    # exclude large differences, which dust on the ground causes
    scale = float(np.median(np.abs(difference))) / MAD
    within = difference[np.abs(difference) <= 4.0 * scale]
    return float(np.sqrt(np.mean(within**2) / 2.0))


def measured_levels(
    ground: Ground, threshold: float | None, dark: float | None, blur: float | None
) -> Levels:
    """Return the levels of an image; only arguments that are None are measured."""
    level, darkest = threshold_of(ground) if threshold is None else (threshold, None)
    sparse = darkest is not None
    if dark is not None and blur is not None:
        return Levels(ground.level, level, dark, blur, sparse=sparse)
    return replace(_from_widest(ground, level, darkest, dark, blur), sparse=sparse)


def threshold_of(ground: Ground) -> tuple[float, float | None]:
    """Return Otsu's threshold and None or, if invalid, the half level and the level of the darkest region."""
    level = ground.otsu()
    noise = float(np.median(np.abs(ground.corrected[::EVERY, ::EVERY] - 1.0))) / MAD
    if 1.0 - level > IN_NOISE * noise:
        return level, None
    darkest = float(gaussian_filter(np.clip(ground.corrected, *ground.span), WIDE, mode="nearest").min())
    if 1.0 - level > SHALLOW * (1.0 - darkest):
        return level, None
    return 0.5 * (1.0 + darkest), darkest


def _from_widest(
    ground: Ground, threshold: float, darkest: float | None, dark: float | None, blur: float | None
) -> Levels:
    """Return the levels of an image, measured in its widest contacts."""
    image, variance = smoothed(ground.corrected, LEAST_SMOOTHING)
    below = image[1:-1, 1:-1][ground.corrected < threshold]
    if not below.size:
        raise InvalidInput(f"threshold = {threshold:.4g} must be above the grey level of the contacts")
    guess = float(np.median(below)) if darkest is None else darkest
    first = guess if dark is None else dark
    labels, count = label(image < Levels(ground.level, threshold, first, 0.0).half)
    if not count:
        return Levels(ground.level, threshold, first, blur or LEAST_SMOOTHING, narrow=True)
    objects = find_objects(labels)
    size = pixels_of(labels, objects)
    whole = [
        i
        for i in np.argsort(-size, kind="stable")[: 2 * MOST]
        if not at_edge(objects[i], image.shape) and single(labels[objects[i]] == i + 1)
    ]
    used = whole[:MOST] or [int(np.argmax(size))]
    windows = [tuple(slice(max(s.start - 4, 0), s.stop + 4) for s in objects[i]) for i in used]
    depths = [distance_transform_edt(labels[w] == i + 1) for i, w in zip(used, windows, strict=True)]
    deepest = max(float(depth.max()) for depth in depths)
    chosen = [(w, d) for w, d in zip(windows, depths, strict=True) if d.max() >= AS_DEEP * deepest]
    cores, pixels = np.array([_core(image[w], d) for w, d in chosen]).T
    level = float(np.median(cores)) if dark is None else dark
    noise = smoothed_noise(image, labels, LEAST_SMOOTHING)
    scatter = _scatter(cores, noise, pixels, math.sqrt(variance)) if dark is None else 0.0
    if not whole:
        unknown = UNKNOWN_BLUR if blur is None else 0.0
        return Levels(
            ground.level, threshold, level, blur or LEAST_SMOOTHING, scatter, unknown, cut=blur is None
        )
    for _ in range(ROUNDS):
        edge, radius = np.array([_edge(image[w], d, level) for w, d in chosen]).T
        total = float(np.median(edge)) if blur is None else np.sqrt(blur**2 + variance)
        if dark is not None or deepest > 2.0 * DEEP * total:
            break
        # mean share of the contrast that the middle pixels of a smoothed circle retain
        shown = chndtr((radius / total) ** 2, 2.0, pixels / (2.0 * math.pi * total**2))
        level = float(np.median(1.0 - (1.0 - cores) / shown))
    error = float(np.median(np.abs(edge - total))) / MAD / np.sqrt(edge.size)
    own = np.sqrt(max(total**2 - variance, 0.0)) if blur is None else blur
    # the error of s follows from the error of s_t, since the variance of the smoothing is exact
    spread = 0.0 if blur is not None else total / max(own, LEAST_SMOOTHING) * error
    return Levels(
        ground.level, threshold, level, float(own), scatter, float(spread), narrow=deepest < DEEP * total
    )


def _core(window: NDArray[np.float32], depth: FloatArray) -> tuple[float, int]:
    """Return the mean grey level of the middle pixels of a contact, and the number of these pixels."""
    deepest = float(depth.max())
    middle = window[depth >= max(0.5 * deepest, min(deepest - 1.0, CORE))]
    return float(middle.mean(dtype=np.float64)), middle.size


def _scatter(cores: FloatArray, noise: float, pixels: FloatArray, width: float) -> float:
    """Return the standard deviation of the dark level among contacts, including the error of their median.

    After smoothing by a Gaussian of standard deviation w, the noise has one independent value per 4 pi w²
    pixels.
    """
    spread = float(np.median(np.abs(cores - np.median(cores)))) / MAD
    independent = np.maximum(pixels / (4.0 * math.pi * width**2), 1.0)
    by_noise = float(np.mean(noise**2 / independent))
    # the variance of a median is pi/2 times the variance of a mean
    error = 0.5 * math.pi * max(spread**2, by_noise) / cores.size
    # the square of a median absolute deviation of n values has the relative scatter 2.3/sqrt(n)
    chance = by_noise * (1.0 + 2.3 / math.sqrt(cores.size))
    return math.sqrt(max(spread**2 - chance, 0.0) + error)


def _edge(window: NDArray[np.float32], depth: FloatArray, dark: float) -> tuple[float, float]:
    """Return the standard deviation of the edge of a contact, and the radius of the contact [pixels].

    The standard deviation follows from the areas within the contours at the two quarter levels. At a straight
    edge these contours are 2 x 0.6745 standard deviations apart.
    """
    ring = []
    for quarter in (0.75, 0.5, 0.25):
        found = _within(window, depth, dark + quarter * (1.0 - dark))
        if found is None:
            return LEAST_SMOOTHING, float(depth.max())
        ring.append(found)
    outer, middle, inner = ring
    variance = float((outer.area - inner.area)[0] / (2.0 * MAD * middle.length[0])) ** 2
    square = float(middle.area[0]) / math.pi + variance
    variance -= EDGE_INTERPOLATION + EDGE_CURVATURE * variance**2 / square
    return math.sqrt(max(variance, 0.0)), math.sqrt(square)


def _within(window: NDArray[np.float32], depth: FloatArray, level: float) -> Contours | None:
    """Return the contour at a level around the deepest pixel of a contact, or None if there is no contour."""
    level = float(np.float32(level))
    bordered = np.pad(window, 1, constant_values=1.0)
    labels, _ = label(bordered < level)
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    region = labels[row + 1, column + 1]
    if not region:
        return None
    return contours(bordered, (labels == region).astype(np.int32), level, 1)
