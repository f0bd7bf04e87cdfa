"""Contact areas in images of the contact interface, with their errors.

Lengths are in pixels, and grey levels are divided by the contrast. A contact has the perimeter L and the
radius r. n is the noise of a pixel. The edge is a step blurred by a Gaussian of standard deviation s. The
image is smoothed again by a Gaussian of standard deviation w before the contour is found. The edge then has
the variance s_t² = s² + w² and the slope 1/(sqrt(2 pi) s_t) at the half level.

Noise. The smoothed noise over the slope is the displacement of the contour. The error of the area is the
integral of this displacement along the contour. Its variance is 2 pi s_t² L n²/(2 sqrt(pi) w), which has the
minimum 2 sqrt(pi) s L n² at w = s. This minimum is the Cramér-Rao bound for a straight edge of length L.

Curvature. Smoothing by s moves a contour of curvature kappa at the half level by s² kappa/2 towards its
centre of curvature. The curvature of a closed contour integrates to 2 pi. Therefore the area of any shape
shrinks by pi s², and grows by pi s² for each hole. For a circle, the half level follows from the median of
the noncentral chi-square distribution with two degrees of freedom; the next term is pi s² s²/(6 r²).

Level. An error d of the half level displaces the whole contour by d sqrt(2 pi) s_t.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, distance_transform_edt, gaussian_filter, label, maximum, mean
from scipy.stats import trim_mean

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.errors import InvalidInput, refuse_if, refuse_missing, shown
from metafem.notes import Note
from metafem.progress import each

# Smallest number of pixels along the shorter side of an image, enough for one contact and the ground around
# it.
FEWEST = 16

# Largest possible grey levels, since cameras with 10 to 14 bits store 16 bits. A picture is saturated if more
# than the share SATURATED of its pixels, a hundredth of contacts that cover a tenth of it, is at an end.
FULL_SCALE, SATURATED = tuple(2**bits - 1 for bits in (8, 10, 12, 14, 16, 32)), 1e-3

# Degree of the ground's polynomial in each coordinate: a gradient, and a lens that is darker at its corners.
DEGREE = 2

# Number of blocks along the shorter side of the image, and smallest size of a block [pixels].
BLOCKS, LEAST_BLOCK = 96, 4

# Largest distance between a block of the ground and the surface, in standard deviations; largest number of
# iterations, of which the first ABOVE ones keep the blocks above the surface, so that contacts may cover two
# thirds of the image; smallest standard deviation over the range of the blocks.
CLIPPED, ROUNDS, ABOVE, EXACT = 3.0, 25, 2, 1e-4

# Ratio of the median absolute deviation to the standard deviation of a normal distribution.
MAD = 0.6745

# An image with bright contacts is divided by its ground if the ground exceeds FAINT times the contrast, which
# is not the case in a dark field; one with dark contacts, if the ground exceeds FAINT² times its mean level.
FAINT = 0.2

# Smallest standard deviation of the smoothing [pixels], because pixels do not resolve narrower kernels, and
# number of standard deviations at which the kernel is cut off, which changes its variance by 1e-5.
LEAST_SMOOTHING, CUT_OFF = 1.0, 5.0

# Largest number of contacts used for the levels, and the smallest ratio of their depth to the largest depth.
# The depth of a contact is the distance from its edge to its deepest pixel.
MOST, AS_DEEP = 64, 0.5

# Depth [pixels] beyond which a contact shows its dark level: four standard deviations of an edge after a blur
# of 1.5 pixels and the first smoothing; least depth of the widest contact, in standard deviations of an edge,
# below which the contrast lost in its middle changes areas by more than 0.5 %.
CORE, DEEP = 7.0, 4.0

# Distance between pixels with nearly independent noise in a smoothed image, in standard deviations of the
# smoothing; the correlation is exp(-9/4), about 0.1.
INDEPENDENT = 3.0

# Error of the blur if it cannot be measured [pixels]; typical optics have a blur of 0.5 to 2 pixels.
UNKNOWN_BLUR = 0.5

# Smoothing before Otsu's threshold [pixels]: contacts that cover a thousandth of the image stand out of noise
# of a tenth of their contrast.
WIDE = 2.0

# Smallest contrast of the contacts over the noise of the smoothed ground; smallest radius of a measured
# contact, in standard deviations of the smoothed edge, below which the half level encloses less than three
# quarters of it.
CONTRAST, SMALLEST = 6.0, 2.0

# Polygons from marching squares lie inside smooth contours, because the interpolation is linear and the sides
# are chords. For any shape and blur, the lost area is pi times INTERPOLATION [pixels²]. The variance of an
# edge that is measured from its quarter levels is too large by EDGE_INTERPOLATION [pixels²] and, for a
# circle, by the relative amount EDGE_CURVATURE s_t²/r². The numbers were determined with circles of radius 15
# to 120 at random positions and s_t of 1.4 to 3.5.
INTERPOLATION, EDGE_INTERPOLATION, EDGE_CURVATURE = 0.21, 0.13, 0.5

# Compactness below which a contact counts as merged. Two touching circles whose radii have a ratio between 1
# and 0.3 have a compactness of 0.89 to 0.95. Noise of the boundary changes the compactness only in second
# order.
COMPACT = 0.97

# Pixels around a region in which its contours at other levels are sought.
MARGIN = 4

# Attributes of `ContactAreas` that have one value or point for each contact, and their types.
CONTACT: list[Any] = [
    *(("area", "f8"), ("area_error", "f8"), ("centre", "f8", 2), ("axes", "f8", 2), ("angle", "f8")),
    *(("edge", "?"), ("merged", "?")),
]

# What is said of levels in doubt.
DOUBT = (
    "no whole contact is wide enough to show its dark level and its blur: areas may be wrong by more than "
    "their errors; measure the image in one series with larger contacts"
)


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
        Semi-axes of the ellipses with the second moments of the dark pixels, the longer axis first [mm].
    angle : ndarray, (n,)
        Angle of the longer axis from the x axis, anticlockwise, from -pi/2 to pi/2 [rad].
    edge, merged : ndarray of bool, (n,)
        Whether a contact is at the edge of the frame, or consists of merged contacts.
    dark_level : float
        Grey level of wide contacts over the grey level of the ground [-].
    blur : float
        Standard deviation of the Gaussian blur of the contact edges [mm].
    pixel_size : float
        Side of a pixel [mm].
    shape : tuple of int
        Rows and columns of the image.
    smallest_area : float
        Area below which a dark region does not count as a contact [mm^2].
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
    dark_level: float
    blur: float
    pixel_size: float
    shape: tuple[int, int]
    smallest_area: float = 0.0
    notes: tuple[Note, ...] = ()

    @property
    def count(self) -> int:
        """Number of contacts."""
        return len(self.area)

    @property
    def complete(self) -> NDArray[np.bool_]:
        """Whether each contact is neither at the edge of the frame nor merged, (n,)."""
        return ~(self.edge | self.merged)


class Levels(NamedTuple):
    """Grey level of the ground, dark level of the contacts over it, and blur of the edges [pixels].

    The errors are standard deviations; that of the dark level includes its scatter among contacts.
    """

    ground: float
    dark: float
    blur: float
    dark_error: float = 0.0
    blur_error: float = UNKNOWN_BLUR

    @property
    def half(self) -> float:
        """Grey level half-way between ground and dark level."""
        return 0.5 * (1.0 + self.dark)

    @property
    def total(self) -> float:
        """Standard deviation of the edges after the smoothing, s_t [pixels]."""
        return math.hypot(self.blur, max(self.blur, LEAST_SMOOTHING))

    @property
    def least(self) -> float:
        """Smallest area of a contact [pixels²]."""
        return math.pi * (SMALLEST * self.total) ** 2


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
        If the image has values that are not finite grey levels, a saturated frame around it, or no
        contacts.

    Notes
    -----
    n is the standard deviation of the noise of a pixel over the contrast. If an area has the perimeter L,
    noise causes an error of ``n sqrt(2 sqrt(pi) s L)`` square pixels. For n = 0.05 and s = 1.5 pixels this is
    0.3, 0.1 and 0.03 % of the area at radii of 10, 20 and 50 pixels. `area_error` also includes the scatter
    of the grey levels of the contacts, and the errors of the dark level and of s, which are
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
    images: Sequence[Any],
    pixel_size: float,
    loads: Any = None,
    *,
    names: Sequence[str] | None = None,
    bright_contacts: bool = False,
) -> tuple[list[ContactAreas | None], list[Note]]:
    """Return the contacts in k images, measured with the levels of the image at the largest load.

    The image at the largest load determines the dark level and the blur, because narrow contacts at
    smaller loads may not show them; lamp and exposure must be the same in all images. If this image cannot be
    measured, the image at the next smaller load is used instead. The images are read one at a time, from the
    largest load to the smallest.

    Parameters
    ----------
    images : sequence of array_like, (rows, columns), or of functions
        Images as for `contact_areas`, or functions without arguments that read them.
    pixel_size : float
        Side of a pixel [mm].
    loads : array_like, (k,), optional
        Normal loads [N]; default: the last image is assumed to have the largest load.
    names : sequence of str, (k,), optional
        Names of the images in notes; default: "image 1" and so on.
    bright_contacts : bool
        As for `contact_areas`.

    Returns
    -------
    areas : list of ContactAreas or None, (k,)
        Contacts of each image, in the order of the images; None for an image that cannot be measured.
    notes : list of Note
        The notes of each image, and why an image could not be measured.

    Raises
    ------
    InvalidInput
        If no image can be measured, or if an argument is outside its range.

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> images = [200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - r)) for r in (8.0, 14.0, 20.0)]
    >>> found, notes = stack_areas([np.zeros((60, 80)), *images], 0.005, loads=[0.0, 0.1, 0.2, 0.3])
    >>> [areas and areas.count for areas in found], str(notes[0])[:23]
    ([None, 1, 1, 1], 'image 1 is not measured')
    """
    refuse_missing("skimage", "images", "measuring contact areas")
    pixel = check.number("pixel_size", pixel_size, above=0.0)
    count = len(images)
    refuse_if(not count, "images is empty; it must hold at least one image")
    load = np.arange(count) if loads is None else check.array("loads", loads, shape=(count,))
    name = names or [f"image {i + 1}" for i in range(count)]
    found: list[ContactAreas | None] = [None] * count
    notes: list[list[Note]] = [[]] * count
    levels = None
    for i in each("measuring image", np.argsort(-load, kind="stable").tolist()):
        try:
            image = images[i]
            areas, levels = _measured(image() if callable(image) else image, pixel, bright_contacts, levels)
        except InvalidInput as error:
            notes[i] = [Note(f"{name[i]} is not measured: {error}")]
            continue
        found[i], notes[i] = areas, [Note(f"{name[i]}: {note}") for note in areas.notes]
    said = [note for own in notes for note in own]
    refuse_if(levels is None, f"none of the images can be measured: {said[:1] and said[0]}")
    return found, said


def grey_values(image: Any) -> NDArray[Any]:
    """Return the grey values of an image, (rows, columns), row 0 at the top, in the original data type."""
    values = np.asarray(image)
    wrong = values.dtype.kind not in "uif" or values.ndim != 2 or min(values.shape) < FEWEST
    refuse_if(
        wrong or np.ma.is_masked(image),
        f"image = {shown(image)}, {values.dtype} of shape {values.shape}, must be grey values without mask, "
        f"(rows, columns), at least {FEWEST} of each; `metafem images` reads files",
    )
    low, high = float(values.min()), float(values.max())
    holds = f"image holds grey values from {low:g} to {high:g}"
    refuse_if(not low < high < math.inf, f"{holds}, all dark, all bright or not finite: it shows no contact")
    return values


def _measured(
    image: Any, pixel: float, bright: bool, given: Levels | None = None
) -> tuple[ContactAreas, Levels]:
    """Return the contacts of an image and its levels, which may be those of another image."""
    values = grey_values(image)
    ends = (values == 0) | ((values == values.max()) & (values.max() in FULL_SCALE))
    framed = ends[[0, -1]].all() and ends[:, [0, -1]].all()
    refuse_if(framed, "image has a saturated frame: crop it, since the ground is sought up to the edges")
    corrected, ground = without_illumination(values.astype(float), bright)
    levels, notes = (given, []) if given else _levels(corrected, ground)
    contrast, width = 1.0 - levels.dark, max(levels.blur, LEAST_SMOOTHING)
    refuse_if(
        abs(ground / levels.ground - 1.0) > 0.5 * contrast,
        f"image is all dark or bright, or has another exposure: the grey level of its ground is "
        f"{ground:.4g}, and that of the image at the largest load is {levels.ground:.4g}",
    )
    smooth = gaussian_filter(corrected, width, truncate=CUT_OFF)
    labels, _ = label(smooth < levels.half)
    scatter = smoothed_noise(smooth, labels, width)
    around = any(region.bbox == (0, 0, *values.shape) for region in _regions(labels))
    hint = "" if bright else "If contacts are brighter than the ground, give --bright-contacts. "
    refuse_if(
        around or contrast < CONTRAST * scatter,
        "image is all dark or bright, or a dark region surrounds it: its grey levels differ by "
        f"{contrast:.2g} of the ground's, with noise of {scatter:.2g} after smoothing. {hint}Crop a dark "
        "frame; measure very small contacts in a series with larger ones",
    )
    if values.dtype.kind in "ui" and ends.mean() > SATURATED:
        notes = [*notes, Note("saturated: grey levels are at an end of the scale; lower the exposure")]
    result = ContactAreas(
        **_contacts(smooth, labels, levels, scatter / contrast, pixel),
        dark_level=levels.dark,
        blur=levels.blur * pixel,
        pixel_size=pixel,
        shape=values.shape,
        smallest_area=levels.least * pixel**2,
        notes=tuple(notes),
    )
    return result, levels


def _contacts(
    smooth: FloatArray, labels: NDArray[np.int32], levels: Levels, scatter: float, pixel: float
) -> dict[str, Any]:
    """Return the attributes in `CONTACT` of the contacts; `scatter` is the noise over the contrast."""
    rows, total, width = [], levels.total, max(levels.blur, LEAST_SMOOTHING)
    # smoothing reduces white noise n to n/(2 sqrt(pi) w)
    noise, at_level = (
        2.0 * math.sqrt(math.pi) * width * scatter,
        0.5 * levels.dark_error / (1.0 - levels.dark),
    )
    blur_error = levels.blur_error * levels.blur / total
    for region in _regions(labels):
        inside, length, holes = contour(_window(smooth, labels, region), levels.half)
        # within the contour of a circle of the least area is three quarters of it; the series for still
        # smaller ones diverges
        area = enclosed(inside, holes, total) if 2.0 * inside > levels.least else 0.0
        if area >= levels.least:
            error = of_contour(length, noise, width, total, at_level, blur_error)
            centre = pixel * np.array([region.centroid[1] + 0.5, len(smooth) - 0.5 - region.centroid[0]])
            axes = 0.5 * pixel * np.array([region.axis_major_length, region.axis_minor_length])
            angle = math.remainder(region.orientation + 0.5 * math.pi, math.pi)
            edge = _at_edge(region, smooth.shape, math.ceil(2.0 * total))
            merged = not edge and not _single(region)
            rows.append((area * pixel**2, error * pixel**2, centre, axes, angle, edge, merged))
    found = np.array(rows, dtype=CONTACT)
    return {name: found[name].copy() for name, *_ in CONTACT}


def without_illumination(image: FloatArray, bright: bool) -> tuple[FloatArray, float]:
    """Return the image with corrected illumination, and the mean grey level of its ground.

    The corrected image is 1 on the ground and smaller in the contacts. The ground is a polynomial of degree 2
    in each coordinate, fitted to the interquartile means of blocks; clipping excludes the blocks that contain
    contacts.
    """
    sign, size = -1.0 if bright else 1.0, max(min(image.shape) // BLOCKS, LEAST_BLOCK)
    rows, columns = (length // size for length in image.shape)
    parts = image[: rows * size, : columns * size].reshape(rows, size, columns, size).swapaxes(1, 2)
    # the median of whole grey levels would be a whole one
    blocks = sign * trim_mean(parts.reshape(rows, columns, -1), 0.25, axis=2)
    y, x = (_along(length // size, size, length) for length in image.shape)
    terms = legendre.legvander2d(*np.meshgrid(y, x, indexing="ij"), deg=[DEGREE, DEGREE])
    coefficients, contrast = _fitted(terms, blocks)
    y, x = (_along(length, 1, length) for length in image.shape)
    light = sign * legendre.leggrid2d(y, x, coefficients)
    level = float(light.mean())
    divided = float(light.min()) > (FAINT * contrast if bright else FAINT**2 * level)
    scale = light if divided else contrast
    return 1.0 + sign * (image - light) / scale, level


def _along(count: int, size: int, length: int) -> FloatArray:
    """Return the centres of blocks along an axis, -1 to 1 from one edge of the image to the other."""
    return 2.0 * size * (np.arange(count) + 0.5) / length - 1.0


def _fitted(terms: NDArray[Any], blocks: FloatArray) -> tuple[FloatArray, float]:
    """Return the coefficients of the ground, and the largest distance of a block from it.

    Contacts lie below the surface. The first surfaces are fitted to the blocks above the one before.
    """
    on_ground: NDArray[np.bool_] = np.ones(blocks.shape, dtype=bool)
    exact, least = EXACT * float(np.ptp(blocks)), 2 * terms.shape[2]
    for number in range(ROUNDS):
        coefficients = np.linalg.lstsq(terms[on_ground], blocks[on_ground], rcond=None)[0]
        height = blocks - terms @ coefficients
        above = height[on_ground & (height > 0.0)]
        sd = max(float(np.median(above)) / MAD if above.size else 0.0, exact)
        before, on_ground = on_ground, height > 0.0
        if number >= ABOVE:
            dark = height < -CLIPPED * sd
            clear = ~binary_dilation(dark, np.ones((3, 3)))
            on_ground = (clear if clear.sum() > least else ~dark) & (height < 2.0 * CLIPPED * sd)
        if np.array_equal(before, on_ground) or on_ground.sum() < least:
            break
    return np.reshape(coefficients, (DEGREE + 1, DEGREE + 1)), float(np.abs(height).max())


def smoothed_noise(smooth: FloatArray, labels: NDArray[np.int32], width: float) -> float:
    """Return the standard deviation of the noise of a smoothed image, from differences on its ground."""
    apart = math.ceil(INDEPENDENT * width)
    clear = ~binary_dilation(labels > 0, iterations=apart)
    difference = (smooth[:, apart:] - smooth[:, :-apart])[clear[:, apart:] & clear[:, :-apart]]
    return float(np.median(np.abs(difference))) / MAD / math.sqrt(2.0) if difference.size else 0.0


def _regions(labels: NDArray[np.int32]) -> list[Any]:
    from skimage.measure import regionprops

    return list(regionprops(labels))  # type: ignore[no-untyped-call]


def _at_edge(region: Any, shape: tuple[int, ...], margin: int = 0) -> bool:
    """Return whether a region is within `margin` pixels of the frame's edge."""
    top, left, bottom, right = region.bbox
    return bool(min(top, left, shape[0] - bottom, shape[1] - right) <= margin)


