"""The straight line of Johnson, Kendall and Roberts."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration.compression.adhesive_line import adhesive_line

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6
A = np.linspace(0.08, 0.4, 20)


def test_it_is_the_law_of_johnson_kendall_and_roberts():
    law = mf.JKR(ENERGY).for_material(mf.Material(MODULUS))
    load = MODULUS * law.load(A, RADIUS)
    # a^3 = 3 R/(4 E*) [P + 3 pi w R + sqrt(6 pi w R P + (3 pi w R)^2)]
    pull = 3.0 * math.pi * ENERGY * RADIUS
    cube = 0.75 * RADIUS / MODULUS * (load + pull + np.sqrt(2.0 * pull * load + pull**2))
    assert cube == pytest.approx(A**3, rel=1e-12)
    line = adhesive_line(load, law.area(A), RADIUS)
    assert line.slope == pytest.approx(0.75 / MODULUS, rel=1e-12)
    assert line.intercept == pytest.approx(math.sqrt(0.75 * ENERGY / MODULUS), rel=1e-10)
    assert line.composite_modulus == pytest.approx(MODULUS, rel=1e-12)
    assert line.adhesion_energy == pytest.approx(ENERGY, rel=1e-9)


def test_its_covariance_is_that_of_errors_of_y():
    rng = np.random.default_rng(0)
    exact = adhesive_line(MODULUS * mf.Hertz().load(A, RADIUS), math.pi * A**2, RADIUS)
    y = exact.y + 1e-4 * rng.standard_normal((4000, 20))
    # x ~ p/a0^(3/4) and y ~ a0^(3/4)
    area = math.pi * A**2 * (y / exact.y) ** (4.0 / 3.0)
    line = adhesive_line(MODULUS * mf.Hertz().load(A, RADIUS) * y / exact.y, area, RADIUS)
    # relative error of a variance from 4000 draws: 2.2 %
    spread = np.cov(line.composite_modulus, line.adhesion_root)
    assert line.root_covariance.mean(axis=0) == pytest.approx(spread, rel=0.12)


def test_a_negative_intercept_has_no_adhesion_energy():
    line = adhesive_line(MODULUS * mf.Hertz().load(A, RADIUS) + 1e-3, math.pi * A**2, RADIUS)
    assert line.adhesion_root < 0.0
    assert line.adhesion_energy == 0.0
