"""Measurement of the contacts in an image, with notes on uncertain values."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration.images import errors, levels
from metafem.calibration.images.boundary import (
    Window,
    at_edge,
    contours,
    merged,
    pixels_of,
    saturated,
    semi_axes,
)
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.grey import Options, grey_values
from metafem.calibration.images.illumination import MAD, Ground, without_illumination
from metafem.calibration.images.levels import Levels
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information

# Smallest contrast of the contacts over the standard deviation of the noise of the smoothed image.
CONTRAST = 6.0

# Smallest radius of a measured contact, in standard deviations of the smoothed edge. For smaller contacts the
# area at the half level is less than three quarters of the contact area and depends strongly on noise.
SMALLEST = 2.0

# Smallest difference between grey levels, in standard deviations, that is not attributed to noise.
CLEAR = 3.0


def measured(image: Any, options: Options, found: Levels | None = None) -> tuple[ContactAreas, Levels]:
    """Return the contacts of an image and its levels; if `found` is not None, these levels are used."""
    values = grey_values(image)
    ground = without_illumination(values.astype(np.float32), options.bright_contacts)
    own = found is None
    if found is None:
        blur = None if options.blur is None else options.blur / options.pixel_size
        found = levels.measured_levels(ground, options.threshold, options.dark_level, blur)
    elif abs(ground.level / found.ground - 1.0) > 0.5 * (1.0 - found.dark):
        raise InvalidInput(
            f"image is all dark or bright, or has another exposure: the grey level of its ground is "
            f"{ground.level:.4g}, and that of the image at the largest load is {found.ground:.4g}"
        )
    return _contacts(values, ground, found, options, own), found


def _contacts(
    values: NDArray[Any], ground: Ground, found: Levels, options: Options, own: bool
) -> ContactAreas:
    """Return the contacts of an image with known levels; `own` states that the levels are from this image."""
    width = max(found.blur, levels.LEAST_SMOOTHING)
    image, variance = levels.smoothed(ground.corrected, width)
    labels, count = label(image < found.half)
    windows = find_objects(labels)
    contrast, scatter = 1.0 - found.dark, levels.smoothed_noise(image, labels, width)
    refuse_if(
        contrast < CONTRAST * max(scatter, 0.5 * ground.structure),
        f"image shows no contacts, it is all dark or bright: its grey levels differ by {contrast:.2g} of the "
        f"ground's, with noise of {scatter:.2g} after smoothing. If it has contacts too small for Otsu's "
        "method, give threshold and dark_level of an image with larger ones",
    )
    above = f"must be above the grey level {found.dark:.4g} of the contacts"
    refuse_if(not found.dark < found.threshold, f"threshold = {found.threshold:.4g} {above}")
    # smoothing reduces white noise n to n/(2 sqrt(pi) w)
    noise = 2.0 * math.sqrt(math.pi * variance) * scatter / contrast
    total = math.sqrt(found.blur**2 + variance)
    pixel = options.pixel_size
    least = math.pi * (SMALLEST * total) ** 2
    if options.smallest_area is not None:
        least = options.smallest_area / pixel**2
    size = pixels_of(labels, windows)
    # regions that are certainly too small are excluded here, others after their contours are known
    large = size >= max(0.5 * (least - math.pi * total**2), 4.0)
    if not large.all():
        labels = np.concatenate([[0], np.where(large, np.cumsum(large), 0)]).astype(np.int32)[labels]
        windows, size = [windows[i] for i in np.flatnonzero(large)], size[large]
    shape = contours(image, labels, found.half, size.size)
    area = errors.enclosed(shape.area, shape.holes.astype(np.float64), total)
    enough = area >= least
    edge = np.array([at_edge(w, image.shape, math.ceil(2.0 * total)) for w in windows], dtype=bool)
    counted = _counted(ground.corrected, labels, windows, found.threshold)
    # one step of integer grey levels, over the grey level of the ground
    step = 1.0 / abs(ground.level) if values.dtype.kind in "ui" else 0.0
    steps = errors.quantisation(noise, step / contrast)
    axes, angle = semi_axes(shape, total)
    joined = merged(shape, labels, windows) & ~edge
    drift = 0.0
    if not own:
        whole = enough & ~edge & ~joined & (shape.holes == 0)
        middle = _middle(image, shape.centre[whole], axes[whole], total)
        drift = _drift(middle, found, scatter, math.hypot(ground.structure, steps * contrast)) / contrast
    at_level = 0.5 * math.hypot(found.dark_scatter / contrast, ground.structure / contrast, steps, drift)
    error = errors.of_contour(
        shape.length, noise, math.sqrt(variance), total, at_level, found.blur_error * found.blur / total
    )
    clipped = saturated(values, labels[1:-1, 1:-1], size, options.bright_contacts)
    order = np.flatnonzero(enough)
    result = ContactAreas(
        area=area[order] * pixel**2,
        area_error=error[order] * pixel**2,
        otsu_area=counted[order] * pixel**2,
        centre=shape.centre[order] * pixel,
        axes=axes[order] * pixel,
        angle=angle[order],
        edge=edge[order],
        merged=joined[order],
        saturated=clipped[order],
        holes=shape.holes[order],
        threshold=found.threshold,
        dark_level=found.dark,
        blur=found.blur * pixel,
        noise=noise,
        pixel_size=pixel,
        shape=(values.shape[0], values.shape[1]),
        smallest_area=least * pixel**2,
    )
    return replace(result, notes=tuple(remarks(result, found, ground, count - len(order), drift)))


def _middle(image: NDArray[np.float32], centre: FloatArray, axes: FloatArray, total: float) -> FloatArray:
    """Return the grey levels in the middle of the contacts that are wide enough to show their dark level."""
    wide = axes[:, 1] > levels.DEEP * total
    x, y = centre[wide].T
    # the border shifts the pixels by 1
    level = image[(image.shape[0] - 1 - y).astype(int), x.astype(int) + 1].astype(np.float64)
    # share of the contrast that a smoothed circle retains in its middle
    shown = 1.0 - np.exp(-0.5 * axes[wide].prod(axis=1) / total**2)
    return np.asarray(1.0 - (1.0 - level) / shown)


def _drift(middle: FloatArray, found: Levels, scatter: float, common: float) -> float:
    """Return the median of the grey levels minus the dark level, 0 if the difference is not significant."""
    if not middle.size:
        return 0.0
    level = float(np.median(middle))
    spread = float(np.median(np.abs(middle - level))) / MAD
    # the variance of a median is pi/2 times the variance of a mean
    chance = math.sqrt(0.5 * math.pi / middle.size) * max(spread, scatter)
    away = level - found.dark
    return away if abs(away) > CLEAR * math.hypot(chance, found.dark_scatter, common) else 0.0


def _counted(
    corrected: NDArray[np.float32], labels: NDArray[np.int32], windows: list[Window], threshold: float
) -> FloatArray:
    """Return the number of pixels below the threshold in each region and near its edge."""
    counts = []
    for number, (rows, columns) in enumerate(windows, 1):
        # the border shifts the pixels by 1; the edge of the contact extends up to three pixels further on
        # each side
        window = (
            slice(max(rows.start - 4, 0), rows.stop + 2),
            slice(max(columns.start - 4, 0), columns.stop + 2),
        )
        owner = labels[1:-1, 1:-1][window]
        dark = (corrected[window] < threshold) & ((owner == number) | (owner == 0))
        counts.append(np.count_nonzero(dark))
    return np.array(counts, dtype=np.float64)


# Structure of the ground over the contrast above which there is a note. At this value the half level has an
# error of 1 % of the contrast.
UNEVEN = 0.02

# Largest number of contacts that a note names.
NAMED = 10


def remarks(
    found: ContactAreas, levels: Levels, ground: Ground, left_out: int, drift: float
) -> Iterator[Note]:
    """Return notes on excluded regions and on uncertain values.

    `drift` is the grey level of the contacts minus the dark level in `levels`, over the contrast.
    """
    if levels.cut:
        yield Note(
            "all contacts are at the edge of the frame or merged: the blur is not measured; give blur, "
            "or measure the image in one series with one of whole contacts"
        )
    elif levels.narrow:
        yield Note(
            "no contact is wide enough to show its dark level: areas may be wrong by more "
            "than their errors; give dark_level, threshold and blur of an image with larger contacts, or "
            "measure both in one series"
        )
    if levels.sparse:
        yield information(
            "the contacts cover too little of the image for Otsu's method, whose threshold is within the "
            "noise of the ground; the level half-way to the darkest region is used instead"
        )
    if left_out:
        yield information(
            f"{left_out} dark spot{'s' * (left_out > 1)} below {found.smallest_area:.2g} mm^2 left out"
        )
    if not ground.divided:
        yield information("the ground is so dark that it was subtracted, and not divided by")
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
        f"{i} at ({found.centre[i, 0]:.4g}, {found.centre[i, 1]:.4g}) mm" for i in which[:NAMED].tolist()
    ]
    more = f" and {which.size - NAMED} more" if which.size > NAMED else ""
    return f"contact{'s' * (which.size > 1)} {', '.join(parts)}{more}"