def _single(region: Any) -> bool:
    """Return whether a region, after its holes are filled, is one contact and not two merged ones.

    The compactness is the squared ratio of the area to the area of the ellipse with the same moments. It is 1
    for ellipses, because no other shape of this area has smaller moments.
    """
    (filled,) = _regions(region.image_filled.astype(np.int32))
    ellipse = 0.25 * math.pi * float(filled.axis_major_length * filled.axis_minor_length)
    return bool(filled.area**2 >= COMPACT * ellipse**2)


def _window(smooth: FloatArray, labels: NDArray[np.int32], region: Any) -> FloatArray:
    """Return the part of an image around a region, without other regions and with a border of ground."""
    around = tuple(slice(max(s.start - MARGIN, 0), s.stop + MARGIN) for s in region.slice)
    own = (labels[around] == 0) | (labels[around] == region.label)
    return np.pad(np.where(own, smooth[around], 1.0), 1, constant_values=1.0)


def contour(window: FloatArray, level: float) -> tuple[float, float, int]:
    """Return the area of the one region of a window that is darker than the level, the length of its
    contours, and the number of its holes [pixels].

    The contours are polygons from marching squares; they enclose less area than smooth contours
    (`INTERPOLATION`). The longest one is the boundary of the region, and the others are its holes.
    """
    from skimage.measure import find_contours

    lines = find_contours(window, level, fully_connected="high")  # type: ignore[no-untyped-call]
    area = [abs(np.sum(y[:-1] * x[1:] - y[1:] * x[:-1])) / 2.0 for y, x in (line.T for line in lines)]
    length = sum(float(np.hypot(*np.diff(line, axis=0).T).sum()) for line in lines)
    whole = 2.0 * max(area, default=0.0) - sum(area)  # below 0 in an image of noise alone
    return max(float(whole), 0.0), length, max(len(lines) - 1, 0)


