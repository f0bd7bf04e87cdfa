"""Threshold of an image, and grey levels of contacts and the blur of their edges from the widest of them."""

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

# Smallest standard deviation of the smoothing [pixels], used also before the blur is known: pixels do not
# resolve narrower kernels.
LEAST_SMOOTHING = 1.0

# Standard deviations at which the kernel of a smoothing is truncated; the variance is that of the truncated
# kernel.
CUT_OFF = 3.0

# Largest number of contacts used for the levels, and their smallest depth over that of the deepest.
MOST, AS_DEEP = 64, 0.5

# Depth [pixels] beyond which a contact has its dark level: four standard deviations of an edge after a blur
# of 1.5 pixels and the first smoothing. Rounds of the correction of contacts without such pixels.
CORE, ROUNDS = 7.0, 3

# Smallest depth of a contact that shows its dark level, in standard deviations of the smoothed edge.
DEEP = 3.0

# Distance at which the noise of an image smoothed by a Gaussian is independent, in its standard deviations:
# the correlation is exp(-9/4), a tenth. Smallest number of pairs of such blocks for the noise.
INDEPENDENT, PAIRS = 3.0, 100

# Error of the blur where it is not measured [pixels]: optics blur by 0.5 to 2 pixels.
UNKNOWN_BLUR = 0.5

# Otsu's threshold lies within the noise of the ground if its distance from the ground is less than this
# number of standard deviations of a pixel's noise, and less than this share of the depth of the darkest
# region. This happens where contacts cover less than about half a percent of an image.
IN_NOISE, SHALLOW = 2.0, 0.25

# Smoothing in which the darkest region is sought [pixels]. The smallest contacts that are measured, with the
# radius 2 s_t > 4 pixels, keep 9/10 of their depth in the middle, and one bad pixel 1/25.
WIDE = 2.0

# The noise is read from every n-th pixel along each side.
EVERY = 5


@dataclass(frozen=True)
class Levels:
    """Grey level of the ground; Otsu's threshold and the dark level over it; the blur of the edge [pixels].

    `dark_scatter` and `blur_error` are the standard deviations of the dark level among contacts and of the
    blur; `narrow` says that no contact is wide enough to show its dark level, `cut` that all are at the
    edge or merged, `sparse` that contacts cover too little of the image for Otsu's threshold.
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
        """The level half-way between ground and dark, in single precision as the images."""
        return float(np.float32(0.5 * (1.0 + self.dark)))


def smoothed(corrected: NDArray[np.float32], width: float) -> tuple[NDArray[np.float32], float]:
    """Return an image smoothed by a Gaussian, with a border of one pixel of ground, and its variance."""
    bordered = np.ones((corrected.shape[0] + 2, corrected.shape[1] + 2), dtype=np.float32)
    gaussian_filter(corrected, width, output=bordered[1:-1, 1:-1], mode="nearest", truncate=CUT_OFF)
    reach = int(CUT_OFF * width + 0.5)
    place = np.arange(-reach, reach + 1)
    weight = np.exp(-0.5 * (place / width) ** 2)
    return bordered, float((weight * place**2).sum() / weight.sum())


def smoothed_noise(bordered: NDArray[np.float32], labels: NDArray[np.int32], width: float) -> float:
    """Return the standard deviation of the noise of a smoothed image, from differences across its ground.

    The image is divided into blocks so large that the middle pixels of neighbours have independent noise.
    Pairs of blocks enter that are away from contacts.
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
    # differences by dust on the ground are left out
    scale = float(np.median(np.abs(difference))) / MAD
    within = difference[np.abs(difference) <= 4.0 * scale]
    return float(np.sqrt(np.mean(within**2) / 2.0))


def measured_levels(
    ground: Ground, threshold: float | None, dark: float | None, blur: float | None
) -> Levels:
    """Return the levels of an image; arguments that are not None are not measured."""
    level, darkest = threshold_of(ground) if threshold is None else (threshold, None)
    sparse = darkest is not None
    if dark is not None and blur is not None:
        return Levels(ground.level, level, dark, blur, sparse=sparse)
    return replace(_from_widest(ground, level, darkest, dark, blur), sparse=sparse)


def threshold_of(ground: Ground) -> tuple[float, float | None]:
    """Return Otsu's threshold or, within noise, the half level of the darkest region and its level."""
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
    """Return the levels of the widest contacts of an image."""
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
        # the share of the contrast of a smoothed circle within the pixels of its middle
        shown = chndtr((radius / total) ** 2, 2.0, pixels / (2.0 * math.pi * total**2))
        level = float(np.median(1.0 - (1.0 - cores) / shown))
    error = float(np.median(np.abs(edge - total))) / MAD / np.sqrt(edge.size)
    own = np.sqrt(max(total**2 - variance, 0.0)) if blur is None else blur
    # the error of s from that of s_t; the smoothing is exact
    spread = 0.0 if blur is not None else total / max(own, LEAST_SMOOTHING) * error
    return Levels(
        ground.level, threshold, level, float(own), scatter, float(spread), narrow=deepest < DEEP * total
    )


def _core(window: NDArray[np.float32], depth: FloatArray) -> tuple[float, int]:
    """Return the mean grey level of the middle of a contact, and its number of pixels."""
    deepest = float(depth.max())
    middle = window[depth >= max(0.5 * deepest, min(deepest - 1.0, CORE))]
    return float(middle.mean(dtype=np.float64)), middle.size


def _scatter(cores: FloatArray, noise: float, pixels: FloatArray, width: float) -> float:
    """Return the standard deviation of the dark level among contacts, with the error of its median.

    Noise smoothed by a Gaussian of standard deviation w has one independent value for 4 pi w² pixels.
    """
    spread = float(np.median(np.abs(cores - np.median(cores)))) / MAD
    independent = np.maximum(pixels / (4.0 * math.pi * width**2), 1.0)
    by_noise = float(np.mean(noise**2 / independent))
    # a median has the variance pi/2 times that of a mean
    error = 0.5 * math.pi * max(spread**2, by_noise) / cores.size
    # the square of a median absolute deviation has the relative scatter 2.3/sqrt(n)
    chance = by_noise * (1.0 + 2.3 / math.sqrt(cores.size))
    return math.sqrt(max(spread**2 - chance, 0.0) + error)


def _edge(window: NDArray[np.float32], depth: FloatArray, dark: float) -> tuple[float, float]:
    """Return the standard deviation of a contact's edge, and the contact's radius.

    The edge is found from the areas within the quarter levels, which are 2 x 0.6745 standard deviations apart
    at a straight edge.
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
    """Return the contour at a level about the deepest point of a contact."""
    level = float(np.float32(level))
    bordered = np.pad(window, 1, constant_values=1.0)
    labels, _ = label(bordered < level)
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    region = labels[row + 1, column + 1]
    if not region:
        return None
    return contours(bordered, (labels == region).astype(np.int32), level, 1)
