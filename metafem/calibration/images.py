"""Contact areas in images of the contact interface, with their errors."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import binary_dilation, distance_transform_edt, find_objects, gaussian_filter, label
from scipy.special import chndtr

from metafem import _validate as check
from metafem._extras import refuse_missing
from metafem._given import Given, shown
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, percent
from metafem.calibration import contours as boundary
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information
from metafem.progress import each

Grey: TypeAlias = NDArray[np.float32]

# Smallest number of pixels along the shorter side of an image, enough for one contact and the ground around
# it.
FEWEST = 16

# Largest possible grey levels. Pictures of cameras with 10 to 14 bits are stored with 16 bits.
FULL_SCALE = tuple(2**bits - 1 for bits in (8, 10, 12, 14, 16, 32))

# A contact counts as saturated if more than this share of its grey levels is at an end of the scale.
SATURATED = 0.01

# Degree of the ground's polynomial in each coordinate: a gradient, and a lens that is darker at its corners.
DEGREE = 2

# Number of blocks along the shorter side of the image, smallest size of a block [pixels], and number of
# pixels that are read along each side of a block.
BLOCKS, LEAST_BLOCK, READ = 96, 4, 7

# Largest distance between a block of the ground and the surface, in standard deviations; largest number of
# iterations; smallest share of the blocks for a fit; weight of the blocks on the bright side of the surface
# in the initial guess, with which contacts may cover up to two thirds of the image.
CLIPPED, ROUNDS, ENOUGH, WEIGHT = 3.0, 12, 0.03, 50.0

# Ratio of the median absolute deviation to the standard deviation of a normal distribution.
MAD = 0.6745

# Limit for the division of an image by its ground. An image with bright contacts is divided if the grey level
# of the ground exceeds FAINT times the contrast, which is not the case in a dark field. An image with dark
# contacts is divided unless grey levels lie below zero by more than FAINT times the ground, or the ground
# lies below FAINT² times its mean level.
FAINT = 0.2

# Smallest standard deviation of the smoothing [pixels], because pixels do not resolve narrower kernels, and
# number of standard deviations at which the kernel is cut off. The variance includes the truncation.
LEAST_SMOOTHING, CUT_OFF = 1.0, 3.0

# Largest number of contacts used for the levels, and the smallest ratio of their depth to the largest depth.
# The depth of a contact is the distance from its edge to its deepest pixel.
MOST, AS_DEEP = 64, 0.5

# Depth [pixels] beyond which a contact shows its dark level: four standard deviations of an edge after a blur
# of 1.5 pixels and the first smoothing; the same in standard deviations of an edge; number of corrections if
# contacts are not so deep.
CORE, DEEP, CORRECTED = 7.0, 3.0, 3

# Distance between pixels with nearly independent noise in a smoothed image, in standard deviations of the
# smoothing; the correlation is exp(-9/4), about 0.1. Smallest number of pairs that determine the noise.
INDEPENDENT, PAIRS = 3.0, 100

# Error of the blur if it cannot be measured [pixels]; typical optics have a blur of 0.5 to 2 pixels.
UNKNOWN_BLUR = 0.5

# Otsu's threshold is within the noise of the ground if its distance from the ground level is less than
# IN_NOISE standard deviations of a pixel's noise and less than the share SHALLOW of the contrast of the
# darkest region, found after smoothing by WIDE pixels. This is so if contacts cover less than about 0.5 %.
IN_NOISE, SHALLOW, WIDE = 2.0, 0.25, 2.0

# Smallest contrast of the contacts over the noise of the smoothed image; smallest radius of a measured
# contact, in standard deviations of the smoothed edge, below which the half level encloses less than three
# quarters of it; smallest difference between grey levels, in standard deviations, that is no noise.
CONTRAST, SMALLEST, CLEAR = 6.0, 2.0, 3.0

# Structure of the ground over the contrast above which there is a note: the half level is then wrong by 1 %.
UNEVEN = 0.02

# Smallest share of the range of grey levels by which a frame differs from the image within it.
FRAME = 0.1

# Largest number of contacts that a note names.
NAMED = 10

# What helps if contacts are bright.
BRIGHT = "If contacts are brighter than the ground, give bright_contacts=True, or --bright-contacts. "

# Note on an image that cannot be measured.
NOT_MEASURED = "{.name} is not measured: {.number}"


@dataclass(frozen=True, eq=False, repr=False)
class ContactAreas(Value):
    """The n contacts in one image, ordered from the top to the bottom of the frame.

    Attributes
    ----------
    area, area_error : ndarray, (n,)
        Contact areas and their standard deviations [mm^2]. For a contact at the edge of the frame, the area
        is the visible part; for merged contacts it is their total.
    centre : ndarray, (n, 2)
        Centres [mm], with x to the right and y upwards from the lower left corner of the frame. The centre of
        the lower left pixel is at half a pixel in x and y.
    axes : ndarray, (n, 2)
        Semi-axes of the ellipses with the second moments of the contacts, the longer axis first [mm].
    angle : ndarray, (n,)
        Angle of the longer axis from the x axis, anticlockwise, from -pi/2 to pi/2 [rad].
    edge, merged, saturated : ndarray of bool, (n,)
        Whether a contact is at the edge of the frame, consists of merged contacts, or is saturated: more than
        1 % of the grey levels of the contact or of the ground are at an end of the scale.
    holes : ndarray of int, (n,)
        Number of bright spots within each contact, which do not count as contact area.
    dark_level : float
        Grey level of wide contacts over the grey level of the ground [-].
    blur : float
        Standard deviation of the Gaussian blur of the contact edges [mm].
    noise : float
        Standard deviation of the noise of a pixel over the contrast, measured at the scale of the blur [-].
    pixel_size : float
        Side of a pixel [mm].
    shape : tuple of int
        Rows and columns of the image.
    smallest_area : float
        Area below which a dark region does not count as a contact [mm^2].
    failed : bool
        Whether the measurement of the image failed. There are then no contacts, and `notes` states the
        reason.
    notes : tuple of Note

    Examples
    --------
    >>> import metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> found = mf.calibration.contact_areas(image, pixel_size=0.005)
    >>> found.count, found.complete.all(), found.centre.round(4)
    (1, np.True_, array([[0.2025, 0.1475]]))
    """

    area: FloatArray
    area_error: FloatArray
    centre: FloatArray
    axes: FloatArray
    angle: FloatArray
    edge: NDArray[np.bool_]
    merged: NDArray[np.bool_]
    saturated: NDArray[np.bool_]
    holes: IntArray
    dark_level: float
    blur: float
    noise: float
    pixel_size: float
    shape: tuple[int, int]
    smallest_area: float = 0.0
    failed: bool = False
    notes: tuple[Note, ...] = ()

    @property
    def count(self) -> int:
        """Number of contacts."""
        return len(self.area)

    @property
    def frame(self) -> FloatArray:
        """Width and height of the image, (2,) [mm]."""
        return self.pixel_size * np.array(self.shape[::-1])

    @property
    def complete(self) -> NDArray[np.bool_]:
        """Whether each contact is neither at the edge of the frame nor merged, (n,)."""
        return ~(self.edge | self.merged)


@dataclass(frozen=True)
class Levels:
    """Grey level of the ground, dark level of the contacts over it, and blur of the edges [pixels].

    `dark_scatter` is the standard deviation of the dark level among contacts, `blur_error` the standard
    deviation of the blur. `narrow` states that no contact is wide enough to show its dark level, and `cut`
    that all contacts are at the edge or merged.
    """

    ground: float
    dark: float
    blur: float
    dark_scatter: float = 0.0
    blur_error: float = 0.0
    narrow: bool = False
    cut: bool = False

    @property
    def half(self) -> float:
        """Grey level half-way between ground and dark level, in single precision like the images."""
        return float(np.float32(0.5 * (1.0 + self.dark)))


@dataclass(frozen=True)
class Ground:
    """Image without the illumination: 1 on the ground, and smaller in the contacts.

    `structure` is the standard deviation of the blocks of the ground about the polynomial, without noise,
    `level` the mean grey level of the ground, and `span` the range of the blocks, extended by its own width
    at both ends; bad pixels lie outside of it.
    """

    corrected: Grey
    structure: float
    level: float
    span: tuple[float, float]


def contact_areas(image: Any, pixel_size: float, *, bright_contacts: bool = False) -> ContactAreas:
    """Return the contacts in an image, dark regions on a brighter ground, with their areas.

    The image is divided by the grey level of its ground, a polynomial of degree 2 in x and in y. It is then
    smoothed by a Gaussian of the same width s as the blur of the image, which gives the least noise in the
    areas. Contacts are the regions within the contour at the half level, half-way between the ground (grey
    level 1) and the dark level of wide contacts. Blur and smoothing have the total variance s_t². They move
    the contour inwards by s_t²/2 times its curvature, so that the contour of any shape encloses ``pi s_t²``
    less than the contact. This area is added, together with the next term for a circle of radius r,
    ``pi s_t⁴/(6 r²)``.

    Parameters
    ----------
    image : array_like, (rows, columns)
        Grey values, integers or floats; row 0 is at the top.
    pixel_size : float
        Side of a pixel [mm].
    bright_contacts : bool
        Whether the contacts are brighter than the ground; default: False.

    Returns
    -------
    ContactAreas

    Raises
    ------
    InvalidInput
        If the image has values that are not finite grey levels, a frame of one grey level around it, or no
        contacts.

    Notes
    -----
    n is the standard deviation of the noise of a pixel over the contrast. If an area has the perimeter L,
    noise causes an error of ``n sqrt(2 sqrt(pi) s L)`` square pixels. For n = 0.05 and s = 1.5 pixels this is
    0.3, 0.1 and 0.03 % of the area at radii of 10, 20 and 50 pixels. `area_error` also includes the scatter
    of the grey levels of the ground and of the contacts, and the errors of the dark level and of s, which are
    common to all contacts of an image. Contacts with a radius below 2 s_t are not measured; below 1.2 s_t
    they do not reach the half level. A contact within 2 s_t of the frame counts as at the edge. The blur of a
    neighbour within 2 s_t enlarges an area by up to 1 %; still closer neighbours are merged.

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> found = mf.calibration.contact_areas(image, pixel_size=0.005)
    >>> exact = np.pi * (20.0 * 0.005) ** 2
    >>> bool(abs(found.area[0] / exact - 1.0) < 0.01)
    True
    """
    refuse_missing("skimage", "images", "measuring contact areas")
    return _measured(image, check.number("pixel_size", pixel_size, above=0.0), bright_contacts)[0]


def stack_areas(
    images: Sequence[Any], pixel_size: float, loads: ArrayLike | None = None, *, bright_contacts: bool = False
) -> tuple[ContactAreas, ...]:
    """Return the contacts in k images, measured with the levels of the image at the largest load.

    The image at the largest load determines the dark level and the blur, because narrow contacts at
    smaller loads may not show them. If this image cannot be measured, the image at the next smaller load is
    used instead. If the wide contacts of another image are brighter or darker than the dark level, a note
    says so, and the errors of the areas in that image include the possible effect. A change of the blur
    between images is not detected. The images are read one at a time, from the largest load to the smallest.
    An image that cannot be measured does not stop the others: its result has no contacts, `failed` is true,
    and its notes state the reason.

    Parameters
    ----------
    images : sequence of array_like, (rows, columns)
        Images as for `contact_areas`; the sequence may read an image from a file when ``images[i]`` is
        evaluated.
    pixel_size : float
        Side of a pixel [mm].
    loads : array_like, (k,), optional
        Normal loads [N]; default: the last image is assumed to have the largest load.
    bright_contacts : bool
        As for `contact_areas`.

    Returns
    -------
    tuple of ContactAreas, (k,)
        Contacts of each image, in the order of the images.

    Raises
    ------
    InvalidInput
        If no image can be measured, or if an argument is outside its range.

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> images = [200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - r)) for r in (8.0, 14.0, 20.0)]
    >>> found = mf.calibration.stack_areas([np.zeros((60, 80)), *images], 0.005, loads=[0.0, 0.1, 0.2, 0.3])
    >>> [areas.count for areas in found], found[0].failed, len({areas.dark_level for areas in found})
    ([0, 1, 1, 1], True, 1)
    """
    refuse_missing("skimage", "images", "measuring contact areas")
    pixel = check.number("pixel_size", pixel_size, above=0.0)
    try:
        count = len(images)
    except TypeError:
        raise InvalidInput(f"images = {shown(images)} must be a sequence of images") from None
    refuse_if(not count, "images is empty; it must hold at least one image")
    load = np.arange(count) if loads is None else check.array("loads", loads, shape=(count,))
    found: dict[int, ContactAreas] = {}
    failures: dict[int, tuple[Given, Given]] = {}
    levels: Levels | None = None
    for i in each("measuring image", np.argsort(-load, kind="stable").tolist()):
        own = Given(f"images[{i}]")
        try:
            found[i], levels = _measured(images[i], pixel, bright_contacts, levels)
        except InvalidInput as error:
            failures[i] = own, Given("reason", str(error))
            continue
        if len(found) == 1 and failures:
            # every result with these levels has a note that names the source of the levels
            other, _ = next(iter(failures.values()))
            source = "the levels are from {.name}, because {.name} cannot be measured"
            found[i] = replace(found[i], notes=(*found[i].notes, Note(source.format(own, other))))
    if not found:
        first = next(iter(failures.values()))
        raise InvalidInput(f"none of the images can be measured: {NOT_MEASURED}", *first)
    reference = vars(next(iter(found.values())))
    none = {name: value[:0] for name, value in reference.items() if isinstance(value, np.ndarray)}
    for i, failure in failures.items():
        notes = (Note(NOT_MEASURED.format(*failure)),)
        found[i] = ContactAreas(**{**reference, **none, "failed": True, "notes": notes})
    return tuple(found[i] for i in range(count))


def grey_values(image: Any) -> NDArray[Any]:
    """Return the grey values of an image, (rows, columns), row 0 at the top, in the original data type."""
    if isinstance(image, (str, bytes)) or hasattr(image, "__fspath__"):
        must = "is a name; it must be an array of grey values. `metafem images` reads files"
        raise InvalidInput(must, key="image", value=shown(image))
    try:
        values = np.asarray(np.ma.getdata(image) if not np.ma.is_masked(image) else None)
    except (TypeError, ValueError):
        raise InvalidInput(f"image = {shown(image)} must be an array of grey values") from None
    if values.dtype.kind not in "uif":
        raise InvalidInput(
            f"image must be an array of grey values without mask; its entries are {values.dtype}"
        )
    several = "; a stack of images is measured by stack_areas" if values.ndim > 2 else ""
    refuse_if(
        values.ndim != 2 or min(values.shape) < FEWEST,
        f"image has shape {values.shape}; it must be (rows, columns) with at least {FEWEST} of each{several}",
    )
    for row, column in np.argwhere(~np.isfinite(values))[:1].tolist():
        where = f"{values[row, column]} in row {row + 1}, column {column + 1}"
        raise InvalidInput(f"image holds {where}; all grey values must be finite")
    low, high = float(values.min()), float(values.max())
    same = f"all its grey values are {low:g}, all dark or all bright; it shows no contact"
    refuse_if(low == high, f"image is constant: {same}")
    large = not max(abs(low), abs(high)) < float(np.finfo(np.float32).max) / values.size
    refuse_if(large, f"image holds grey values from {low:g} to {high:g}; they are too large")
    return values


def clipped(values: NDArray[Any]) -> tuple[NDArray[np.bool_] | None, NDArray[np.bool_] | None]:
    """Return masks of the pixels at the lower and the upper end of the scale; None for an empty mask."""
    if values.dtype.kind not in "ui":
        return None, None
    low = values == 0 if values.min() == 0 else None
    largest = int(values.max())
    return low, values == largest if largest in FULL_SCALE else None


def _refuse_frame(values: NDArray[Any]) -> None:
    """Raise InvalidInput if one grey level frames the image on all sides, as of a saturated border."""
    level, width, inner = values[0, 0], 0, values
    while min(inner.shape) >= FEWEST:
        ring = np.concatenate([inner[0], inner[-1], inner[:, 0], inner[:, -1]])
        if (ring != level).any():
            break
        width, inner = width + 1, inner[1:-1, 1:-1]
    apart = abs(float(np.median(ring)) - float(level)) > FRAME * float(np.ptp(values.astype(np.float64)))
    refuse_if(
        width and apart,
        f"image has a frame of the grey level {level:g}, {width} pixels wide: crop it, since the ground is "
        "sought up to the edges of the image",
    )


def _measured(
    image: Any, pixel: float, bright_contacts: bool, found: Levels | None = None
) -> tuple[ContactAreas, Levels]:
    """Return the contacts of an image and its levels; if `found` is not None, these levels are used."""
    values = grey_values(image)
    _refuse_frame(values)
    ground = without_illumination(values.astype(np.float32), bright_contacts)
    own = found is None
    if found is None:
        found = _levels(ground)
    elif abs(ground.level / found.ground - 1.0) > 0.5 * (1.0 - found.dark):
        raise InvalidInput(
            f"image is all dark or bright, or has another exposure: the grey level of its ground is "
            f"{ground.level:.4g}, and that of the image at the largest load is {found.ground:.4g}"
        )
    hint = "" if bright_contacts else BRIGHT
    areas = _contacts(values, ground, found, pixel, own, hint)
    return areas, found


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
    level, contrast, surface = float(coefficients[0]), float(np.abs(residual).max()), grid - residual
    divided = float(ground.min()) > FAINT * contrast
    if not bright_contacts:
        negative = (grid < -CLIPPED * error - FAINT * surface).any()
        divided = float(ground.min()) > FAINT**2 * level and not negative
    if divided:
        corrected, blocks, scale = image / ground, grid / surface, abs(level)
    else:
        scale = contrast or 1.0
        corrected, blocks = 1.0 + (image - ground) / np.float32(scale), 1.0 + residual / scale
    if bright_contacts:
        corrected, blocks = 2.0 - corrected, 2.0 - blocks
    low, high = float(blocks.min()), float(blocks.max())
    span = (2.0 * low - high, 2.0 * high - low)
    return Ground(corrected, structure / scale, level, span)


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


def _levels(ground: Ground) -> Levels:
    """Return the levels of an image, measured in its widest contacts."""
    image, variance = smoothed(ground.corrected, LEAST_SMOOTHING)
    first = _darkness(ground, image)
    labels, count = label(image < Levels(ground.level, first, 0.0).half)
    if not count:
        return Levels(ground.level, first, LEAST_SMOOTHING, narrow=True)
    objects = find_objects(labels)
    size = _pixels(labels, objects)
    whole = [
        i
        for i in np.argsort(-size, kind="stable")[: 2 * MOST]
        if not _at_edge(objects[i], image.shape) and boundary.single(labels[objects[i]] == i + 1)
    ]
    used = whole[:MOST] or [int(np.argmax(size))]
    windows = [tuple(slice(max(s.start - 4, 0), s.stop + 4) for s in objects[i]) for i in used]
    depths = [distance_transform_edt(labels[w] == i + 1) for i, w in zip(used, windows, strict=True)]
    deepest = max(float(depth.max()) for depth in depths)
    chosen = [(w, d) for w, d in zip(windows, depths, strict=True) if d.max() >= AS_DEEP * deepest]
    cores, pixels = np.array([_core(image[w], d) for w, d in chosen]).T
    level = float(np.median(cores))
    noise = smoothed_noise(image, labels, LEAST_SMOOTHING)
    scatter = _scatter(cores, noise, pixels, math.sqrt(variance))
    if not whole:
        return Levels(ground.level, level, LEAST_SMOOTHING, scatter, UNKNOWN_BLUR, cut=True)
    for _ in range(CORRECTED):
        edge, radius = np.array([_edge(image[w], d, level) for w, d in chosen]).T
        total = float(np.median(edge))
        if deepest > 2.0 * DEEP * total:
            break
        # mean share of the contrast that the middle pixels of a smoothed circle retain
        shown = chndtr((radius / total) ** 2, 2.0, pixels / (2.0 * math.pi * total**2))
        level = float(np.median(1.0 - (1.0 - cores) / shown))
    error = float(np.median(np.abs(edge - total))) / MAD / math.sqrt(edge.size)
    own = math.sqrt(max(total**2 - variance, 0.0))
    # the error of s follows from the error of s_t, since the variance of the smoothing is exact
    return Levels(
        ground.level, level, own, scatter, total / max(own, LEAST_SMOOTHING) * error, deepest < DEEP * total
    )


def _darkness(ground: Ground, image: Grey) -> float:
    """Return a first dark level: by Otsu's method or, within the noise, of the darkest region."""
    threshold = otsu(np.clip(ground.corrected, *ground.span))
    noise = float(np.median(np.abs(ground.corrected - 1.0))) / MAD
    if 1.0 - threshold <= IN_NOISE * noise:
        darkest = float(gaussian_filter(np.clip(ground.corrected, *ground.span), WIDE, mode="nearest").min())
        if 1.0 - threshold <= SHALLOW * (1.0 - darkest):
            return darkest
    return float(np.median(image[1:-1, 1:-1][ground.corrected < threshold]))


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
        found = _ring(window, depth, dark + quarter * (1.0 - dark))
        if found is None:
            return LEAST_SMOOTHING, float(depth.max())
        ring.append(found)
    outer, middle, inner = ring
    variance = float((outer.area - inner.area)[0] / (2.0 * MAD * middle.length[0])) ** 2
    square = float(middle.area[0]) / math.pi + variance
    variance -= boundary.EDGE_INTERPOLATION + boundary.EDGE_CURVATURE * variance**2 / square
    return math.sqrt(max(variance, 0.0)), math.sqrt(square)