def enclosed(area: float, holes: int, total: float) -> float:
    """Return the area of a contact from the `area` within its contour at the half level; `total` is s_t."""
    variance = total**2 + INTERPOLATION
    return area + math.pi * variance * (1.0 - holes) + (math.pi * total**2) ** 2 / (6.0 * area)


def of_contour(
    length: float, noise: float, smoothing: float, total: float, level: float, blur: float
) -> float:
    """Return the standard deviation of an area from the noise and the errors of the level and of s_t."""
    from_noise = 2.0 * math.pi * total**2 * length * noise**2 / (2.0 * math.sqrt(math.pi) * smoothing)
    from_level = math.sqrt(2.0 * math.pi) * total * length * level
    return math.sqrt(from_noise + from_level**2 + (2.0 * math.pi * total * blur) ** 2)


def _levels(corrected: FloatArray, ground: float) -> tuple[Levels, list[Note]]:
    """Return the levels of an image, measured in its widest contacts, and a note if they are in doubt.

    The blur follows from the areas within the contours at the two quarter levels, which are 2 x 0.6745
    standard deviations apart at a straight edge.
    """
    from skimage.filters import threshold_otsu

    wide = np.minimum(gaussian_filter(corrected, WIDE), 1.0)  # without bad pixels and a bright frame
    dark = wide[wide < threshold_otsu(wide)]  # type: ignore[no-untyped-call]
    first = Levels(ground, float(np.median(dark)), LEAST_SMOOTHING)
    smooth = gaussian_filter(corrected, LEAST_SMOOTHING, truncate=CUT_OFF)
    labels, count = label(smooth < first.half)
    if not count:
        return first, [Note(DOUBT)]
    regions = sorted(_regions(labels), key=lambda region: -region.area)[:MOST]
    whole = [region for region in regions if not _at_edge(region, smooth.shape) and _single(region)]
    windows = {region.label: _window(smooth, labels, region) for region in whole or regions[:1]}
    depth = distance_transform_edt(np.pad(np.isin(labels, [*windows]), 1))[1:-1, 1:-1]
    deepest = maximum(depth, labels, np.arange(count + 1))
    inner = np.maximum(0.5 * deepest, np.minimum(deepest - 1.0, CORE))[labels]
    core = np.where((depth >= inner) & (depth >= 0.5 * AS_DEEP * deepest.max()), labels, 0)
    number, pixels = np.unique(core[core > 0], return_counts=True)
    cores = mean(smooth, core, number)
    dark = float(np.median(cores))
    scatter = _scatter(cores, smoothed_noise(smooth, labels, LEAST_SMOOTHING), pixels)
    if not whole:
        return first._replace(dark=dark, dark_error=scatter), [Note(DOUBT)]
    edge = np.array([_edge(windows[i], dark) for i in number.tolist()])
    total = float(np.median(edge))
    blur = math.sqrt(max(total**2 - LEAST_SMOOTHING**2, 0.0))
    # the error of s follows from the error of s_t, since the variance of the smoothing is exact
    error = float(np.median(np.abs(edge - total))) / MAD / math.sqrt(edge.size)
    error *= total / max(blur, LEAST_SMOOTHING)
    return Levels(ground, dark, blur, scatter, error), [Note(DOUBT)] * int(deepest.max() < DEEP * total)


