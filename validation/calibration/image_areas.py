"""Contact areas from synthetic images: scatter and bias of the sub-pixel boundary and of Otsu's threshold."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, label
from skimage.filters import threshold_otsu

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration import ContactAreas, contact_areas
from metafem.calibration.images import contour
from metafem.drawing import ACHIEVED, QUIET, TARGET
from validation.check import Claim, Picture, Row, below, near, reported, rms
from validation.figures import panels
from validation.scenes.pictures import coverage, illumination, lattice, picture
from validation.sources import known_input, second_method

SLOW = True

# Radii [pixels] and the largest rms of the relative errors of the areas.
REQUIRED = {10.0: 0.015, 20.0: 0.005, 50.0: 0.002}

# Blur of the optics [pixels] and noise of a pixel over the contrast.
BLUR, NOISE = 1.5, 0.05

# Images of so many contacts along each side.
IMAGES, SIDE = 8, 5

# The edge of a contact: the blur, and the square of a pixel with the variance 1/12.
EDGE = math.hypot(BLUR, math.sqrt(1.0 / 12.0))

AREAS = known_input("areas of 200 synthetic contacts with random centres, blur 1.5 pixels, noise 5 %")
CLEAN = known_input("areas of 50 synthetic contacts, noise 0.1 %: a tenth of the error with noise is allowed")
REPORTED = known_input("errors of the areas of synthetic contacts, which the reported ones must equal")
OTSU = "pixels below Otsu's threshold, doi:10.1109/TSMC.1979.4310076, as in the paper"


@cache
def errors(
    radius: float, noise: float = NOISE, images: int = IMAGES
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return relative errors of areas, of Otsu's areas, and the reported standard deviations."""
    rng, exact, found = np.random.default_rng(int(radius)), math.pi * radius**2, []
    for _ in range(images):
        shape, centre = lattice(SIDE, radius, rng)
        light = {"blur": BLUR, "noise": noise, "gradient": (0.2, -0.1), "bits": 8}
        image = picture(shape, centre, [radius] * len(centre), **light, rng=rng)
        measured = contact_areas(image, pixel_size=1.0)
        found.append(np.array([measured.area, counted(image, measured), measured.area_error]) / exact)
    area, otsu, reported_sd = np.concatenate(found, axis=1)
    return area - 1.0, otsu - 1.0, reported_sd


def counted(image: NDArray[Any], found: ContactAreas) -> FloatArray:
    """Return the pixels of each contact below Otsu's threshold, of an image without its known gradient."""
    even = image / illumination(image.shape, (0.2, -0.1))
    labels, _ = label(even < threshold_otsu(even))
    column, row = found.centre.astype(int).T
    return np.bincount(labels.ravel())[labels[image.shape[0] - 1 - row, column]].astype(float)


def floor(radius: float, noise: float = NOISE) -> float:
    """Least relative error of an area."""
    length = 2.0 * math.pi * radius
    return noise * math.sqrt(2.0 * math.sqrt(math.pi) * EDGE * length) / (math.pi * radius**2)


def by_curvature(radius: float, variance: float) -> float:
    """Return the bias of the area within the half level of a circle blurred by a variance [pixels²]."""
    return -variance / radius**2  # the level moves by variance/2 times the curvature; Gauss-Bonnet


BOUND = second_method(floor, "Cramér-Rao bound of an edge blurred by s along the perimeter L: n √(2 √π s L)")
GAUSS_BONNET = second_method(
    by_curvature, "-s²/r²: the half level of a blur s moves by s²/2 times the curvature"
)


def uncorrected(radius: float) -> tuple[float, float]:
    """Return the bias of the area within the half level, without noise, and what it is by Gauss-Bonnet."""
    side = int(2.0 * radius + 40.0)
    rng = np.random.default_rng(0)
    enclosed = []
    for centre in side / 2.0 + rng.uniform(-0.5, 0.5, (20, 2)):
        covered = coverage((side, side), [centre], [radius], blur=BLUR)
        image = gaussian_filter(1.0 - covered, EDGE)
        enclosed.append(contour(np.pad(image, 1, constant_values=1.0), 0.5)[0])
    return float(np.mean(enclosed) / (math.pi * radius**2) - 1.0), by_curvature(radius, 2.0 * EDGE**2)


def claim() -> Claim:
    """Contacts of known area are drawn into synthetic images with uneven light, a blur of {blur} pixels and
    noise of {noise} of the contrast, and measured. `contact_areas` is as exact as the noise permits, and
    states its errors to 20 %. Otsu's threshold, by which the paper measured, is also biased, by an amount
    that depends on the radius of the contact and on the share of dark pixels in the image.
    """
    values, figures = {"blur": BLUR, "noise": percent(NOISE)}, {"errors against the radius": Picture(_figure)}
    return Claim("Contact areas from images", [*_circles(), *_curvature()], figures, values)


def _circles() -> Iterator[Row]:
    for radius, required in REQUIRED.items():
        (area, otsu, sd), name = errors(radius), f"radius {radius:g} pixels"
        yield below(f"{name}: rms error of the area", rms(area), required, AREAS)
        yield near(f"{name}: rms error over the noise floor", rms(area) / floor(radius), 1.0, 0.25, BOUND)
        yield near(f"{name}: rms of error over reported error", rms(area / sd), 1.0, 0.2, REPORTED)
        yield below(f"{name}: bias over the rms error", abs(area.mean()) / rms(area), 0.25, AREAS)
        yield reported(f"{name}: bias by Otsu's threshold", float(otsu.mean()), OTSU)


def _curvature() -> Iterator[Row]:
    for radius in REQUIRED:
        bias, expected = uncorrected(radius)
        # the next term of a circle, 1/6 (s_t/r)^4, and the sagitta of the polygon, 0.21/r² as a variance
        rest = expected**2 / 6.0 + 0.25 / radius**2
        name = f"radius {radius:g} pixels: bias of the half level before the correction"
        yield near(name, bias, expected, rest, GAUSS_BONNET)
        clean, _, _ = errors(radius, noise=0.001, images=2)
        name = f"radius {radius:g} pixels: bias after it, noise 0.1 %"
        yield near(name, float(clean.mean()), 0.0, 0.1 * REQUIRED[radius], CLEAN)


@panels(5.0, 3.4, subplot_kw={"xscale": "log", "yscale": "log"})
def _figure(ax) -> None:
    """Error of the area of one contact, root mean square of 200, against its radius. The boundary below
    pixels (circles) follows the least error that is possible with this noise; Otsu's threshold (squares),
    which the paper used, is biased besides. Dashes are the largest errors allowed here.
    """
    radii = np.array([6.0, 8.0, *REQUIRED, 14.0, 32.0])
    radii.sort()
    area, otsu = 100.0 * np.array([[rms(each) for each in errors(r)[:2]] for r in radii.tolist()]).T
    ax.plot(radii, [100.0 * floor(r) for r in radii], color=QUIET, label="Cramér-Rao bound")
    ax.plot(radii, area, "o", color=ACHIEVED, label="sub-pixel boundary")
    ax.plot(radii, otsu, "s", color=TARGET, label="Otsu's threshold")
    ax.plot([*REQUIRED], [100.0 * v for v in REQUIRED.values()], "_", color="black", label="allowed")
    ax.set_xticks(radii, [f"{radius:g}" for radius in radii])
    ax.set_xticks([], minor=True)
    ax.set_yticks([0.03, 0.1, 0.3, 1.0, 3.0], ["0.03", "0.1", "0.3", "1", "3"])
    ax.set_xlabel("radius [pixels]")
    ax.set_ylabel("rms error of the area [%]")
