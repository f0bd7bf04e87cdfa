"""Areas of the dark contacts in an image, with their errors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._extras import refuse_missing
from metafem._validate import FloatArray, IntArray
from metafem.calibration.images import errors, levels
from metafem.calibration.images.boundary import Contours, contours
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.grey import clipped, grey_values
from metafem.calibration.images.illumination import Ground, otsu, without_illumination
from metafem.calibration.images.levels import Levels
from metafem.calibration.images.remarks import remarks
from metafem.errors import InvalidInput

# A contrast is that of contacts if it is so many standard deviations of the noise of the smoothed image.
CONTRAST = 6.0

# Least radius of a contact that is measured, in standard deviations of the smoothed edge: below it, the area
# of the half level is less than three quarters of the contact's, and grows so steeply that noise decides.
SMALLEST = 2.0

# Share of a contact's grey levels at an end of the scale above which it is saturated.
SATURATED = 0.01

# A contact is merged if its convex hull is larger by this share of its area: for two circles that touch it is
# 0.14, and 0.07 if the radius of one is 0.3 of the other's. The noise of the boundary, twice its displacement
# times the perimeter, is added.
HOLLOW = 0.04


@checked_call
def contact_areas(
    image: Any,
    pixel_size: float,
    *,
    threshold: float | None = None,
    dark_level: float | None = None,
    blur: float | None = None,
    subpixel: bool = True,
    bright_contacts: bool = False,
    smallest_area: float | None = None,
) -> ContactAreas:
    """Measure the areas of the contacts in an image, dark on a brighter ground.

    The image is divided by its ground, a polynomial of degree 2 in x and in y. Contacts are the regions
    within the contour half-way between the grey levels of the ground, 1, and of wide contacts, in the image
    smoothed by a Gaussian as wide as its own blur s, which has the least noise. The blur moves that contour
    inwards by s_t²/2 times its curvature, with s_t² the variance of both. So the contour encloses, for any
    shape, ``pi s_t²`` less than the contact, and this is added, with the next term ``pi s_t⁴/(6 r²)`` of a
    circle.

    Parameters
    ----------
    image : array_like, (rows, columns)
        Grey values, integers or floats; row 0 is the uppermost.
    pixel_size : float
        Side of a pixel [mm].
    threshold : float, optional
        Threshold of `otsu_area`, over the grey level of the ground [-]; default: by Otsu's method.
    dark_level : float, optional
        Grey level of contacts, over that of the ground [-]; default: that of the widest contacts.
    blur : float, optional
        Standard deviation of the edges, that of the optics and of the pixels together [mm]; default: from the
        distance of the quarter levels at the edges of the widest contacts.
    subpixel : bool
        Whether `area` is found with the contour; if not, it is `otsu_area`, and `area_error` contains the
        bias of that; default: True.
    bright_contacts : bool
        Whether contacts are brighter than the ground; default: False.
    smallest_area : float, optional
        Area below which dark regions are left out [mm^2]; default: a circle with the radius 2 s_t.

    Returns
    -------
    ContactAreas

    Raises
    ------
    InvalidInput
        If the image is not one of finite grey values, or shows no contacts.

    Notes ----- The error of an area with the perimeter L is, for noise of standard deviation n of each pixel
    over the contrast, ``n sqrt(2 sqrt(pi) s L)`` pixels: 0.3, 0.1 and 0.03 % at radii of 10, 20 and 50 pixels
    with n = 0.05 and s = 1.5 pixels. To it are added the scatter of the levels of ground and contacts, and
    the error of s. Contacts of radius below 2 s_t are not found. The method of Otsu, IEEE Trans. Syst. Man
    Cybern. 9, 62 (1979), doi:10.1109/TSMC.1979.4310076, is that of Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234.

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
    pixel = check.number("pixel_size", pixel_size, above=0.0)
    given = {
        name: None if value is None else check.number(name, value, **bounds)
        for name, value, bounds in (
            ("threshold", threshold, {"above": 0.0}),
            ("dark_level", dark_level, {}),
            ("blur", blur, {"at_least": 0.0}),
            ("smallest_area", smallest_area, {"at_least": 0.0}),
        )
    }
    for name in ("threshold", "dark_level"):
        if (value := given[name]) is not None and value >= 1.0:
            raise InvalidInput(f"{name} = {value:g} must be below 1, the grey level of the ground")
    values = grey_values(image)
    ground = without_illumination(values.astype(np.float32), bool(bright_contacts))
    known = given["threshold"] is not None and given["dark_level"] is not None and given["blur"] is not None
    in_pixels = None if given["blur"] is None else given["blur"] / pixel
    if known:
        found = Levels(given["threshold"] or 0.0, given["dark_level"] or 0.0, in_pixels or 0.0)
    else:
        level = otsu(ground.corrected) if given["threshold"] is None else given["threshold"]
        found = levels.measured_levels(ground.corrected, level, given["dark_level"], in_pixels)
    least = None if given["smallest_area"] is None else given["smallest_area"] / pixel**2
    return measure(values, ground, found, pixel, subpixel, least, known, bool(bright_contacts))


