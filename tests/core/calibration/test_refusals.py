"""What calibrations refuse: the argument and the value that was given are in the message."""

import numpy as np
import pandas as pd

import metafem as mf
from metafem.calibration import (
    MeasuredLaw,
    MeasurementErrors,
    at_peak,
    compare,
    contact_areas,
    crossover,
    fit_compression,
    joint_covariance,
    made_surface,
    match_sites,
    measured_law,
    shear,
    shear_strength,
    stack_areas,
    track_contacts,
)
from metafem.calibration.images import grey_values
from metafem.calibration.topography import aligned
from tests.calibration.compression.scenes import AREA, RADIUS, A, load_of
from tests.calibration.images.scenes import PIXEL, SHAPE
from tests.calibration.measured_law.scenes import (
    LOAD,
    MATERIAL,
    contacts,
    law_of,
    linear_design,
    measured_on,
    two_branches,
)
from tests.calibration.sheared.scenes import SURFACE, X, area, force, measured
from tests.calibration.sites import scenes as images
from tests.calibration.topography.scenes import FOUR, lattice
from tests.refusals import faults
from validation.scenes.lattice_views import lattice as sites
from validation.scenes.lattice_views import seen
from validation.scenes.sheared_contacts import sheared

EXACT, FIRST = load_of(A), A < 0.09
FEW = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=mf.Material(1.36))


def press(**given):
    """Fit a compression test of one contact with changed arguments."""
    return lambda: fit_compression(**({"load": EXACT, "area": AREA, "radius": RADIUS} | given))


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
    one = {"areas": {"a": images.contacts(seen(images.SITES), 0.1)}}
    forces = pd.DataFrame({"image": ["a"], "sheared_image": "", "load": 1.0})
    return lambda: track_contacts(**one | {"forces": forces} | given)


def mapped(**given):
    """Measure a flat map with changed arguments."""
    flat = {"height_map": np.zeros((80, 80)), "pixel_size": 0.04, "design_surface": FOUR}
    return lambda: made_surface(**flat | given)