def _scatter(cores: FloatArray, noise: float, pixels: IntArray) -> float:
    """Return the standard deviation of the dark level among contacts, including the error of their median.

    After smoothing by a Gaussian of variance w², the noise has one independent value per 4 pi w² pixels.
    """
    spread = (float(np.median(np.abs(cores - np.median(cores)))) / MAD) ** 2
    by_noise = float(np.mean(noise**2 / np.maximum(pixels / (4.0 * math.pi * LEAST_SMOOTHING**2), 1.0)))
    # the variance of a median is pi/2 times the variance of a mean
    return math.sqrt(max(spread - by_noise, 0.0) + 0.5 * math.pi * max(spread, by_noise) / cores.size)


def _edge(window: FloatArray, dark: float) -> float:
    """Return the standard deviation of the edge of a contact [pixels]."""
    (outer, *_), (middle, length, _), (inner, *_) = (
        contour(window, dark + share * (1.0 - dark)) for share in (0.75, 0.5, 0.25)
    )
    if not inner:
        return LEAST_SMOOTHING
    variance = ((outer - inner) / (2.0 * MAD * length)) ** 2
    square = middle / math.pi + variance
    variance -= EDGE_INTERPOLATION + EDGE_CURVATURE * variance**2 / square
    return math.sqrt(max(variance, 0.0))