def measure(
    values: NDArray[Any],
    ground: Ground,
    found: Levels,
    pixel: float,
    subpixel: bool,
    least: float | None,
    known: bool,
    bright_contacts: bool,
) -> ContactAreas:
    """Measure the contacts of an image whose levels are known."""
    from scipy.ndimage import find_objects, label

    width = max(found.blur, levels.LEAST_SMOOTHING)
    image, variance = levels.smoothed(ground.corrected, width)
    labels, count = label(image < found.half)
    contrast, scatter = 1.0 - found.dark, levels.smoothed_noise(image, labels, width)
    if contrast < CONTRAST * max(scatter, 0.5 * ground.structure):
        raise InvalidInput(
            f"image shows no contacts, it is all dark or bright: its grey levels differ by {contrast:.2g} "
            f"of the ground's, with noise of {scatter:.2g} after smoothing. If it has contacts too small for "
            "Otsu's method, give threshold and dark_level of an image with larger ones"
        )
    # white noise of the standard deviation n is n/(2 sqrt(pi) w) after the smoothing
    noise = 2.0 * math.sqrt(math.pi * variance) * scatter / contrast
    total = math.sqrt(found.blur**2 + variance)
    least = math.pi * (SMALLEST * total) ** 2 if least is None else least
    size = np.bincount(labels.ravel(), minlength=count + 1)
    # regions that are certainly too small are dropped before, others after their contours are known
    kept = size >= max(0.5 * (least - math.pi * total**2), 4.0)
    kept[0] = False
    labels = np.where(kept, np.cumsum(kept), 0).astype(np.int32)[labels]
    number = int(kept.sum())
    shape = contours(image, labels, found.half, number)
    area = errors.enclosed(shape.area, shape.holes.astype(np.float64), total)
    enough = area >= least
    windows = find_objects(labels)
    edge = np.array([levels.at_edge(w, image.shape, math.ceil(2.0 * total)) for w in windows], dtype=bool)
    counted = _counted(ground.corrected, labels, windows, found.threshold)
    at_level = 0.5 * math.hypot(found.dark_scatter, ground.structure) / contrast
    error = errors.of_contour(
        shape.length, noise, math.sqrt(variance), total, at_level, found.blur_error * found.blur / total
    )
    if not subpixel:
        relative = (1.0 - found.threshold) / contrast
        area, error = counted, errors.of_counting(shape.length, noise, relative, found.blur)
    displaced = math.sqrt(2.0 * math.pi) * total * scatter / contrast
    hollow = HOLLOW + 2.0 * displaced * shape.length / shape.area
    solidity = shape.solidity * (1.0 + _hole_pixels(labels, windows, shape.holes) / shape.area)
    axes, angle = _ellipses(shape, total)
    order = np.flatnonzero(enough)
    result = ContactAreas(
        area=area[order] * pixel**2,
        area_error=error[order] * pixel**2,
        otsu_area=counted[order] * pixel**2,
        centre=shape.centre[order] * pixel,
        axes=axes[order] * pixel,
        angle=angle[order],
        edge=edge[order],
        merged=(solidity < 1.0 / (1.0 + hollow))[order],
        saturated=_saturated(values, labels, number, bright_contacts)[order],
        holes=shape.holes[order],
        threshold=found.threshold,
        dark_level=found.dark,
        blur=found.blur * pixel,
        noise=noise,
        pixel_size=pixel,
        shape=(values.shape[0], values.shape[1]),
    )
    return remarks(result, found, ground, count - len(order), least * pixel**2, known)


def _ellipses(shape: Contours, total: float) -> tuple[FloatArray, FloatArray]:
    """Return the semi-axes (n, 2) and the angles of the ellipses with the same moments.

    The contour lies s²/2 times its curvature inside of the boundary. The integral of x² over that strip is
    pi s² a³/(a + b) for an ellipse with the semi-axes a along x and b along y.
    """
    xx, yy, xy = shape.moment.T
    middle, half = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    moments = np.stack([middle + half, np.maximum(middle - half, 0.0)], axis=1)
    axes = 2.0 * np.sqrt(moments / shape.area[:, None])
    lost = math.pi * total**2
    added = lost * axes**3 / axes.sum(axis=1, keepdims=True)
    return 2.0 * np.sqrt((moments + added) / (shape.area[:, None] + lost)), 0.5 * np.arctan2(
        2.0 * xy, xx - yy
    )


def _hole_pixels(labels: NDArray[np.int32], windows: list[Any], holes: IntArray) -> FloatArray:
    """Return the numbers of pixels in the holes of each region."""
    from scipy.ndimage import binary_fill_holes

    pixels = np.zeros(len(windows))
    for i in np.flatnonzero(holes):
        region = labels[windows[i]] == i + 1
        pixels[i] = np.count_nonzero(binary_fill_holes(region)) - np.count_nonzero(region)
    return pixels


def _counted(
    corrected: NDArray[np.float32], labels: NDArray[np.int32], windows: list[Any], threshold: float
) -> FloatArray:
    """Return the numbers of pixels below the threshold in each region and around it."""
    counts = []
    for number, (rows, columns) in enumerate(windows, 1):
        # the border shifts the pixels by one; three more on each side belong to the edge of the contact
        window = (
            slice(max(rows.start - 4, 0), rows.stop + 2),
            slice(max(columns.start - 4, 0), columns.stop + 2),
        )
        owner = labels[1:-1, 1:-1][window]
        dark = (corrected[window] < threshold) & ((owner == number) | (owner == 0))
        counts.append(np.count_nonzero(dark))
    return np.array(counts, dtype=np.float64)


def _saturated(
    values: NDArray[Any], labels: NDArray[np.int32], count: int, bright_contacts: bool
) -> NDArray[np.bool_]:
    """Return which contacts have too many grey levels at an end of the scale; the ground counts for all."""
    ends = clipped(values)
    if bright_contacts:
        ends = ends[::-1]
    inner = labels[1:-1, 1:-1]
    in_contact, on_ground = ends
    size = np.bincount(inner.ravel(), minlength=count + 1)
    result = np.zeros(count, dtype=bool)
    if in_contact is not None:
        result |= np.bincount(inner[in_contact], minlength=count + 1)[1:] > SATURATED * size[1:]
    if on_ground is not None:
        result |= bool(np.count_nonzero(on_ground & (inner == 0)) > SATURATED * size[0])
    return result