REFUSALS = [
    (press(load=EXACT[:2], area=AREA[:2]), "load", "2"),
    (press(area=np.where(FIRST, 0.0, AREA)), "area[0]", "0"),
    (press(area=np.where(FIRST, -0.01, AREA)), "area[0]", "-0.01"),
    (press(area=np.full(20, 0.1)), "area", "0.1"),
    (press(area=AREA[::-1]), "load", "E* is -"),
    (press(area=5.0 * AREA, load=5.0 * EXACT), "R is unusual", "0.526"),
    (press(radius=300.0), "300 mm", "unusual=True"),
    (press(load=1e3 * EXACT), "MPa", "units of loads"),
    (press(errors=MeasurementErrors(radius_sd=0.6)), "radius_sd", "0.6"),
    (press(contacts=0), "contacts", "0"),
    (lambda: joint_covariance(*[shear(AREA, AREA, AREA)] * 2), "area_ratio", "two"),
    (slid(lambda b, s, f: (b, s, -f)), "friction_force", "sigma = -"),
    (slid(lambda b, s, f: (b, s[:5], f)), "area_sheared", "5"),
    (slid(lambda b, s, f: (b, -s, f)), "area_sheared[0]", "-0"),
    (slid(lambda b, s, f: (b, s, f * np.nan)), "sigma", "0"),
    (strength(known={"friction_force": None, "area": np.full(12, 0.2)}), "law", "sigma"),
    (strength(known={"friction_force": np.linspace(-3e-3, -1e-3, 12)}), "friction_force", "-"),
    (
        strength(surface=SURFACE.replaced(friction=None), known={"friction": None, "area": np.full(12, 0.2)}),
        *("B", "area_ratio"),
    ),
    (lambda: at_peak(X, X), "friction_force", "0.6"),
    (lambda: law_of(friction_force=None), "friction_force", "area"),
    (lambda: law_of(load=[-0.2, 0.1, 0.3]), "load[0]", "-0.2"),
    (lambda: law_of(area_sd=[0.1, 0.1, 0.1]), "area_sd", "area"),
    (lambda: law_of(asperity_area=np.ones((3, 2)), site=[1, 1]), "site", "1"),
    (lambda: law_of(asperity_area=-np.ones((3, 2))), "asperity_area[0, 0]", "-1"),
    (lambda: law_of(area=[0.0, 0.0, 0.0]), "area", "0"),
    (lambda: measured_law(contacts(load=np.full(3, np.nan)), MATERIAL), "load", "3"),
    (compared(parameters=["radius"]), "parameters", "radius"),
    (
        lambda: compare(
            MeasuredLaw([0.1], area=[0.5], material=MATERIAL),
            linear_design(),
            parameters=["shear_strength"],
        ),
        "parameters",
        "Friction",
    ),
    (lambda: contact_areas(np.full((50, 50), 7), PIXEL), "image", "7"),
    (lambda: contact_areas(np.random.default_rng(0).normal(200.0, 5.0, (100, 100)), PIXEL), "image", "noise"),
    (lambda: grey_values(np.where(np.eye(50) > 0, np.nan, 1.0)), "image", "nan"),
    (lambda: grey_values(np.random.default_rng(0).random((50, 50, 3))), "image", "3"),
    (lambda: grey_values(np.eye(50) > 0), "image", "bool"),
    (matched(centre=sites()[:2]), "2 contacts", "2"),
    (matched(site_position=np.zeros((4, 2))), "site", "coincident"),
    (matched(centre=seen(sites((8, 8), 1.2))), "64", "1.2"),
    (tracked(areas={"a": images.contacts(np.zeros((0, 2)), 0.1)}), "contact", "a"),
    (mapped(), "map", "0.526"),
    (mapped(design_surface=FOUR.replaced(cap=mf.Power(3))), "design_surface.cap", "3"),
    (lambda: aligned(0.7 * FOUR.position, FOUR.height, FOUR, False), "caps", "1.05"),
    (mapped(height_map=np.full((80, 80), np.nan)), "map", "heights"),
    (lambda: shear(AREA, AREA / 0.85, AREA), "area_ratio", "1.176"),
    (lambda: at_peak(X, -force(X)), "friction_force", "0"),
    (lambda: at_peak(X[::-1], force(X)), "displacement[1]", "0.59"),
    (lambda: at_peak(X, force(X), area(X)[:9]), "values", "9"),
    (lambda: at_peak(X, force(X), np.where(X > 0.1, np.nan, area(X))), "values", "0.15"),
    (lambda: law_of(asperity_area=np.ones((3, 2)), site=[1, -1]), "site", "-1"),
    (
        lambda: MeasuredLaw(LOAD, asperity_area=np.outer(LOAD, [1, np.nan]), material=MATERIAL),
        "area",
        "nan",
    ),
    (lambda: crossover(two_branches(LOAD[:6])), "law", "6"),
    (lambda: crossover(two_branches(np.repeat([0.1, 0.2], 4))), "law", "2"),
    (compared(parameters=["area_ratio"]), "parameters", "covariance"),
    (compared(parameters=["area_ratio"], covariance=[[-1.0]]), "covariance", "-1"),
    (lambda: compare(measured_on(linear_design(), np.array([9.0])), linear_design()), "load", "9"),
    (lambda: grey_values(np.zeros((4, 50, 50))), "image", "(4, 50, 50)"),
    (lambda: grey_values("picture.tif"), "image", "picture.tif"),
    (lambda: stack_areas([np.zeros(SHAPE), np.ones(SHAPE)], PIXEL), "image 1", "0"),
    (matched(viewed_from="below"), "viewed_from", "below"),
    (tracked(site_position=1.4 * sites()), "a", "2.1"),
    (
        lambda: aligned(FEW.position, FEW.height, lattice(np.random.default_rng(0), (5, 4)), False),
        "2 caps",
        "20",
    ),
]


def test_a_refusal_names_the_argument_and_its_value():
    assert faults(REFUSALS) == []


def test_areas_that_are_all_error_have_no_fit_or_a_positive_modulus():
    errors, found = MeasurementErrors(load=1e-6, boundary=0.4), []
    for seed in range(6):
        noise = errors.of_area(AREA) * np.random.default_rng(seed).standard_normal(20)
        try:
            fit = fit_compression(EXACT, np.abs(AREA + noise), RADIUS, unusual=True, errors=errors)
            found.append(fit.material.composite_modulus > 0.0 and np.isfinite(fit.covariance).all())
        except (mf.NotConverged, mf.InvalidInput) as error:
            found.append("area" in str(error))
    assert all(found)
