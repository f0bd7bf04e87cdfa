"""Wrong units are noticed with the unit that would fit, and correct data of any material are not."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, MeasurementErrors, Sample, compare, fit_compression, shear
from validation.scenes.compression_tests import ENERGY, RADII, RADIUS, compression_tests
from validation.scenes.sheared_contacts import sheared

HINT = "would fit where a table says"
ERRORS = MeasurementErrors()


def hints(found):
    return [str(note) for note in found.notes if HINT in str(note)]


@pytest.fixture(scope="module")
def pressed():
    return tuple(each[0] for each in compression_tests(1, 5, ENERGY, np.random.default_rng(0)))


@pytest.fixture(scope="module")
def slid():
    return sheared(np.random.default_rng(0))[0]


@pytest.mark.parametrize(
    ("load", "area", "unit"),
    [
        (1e3, 1.0, "load_mN would fit where a table says load_N"),
        (1e-3, 1.0, "load_N would fit"),
        (1.0, 1e6, "area_um2 would fit where a table says area_mm2"),
        (1.0, 1e-6, "area_mm2 would fit"),
    ],
)
def test_calibrate_notices_another_unit(pressed, load, area, unit):
    try:
        words = hints(fit_compression(load * pressed[0], area * pressed[1], RADIUS, Sample(5)))
    except mf.MetafemError as error:
        words = [str(error)]
    assert any(unit in each for each in words), words


@pytest.mark.parametrize(
    ("factors", "unit"),
    [
        ((1.0, 1.0, 1e3), "friction_force_mN would fit"),
        ((1.0, 1.0, 1e-3), "friction_force_N would fit"),
        ((1e6, 1.0, 1.0), "area_sheared_mm2 would fit"),
        ((1.0, 1e6, 1.0), "area_sheared_um2 would fit"),
        ((1e6, 1e6, 1.0), "area_sheared_um2 would fit"),
        ((1e-6, 1e-6, 1.0), "area_sheared_mm2 would fit"),
    ],
)
def test_shear_notices_another_unit(slid, factors, unit):
    found = shear(*(np.array(factors)[:, None] * slid))
    assert any(unit in each for each in hints(found))


@pytest.mark.parametrize("modulus", [0.01, 1.36, 100.0, 1e4])
@pytest.mark.parametrize("contacts", [1, 5])
def test_calibrations_of_any_modulus_are_not_suspected(modulus, contacts):
    # solids other than elastomers are elastic in narrow contacts alone
    a = RADII * (0.1 if modulus > 100.0 else 1.0)
    load = contacts * modulus * 4.0 / 3.0 * a**3 / RADIUS
    errors = MeasurementErrors(load=0.01 * float(load.max()), boundary=ERRORS.boundary)
    rng = np.random.default_rng(1)
    load = load + errors.load * rng.standard_normal(a.size)
    area = contacts * math.pi * a**2
    assert hints(fit_compression(load, area, RADIUS, Sample(contacts), errors=errors)) == []


def test_shear_of_any_strength_is_not_suspected(slid):
    before, after, force = slid
    for factor in np.array([1e-3, 0.37, 10.0]) / 0.37:
        errors = MeasurementErrors(friction_force=1e-3 * factor)
        assert hints(shear(before, after, force * factor, errors=errors)) == []
    # stiff contacts whose area does not change
    assert hints(shear(before, before, 60.0 * before)) == []


@pytest.fixture(scope="module")
def design():
    template = mf.Surface.square_lattice(
        0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    )
    return mf.design(mf.LinearLaw(6.87), template)


def part(design, load=1.0, force=1.0, area=None, modulus=1.0):
    surface = design.surface
    law = mf.friction_law(surface, load=np.linspace(0.05, 0.6, 12))
    material = mf.Material(modulus * surface.material.composite_modulus)
    forces = {"friction_force": force * law.friction_force, "friction": surface.friction}
    given = forces if area is None else {"area": area * law.area}
    return MeasuredLaw(load * law.load, material=material, **given)


def test_compare_refuses_loads_that_the_target_does_not_have(design):
    for factor, words in (
        (1e-3, "all measured loads lie below the first load of the target.*load_N would fit"),
        (1e3, "all measured loads exceed.*load_mN would fit"),
    ):
        with pytest.raises(mf.InvalidInput, match=words):
            compare(part(design, load=factor), design)


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ({"force": 1e3}, "friction_force is 1e+03 times that of the design; check the unit"),
        ({"force": 1e-3}, "friction_force_N would fit"),
        ({"area": 1e6}, "area_um2 would fit"),
        ({"area": 1e-6}, "area_mm2 would fit"),
        ({"modulus": 3.2}, "E* of the part is 3.2 times that of the design"),
    ],
)
def test_compare_notices_another_unit(design, factors, words):
    found = compare(part(design, **factors), design)
    assert any(words in str(note) for note in found.notes)
    assert "modulus" in factors or not found.verdict.fits


def test_a_part_with_usual_errors_is_not_suspected(design):
    for factors in ({}, {"force": 2.0}, {"force": 0.5}, {"area": 1.2}, {"load": 0.8}, {"modulus": 1.5}):
        assert hints(compare(part(design, **factors), design)) == []