def _ring(window: NDArray[np.float32], depth: FloatArray, level: float) -> boundary.Contours | None:
    """Return the contour at a level around the deepest pixel of a contact, or None if there is no contour."""
    level = float(np.float32(level))
    bordered = np.pad(window, 1, constant_values=1.0)
    labels, _ = label(bordered < level)
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    region = labels[row + 1, column + 1]
    if not region:
        return None
    return boundary.contours(bordered, (labels == region).astype(np.int32), level, 1)


def _pixels(labels: NDArray[np.int32], windows: list[Any]) -> FloatArray:
    """Return the number of pixels of each region 1, 2, ..., from its window."""
    counts = [np.count_nonzero(labels[window] == number) for number, window in enumerate(windows, 1)]
    return np.array(counts, dtype=np.float64)


def _at_edge(window: tuple[slice, ...], shape: tuple[int, ...], margin: int = 1) -> bool:
    """Return whether a region is within `margin` pixels of the frame's edge; the image has a border."""
    return any(s.start <= margin or s.stop >= n - margin for s, n in zip(window, shape, strict=True))


def _contacts(
    values: NDArray[Any], ground: Ground, found: Levels, pixel: float, own: bool, hint: str
) -> ContactAreas:
    """Return the contacts of an image with known levels; `own` states that the levels are from this image."""
    image, variance = smoothed(ground.corrected, max(found.blur, LEAST_SMOOTHING))
    labels, count = label(image < found.half)
    windows = find_objects(labels)
    contrast = 1.0 - found.dark
    scatter = smoothed_noise(image, labels, max(found.blur, LEAST_SMOOTHING))
    if contrast < CONTRAST * max(scatter, 0.5 * ground.structure):
        raise InvalidInput(
            f"image shows no contacts, it is all dark or bright: its grey levels differ by {contrast:.2g} of "
            f"the ground's, with noise of {scatter:.2g} after smoothing. {hint}If they "
            "are very small, measure the image in a series with larger ones"
        )
    around = [
        w
        for w in windows
        if all(s.start <= 1 and s.stop >= n - 1 for s, n in zip(w, image.shape, strict=True))
    ]
    whole = "a dark region reaches all four sides of the image, which no contact does."
    refuse_if(around, f"{whole} {hint}Crop a dark frame")
    # smoothing reduces white noise n to n/(2 sqrt(pi) w)
    noise = 2.0 * math.sqrt(math.pi * variance) * scatter / contrast
    total = math.sqrt(found.blur**2 + variance)
    least = math.pi * (SMALLEST * total) ** 2
    # regions that are certainly too small are excluded here, others after their contours are known
    size = _pixels(labels, windows)
    large = size >= max(0.5 * (least - math.pi * total**2), 4.0)
    labels = np.concatenate([[0], np.where(large, np.cumsum(large), 0)]).astype(np.int32)[labels]
    windows, size = [windows[i] for i in np.flatnonzero(large)], size[large]
    shape = boundary.contours(image, labels, found.half, size.size)
    area = boundary.enclosed(shape.area, shape.holes.astype(np.float64), total)
    edge = np.array([_at_edge(w, image.shape, math.ceil(2.0 * total)) for w in windows], dtype=bool)
    axes, angle = boundary.semi_axes(shape, total)
    compact = boundary.compactness(shape.area, shape.moment) >= boundary.COMPACT
    for i in np.flatnonzero(shape.holes):
        compact[i] = boundary.single(labels[windows[i]] == i + 1)
    enough, joined = area >= least, ~compact & ~edge
    # integer grey levels are wrong by up to half a step, unless noise distributes a level over several steps
    step = 1.0 / (abs(ground.level) * contrast) if values.dtype.kind in "ui" and noise else 0.0
    steps = step / math.sqrt(6.0) * math.exp(-2.0 * (math.pi * noise / step) ** 2) if step else 0.0
    drift = 0.0
    if not own:
        whole = enough & ~edge & ~joined & (shape.holes == 0) & (axes[:, 1] > DEEP * total)
        common = math.hypot(ground.structure, steps * contrast)
        drift = _drift(image, shape.centre[whole], axes[whole], total, found, scatter, common)
    at_level = 0.5 * math.hypot(
        found.dark_scatter / contrast, ground.structure / contrast, drift / contrast, steps
    )
    error = boundary.of_contour(
        shape.length, noise, math.sqrt(variance), total, at_level, found.blur_error * found.blur / total
    )
    clipped_contacts = _saturated(values, labels[1:-1, 1:-1], size, not hint)
    order = np.flatnonzero(enough)
    result = ContactAreas(
        area=area[order] * pixel**2,
        area_error=error[order] * pixel**2,
        centre=shape.centre[order] * pixel,
        axes=axes[order] * pixel,
        angle=angle[order],
        edge=edge[order],
        merged=joined[order],
        saturated=clipped_contacts[order],
        holes=shape.holes[order],
        dark_level=found.dark,
        blur=found.blur * pixel,
        noise=noise,
        pixel_size=pixel,
        shape=(values.shape[0], values.shape[1]),
        smallest_area=least * pixel**2,
    )
    return replace(result, notes=tuple(_notes(result, found, ground, count - len(order), drift / contrast)))


