"""More of what calibrations refuse: records, corrections, images, and rare mistakes."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import (
    DesignSites,
    MeasuredLaw,
    Sample,
    branches,
    compare,
    corrected_heights,
    fit_segments,
    joint_covariance,
    shear,
    shear_record,
    stack_areas,
)
from metafem.calibration.images.grey import grey_values
from metafem.calibration.topography.alignment import aligned
from tests.calibration.compression.scenes import AREA
from tests.calibration.images.scenes import PIXEL, SHAPE
from tests.calibration.measured_law.scenes import (
    LOAD,
    MATERIAL,
    law_of,
    linear_design,
    measured_on,
    two_branches,
)
from tests.calibration.refused import compared, mapped, matched, sampled, strength, tracked
from tests.calibration.sheared.scenes import X, area, force
from tests.calibration.sites import scenes as images
from tests.calibration.topography.scenes import FOUR, lattice, made_surface
from tests.refusals import faults
from validation.scenes.lattice_views import lattice as sites

FEW = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=mf.Material(1.36))

REFUSALS = [
    (mapped(height_map=np.full((80, 80), np.nan)), "map", "heights"),
    (lambda: Sample(model=mf.Interacting()), "model", "surface"),
    (sampled(poisson_ratio=0.4), "poisson_ratio", "0.4"),
    (sampled(cap=[mf.Paraboloid()] * 4 + [mf.Sphere()]), "surface.cap", "Sphere"),
    (lambda: joint_covariance("E*"), "E*", "fit_compression"),
    (lambda: shear(AREA, AREA, AREA).plot(line="load"), "line", "load"),
    (strength(covariance=[[1e-4]], parameters=["wear"]), "parameters", "wear"),
    (lambda: shear_record(X, -force(X)), "friction_force", "0"),
    (lambda: shear_record(X[::-1], force(X)), "displacement[1]", "0.59"),
    (lambda: shear_record(X[::30], force(X[::30], peak=0.3)), "sliding_range", "0.2"),
    (lambda: shear_record(X, force(X), area(X)[:9]), "area", "9"),
    (lambda: shear_record(X, force(X), np.where(X > 0.1, np.nan, area(X))), "area", "0.15"),
    (lambda: shear_record(X, force(X), np.where((X > 0.2) & (X < 0.5), np.nan, area(X))), "area", "frame"),
    (lambda: shear_record(X, force(X), sliding_range=(0.2, 0.1)), "sliding_range", "0.2"),
    (lambda: law_of(asperity_area=np.ones((3, 2)), site=[1, -1]), "site", "-1"),
    (lambda: law_of(area=[0.1, np.nan, 0.3]), "area[1]", "nan"),
    (
        lambda: MeasuredLaw(LOAD, asperity_area=np.outer(LOAD, [1, np.nan]), material=MATERIAL).known(),
        "area",
        "nan",
    ),
    (lambda: fit_segments(two_branches(LOAD[:6])), "law", "6"),
    (lambda: fit_segments(two_branches(np.repeat([0.1, 0.2], 4))), "law", "2"),
    (lambda: branches(two_branches(), first=19), "first", "19"),
    (lambda: branches(two_branches(), second=40), "second", "40"),
    (lambda: branches(two_branches(np.repeat([0.1, 0.2], 4))), "points", "3"),
    (compared(parameters=["area_ratio"]), "parameters", "covariance"),
    (compared(parameters={"area_ratio": 1.0}, covariance=[[1.0]]), "parameters", "covariance"),
    (lambda: compare(measured_on(linear_design(), np.array([9.0])), linear_design()), "load", "9"),
    (lambda: grey_values(np.zeros((4, 50, 50))), "image", "(4, 50, 50)"),
    (lambda: grey_values(np.eye(50) * 1e38), "image", "1e+38"),
    (lambda: grey_values("picture.tif"), "image", "picture.tif"),
    (lambda: stack_areas([np.zeros(SHAPE), np.ones(SHAPE)], PIXEL), "images[1]", "1"),
    (matched(viewed_from="below"), "viewed_from", "below"),
    (tracked(areas=[]), "image", "1"),
    (tracked(areas=[images.contacts(sites(), 0.1)] * 2, image=["a", "a"]), "image", "a"),
    (tracked(sites=DesignSites(sites(), expected_area=np.ones(64))), "expected_area", "(1, 64)"),
    (tracked(sites=DesignSites(1.4 * sites())), "a", "2.1"),
    (lambda: DesignSites(sites(), [1] * 64), "site", "64"),
    (
        lambda: aligned(FEW.position, FEW.height, lattice(np.random.default_rng(0), (5, 4)), None),
        "2 caps",
        "20",
    ),
    (lambda: corrected_heights(FOUR, made_surface(FEW, np.zeros(2))), "design", "made.design"),
]


@pytest.mark.parametrize(("call", "key", "value"), REFUSALS)
def test_a_refusal_names_the_argument_and_its_value(call, key, value):
    assert faults([(call, key, value)]) == []
