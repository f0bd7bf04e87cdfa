"""Probability that the made surface meets the target, and the largest tolerances."""

import math

import numpy as np
import pytest
from scipy.stats import norm

import metafem as mf
from metafem.studies import Requirement

SOFT = mf.Material(1.36, 0.5)
TEMPLATE = mf.Surface.square_lattice(
    0.12, (4, 4), radius=0.526, material=SOFT, friction=mf.Friction(0.4, 0.85)
)
TOLERANCES = mf.Tolerances(height_sd=0.003, angle=0.001)


@pytest.fixture(scope="module")
def design():
    return mf.design(mf.PowerLaw(0.9, (0.02, 0.06)), TEMPLATE)


@pytest.fixture(scope="module")
def contact():
    """A single asperity, whose law is A0 = pi (3/4 R P/E*)^(2/3) for any height."""
    one = mf.Surface.square_lattice(
        0.12, (1, 1), radius=0.526, material=SOFT, friction=mf.Friction(0.4, 0.85)
    )
    load = np.array([0.01, 0.02, 0.03])
    return mf.design(mf.SampledLaw(load, math.pi * (0.75 * 0.526 * load) ** (2.0 / 3.0)), one)


def met(design, allowed, height_sd, angle, draws=4000, rng=123):
    """Share of made surfaces within a misfit, and its standard error, by draws and a fit of the prefactor."""
    random, surface = np.random.default_rng(rng), design.surface
    height = surface.height + height_sd * random.standard_normal((draws, surface.count))
    height = height + np.tan(random.uniform(-angle, angle, (draws, 2))) @ surface.position.T
    load = np.geomspace(0.02, 0.06, 30)
    area = mf.Independent().areas(surface, load, height)
    law = area
    for _ in range(3):  # the prefactor of the nearest power, in relative differences
        power = load**0.9 / law
        law = (power * area / law).sum(axis=1, keepdims=True) / (power**2).sum(axis=1, keepdims=True)
        law = law * load**0.9
    share = float(np.mean(np.sqrt(((area / law - 1.0) ** 2).mean(axis=1)) <= allowed))
    return share, math.sqrt(share * (1.0 - share) / draws)


def test_probability_and_largest_tolerances_agree_with_draws(design):
    found = mf.studies.combined(design, TOLERANCES, requirement=Requirement(0.012), draws=2000)
    share, error = met(design, 0.012, 0.003, 0.001)
    assert abs(found.probability - share) <= 3.0 * math.hypot(error, found.probability_error)
    assert 0.01 < share < 0.99
    factor = dict(zip(found.tolerance.values.tolist(), found.factor.values.tolist(), strict=True))
    assert list(factor) == ["all", "height_sd", "angle"]
    # a fifth of the draws, in whole batches, finds the factors
    own = 0.3 / math.sqrt(512)
    for sd, angle in ((factor["all"], factor["all"]), (factor["height_sd"], 1.0)):
        share, error = met(design, 0.012, sd * 0.003, angle * 0.001)
        assert abs(share - 0.9) <= 3.0 * math.hypot(error, own)
    assert found.misfit_quantile[2] > 0.012
    assert found.area_sd.shape == found.rescaled_load.shape == (20,)
    assert 0.0 < found.slope_sd < 0.2 * found.nominal_slope


def test_exact_surfaces_have_the_misfit_of_the_design(design):
    misfit = design.misfit
    for allowed, share in ((1.01 * misfit, 1.0), (0.99 * misfit, 0.0)):
        found = mf.studies.combined(design, mf.Tolerances(), requirement=Requirement(allowed), draws=2)
        assert found.probability == share
        assert found.nominal_misfit == pytest.approx(misfit, rel=1e-9)
        assert found.sizes["tolerance"] == 0
        assert found.probability_error > 0.0
    for target in (mf.LinearLaw(8.0), mf.LinearLaw(7.0, (0.03, 0.06))):
        design = mf.design(target, TEMPLATE)
        found = mf.studies.combined(design, TOLERANCES, draws=2)
        assert found.nominal_misfit == pytest.approx(design.misfit, rel=1e-9)


def test_parameters_of_a_single_contact_have_a_closed_form(contact):
    allowed = 0.03
    cases = (
        ("composite_modulus", 0.05 * 1.36, -2.0 / 3.0),
        ("radius", 0.05 * 0.526, 2.0 / 3.0),
        ("shear_strength", 0.05 * 0.4, 1.0),
        ("area_ratio", 0.05 * 0.85, 1.0),
    )
    for name, sd, power in cases:
        # (1 + e)^power is within 1 -+ allowed
        ends = sorted((1.0 + sign * allowed) ** (1.0 / power) - 1.0 for sign in (1.0, -1.0))
        expected = norm.cdf(ends[1] / 0.05) - norm.cdf(ends[0] / 0.05)
        found = mf.studies.combined(
            contact, TOLERANCES, requirement=Requirement(allowed), parameters={name: sd}, draws=2000
        )
        assert abs(found.probability - expected) <= 3.0 * found.probability_error
    # the height does not change the law of one contact
    assert np.isnan(found.factor).all()
    assert "is not reached even without errors of the surface" in found.notes
    found = mf.studies.combined(
        contact, mf.Tolerances(height_sd=0.003), requirement=Requirement(0.01), draws=100
    )
    assert found.probability == 1.0
    assert np.isinf(found.factor).all()
    assert "is exceeded up to the largest multiple of all tolerances" in found.notes