def _drift(
    image: Grey,
    centre: FloatArray,
    axes: FloatArray,
    total: float,
    found: Levels,
    noise: float,
    common: float,
) -> float:
    """Return the grey level of wide contacts minus the dark level, 0 if the difference is not significant."""
    if not len(centre):
        return 0.0
    x, y = centre.T
    # the border shifts the pixels by 1
    level = image[(image.shape[0] - 1 - y).astype(int), x.astype(int) + 1].astype(np.float64)
    # share of the contrast that a smoothed circle retains in its middle
    level = 1.0 - (1.0 - level) / (1.0 - np.exp(-0.5 * axes.prod(axis=1) / total**2))
    away = float(np.median(level)) - found.dark
    spread = float(np.median(np.abs(level - np.median(level)))) / MAD
    # the variance of a median is pi/2 times the variance of a mean
    chance = math.sqrt(0.5 * math.pi / level.size) * max(spread, noise)
    return away if abs(away) > CLEAR * math.hypot(chance, found.dark_scatter, common) else 0.0


def _saturated(
    values: NDArray[Any], labels: NDArray[np.int32], size: FloatArray, bright_contacts: bool
) -> NDArray[np.bool_]:
    """Return which contacts are saturated, (n,); all of them if the ground is saturated.

    `size` holds the number of pixels of each contact. `labels` has no border.
    """
    in_contact, on_ground = clipped(values)[:: -1 if bright_contacts else 1]
    result = np.zeros(size.size, dtype=bool)
    if in_contact is not None:
        result |= np.bincount(labels[in_contact], minlength=size.size + 1)[1:] > SATURATED * size
    if on_ground is not None:
        outside = np.count_nonzero(on_ground & (labels == 0))
        result |= bool(outside > SATURATED * (labels.size - size.sum()))
    return result


