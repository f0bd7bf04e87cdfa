"""Calls of calibrations with one argument changed, which they refuse."""

import numpy as np

import metafem as mf
from metafem.calibration import (
    Sample,
    compare,
    fit_compression,
    match_sites,
    measured_surface,
    shear,
    shear_strength,
    track_contacts,
)
from tests.calibration.compression.scenes import AREA, RADIUS, A, load_of
from tests.calibration.measured_law.scenes import linear_design, measured_on
from tests.calibration.sheared.scenes import SURFACE, measured
from tests.calibration.sites import scenes as images
from tests.calibration.topography.scenes import FOUR
from validation.scenes.lattice_views import lattice as sites
from validation.scenes.lattice_views import seen
from validation.scenes.sheared_contacts import sheared

EXACT = load_of(A)


def press(**given):
    """Fit a compression test of one contact with changed arguments."""
    return lambda: fit_compression(**({"load": EXACT, "area": AREA, "radius": RADIUS} | given))


def sampled(**given):
    """Fit a compression test of five caps with a changed sample."""
    place = 5.0 * np.array([[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]])
    height = given.pop("height", [0.4] * 5)
    surface = mf.Surface(place, height, RADIUS, mf.Material(1.36), cap=given.pop("cap", mf.Paraboloid()))
    radius, one_by_one = given.pop("radius", RADIUS), given.pop("one_by_one", False)
    each = np.repeat(AREA[:, None], 5, axis=1)
    areas = each if one_by_one else 5.0 * AREA
    return lambda: fit_compression(
        AREA**1.5, areas, radius, Sample(**{"contacts": 5, "surface": surface} | given)
    )


def slid(change):
    """Fit the points of one shear test that a function changes."""
    return lambda: shear(*change(*sheared(np.random.default_rng(1), tests=1)[0]))


def strength(load_min=0.1, surface=SURFACE, known=None, **given):
    """Fit the strength to a law of forces with changed arrays."""

    def call():
        exact = mf.friction_law(SURFACE, load=np.linspace(0.1, 0.6, 12))
        return shear_strength(measured(exact, **(known or {})), surface, load_min, **given)

    return call


def compared(**given):
    """Compare two points with a design."""
    return lambda: compare(measured_on(linear_design(), np.array([0.2, 0.3])), linear_design(), **given)


def matched(**given):
    """Match all contacts of a lattice with changed arguments."""
    return lambda: match_sites(**{"centre": sites(), "site_position": sites()} | given)


def tracked(**given):
    """Follow the contacts of one image with changed arguments."""
    one = {"areas": [images.contacts(seen(images.SITES), 0.1)], "image": ["a"]}
    return lambda: track_contacts(**one | given)


def mapped(**given):
    """Measure a flat map with changed arguments."""
    flat = {"height_map": np.zeros((80, 80)), "pixel_size": 0.04, "design_surface": FOUR}
    return lambda: measured_surface(**flat | given)