def _notes(
    found: ContactAreas, levels: Levels, ground: Ground, left_out: int, drift: float
) -> Iterator[Note]:
    """Return notes on excluded regions and on uncertain values.

    `drift` is the grey level of the contacts minus the dark level in `levels`, over the contrast.
    """
    if levels.cut:
        yield Note(
            "all contacts are at the edge of the frame or merged: the blur is not measured; "
            "measure the image in one series with one of whole contacts"
        )
    elif levels.narrow:
        yield Note(
            "no contact is wide enough to show its dark level: areas may be wrong by more "
            "than their errors; measure the image in one series with larger contacts"
        )
    if left_out:
        yield information(
            f"{left_out} dark spot{'s' * (left_out > 1)} below {found.smallest_area:.2g} mm^2 left out"
        )
    contrast = 1.0 - levels.dark
    if ground.structure > UNEVEN * contrast:
        uneven = percent(ground.structure / contrast)
        yield Note(f"the ground is uneven by {uneven} of the contrast after removing the gradient")
    if drift:
        yield Note(
            f"the contacts are {'brighter' if drift > 0.0 else 'darker'} by {percent(abs(drift))} of the "
            "contrast than in the image at the largest load, and the errors of the areas are increased "
            "by what this may cause; keep lamp and exposure, or measure this image by itself"
        )
    yield from contact_notes(found)


def contact_notes(found: ContactAreas) -> Iterator[Note]:
    """Return notes that name contacts at the edge, merged, saturated or with bright spots inside."""
    for flags, text in (
        (found.edge, "at the edge of the frame; the area is what is seen of them"),
        (found.merged, "merged with others, or not convex; the area is that of all in one"),
        (found.saturated, "saturated: grey levels are cut off at an end of the scale; lower the exposure"),
    ):
        if flags.any():
            yield Note(f"{_named(found, flags)}: {text}")
    if (found.holes > 0).any():
        yield information(f"{_named(found, found.holes > 0)}: bright spots inside are left out")


def _named(found: ContactAreas, flags: NDArray[np.bool_]) -> str:
    """Return the numbers and centres of the flagged contacts as text."""
    which = np.flatnonzero(flags)
    parts = [
        f"{i + 1} at ({found.centre[i, 0]:.4g}, {found.centre[i, 1]:.4g}) mm" for i in which[:NAMED].tolist()
    ]
    more = f" and {which.size - NAMED} more" if which.size > NAMED else ""
    return f"contact{'s' * (which.size > 1)} {', '.join(parts)}{more}"
