"""Probability that the made surface meets the target, and the largest tolerances."""

import math
from itertools import count

import numpy as np
import pytest
from scipy.stats import norm

import metafem as mf
from metafem.studies import Draws, Requirement
from metafem.studies.largest_tolerances import largest, quantile
from metafem.studies.sampling.moments import Estimate

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


def test_exact_surfaces_meet_the_target_or_do_not(design):
    misfit = design.misfit
    for allowed, share in ((1.01 * misfit, 1.0), (0.99 * misfit, 0.0)):
        found = mf.studies.combined(design, mf.Tolerances(), requirement=Requirement(allowed), draws=2)
        assert found.probability == share
        assert found.nominal_misfit == pytest.approx(misfit, rel=1e-9)
        assert found.sizes["tolerance"] == 0
        assert found.probability_error > 0.0


def test_straight_laws_are_compared_as_in_the_design():
    for target in (mf.LinearLaw(8.0), mf.LinearLaw(7.0, (0.03, 0.06))):
        design = mf.design(target, TEMPLATE)
        found = mf.studies.combined(design, TOLERANCES, draws=2)
        assert found.nominal_misfit == pytest.approx(design.misfit, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "sd", "power"),
    [
        ("composite_modulus", 0.05 * 1.36, -2.0 / 3.0),
        ("radius", 0.05 * 0.526, 2.0 / 3.0),
        ("shear_strength", 0.05 * 0.4, 1.0),
        ("area_ratio", 0.05 * 0.85, 1.0),
    ],
)
def test_parameters_of_a_single_contact_have_a_closed_form(contact, name, sd, power):
    allowed = 0.03
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


def test_tolerances_without_effect_have_no_limit(contact):
    found = mf.studies.combined(
        contact, mf.Tolerances(height_sd=0.003), requirement=Requirement(0.01), draws=100
    )
    assert found.probability == 1.0
    assert np.isinf(found.factor).all()
    assert "is exceeded up to the largest multiple of all tolerances" in found.notes


def test_draws_are_added_until_the_error_is_reached(design):
    found = mf.studies.combined(
        design, mf.Tolerances(height_sd=0.003), requirement=Requirement(0.02), draws=Draws(error=0.005)
    )
    assert found.probability_error <= 0.005
    assert found.draws in (4096, 8192, 16384)


def test_a_stopped_run_goes_on_with_the_same_numbers(design, tmp_path, monkeypatch):
    arguments = {"requirement": Requirement(0.02), "draws": 600, "rng": 7}
    whole = mf.studies.combined(design, TOLERANCES, **arguments)
    execution = mf.studies.Execution(folder=tmp_path / "run")
    calls, areas = count(), mf.Independent.areas

    def stopped(*given):
        if next(calls) == 30:
            raise KeyboardInterrupt
        return areas(*given)

    with monkeypatch.context() as patched:
        patched.setattr(mf.Independent, "areas", stopped)
        with pytest.raises(KeyboardInterrupt):
            mf.studies.combined(design, TOLERANCES, execution=execution, **arguments)
    assert any((tmp_path / "run").glob("batch-*"))
    assert mf.studies.combined(design, TOLERANCES, execution=execution, **arguments).identical(whole)


def test_largest_factor_of_a_half_normal_misfit():
    x = np.abs(np.random.default_rng(0).standard_normal(20_000))
    found = largest(lambda factor: quantile(factor * x, 0.9), quantile(x, 0.9), 0.1, 100.0)
    exact = 0.1 / norm.ppf(0.95)
    assert abs(found.value - exact) <= 3.0 * found.error
    # delta method: the density of |x| at its quantile q is 2 phi(q)
    q = norm.ppf(0.95)
    assert found.error == pytest.approx(exact * 0.3 / math.sqrt(20_000) / (2.0 * norm.pdf(q)) / q, rel=0.2)
    wide = largest(lambda factor: quantile(factor * x, 0.9), quantile(x, 0.9), 10.0, 100.0)
    assert wide.value == pytest.approx(100.0 * found.value, rel=0.01)


SHAPES = {
    "linear": (lambda factor, x, y: factor * np.abs(x), 8.0),
    "beside another": (lambda factor, x, y: np.hypot(factor * x, y), 2.2),
    "curved": (lambda factor, x, y: 0.3 + factor**2 * np.abs(x), 1.0),
    "falls first": (lambda factor, x, y: np.abs(1.0 - factor) + 0.05 * np.abs(x), 0.5),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_errors_of_the_largest_factor_are_its_scatter(shape):
    misfit, allowed = SHAPES[shape]
    random, found = np.random.default_rng(0), []
    for _ in range(100):
        x, y = random.standard_normal((2, 500))
        found.append(
            largest(
                lambda factor, x=x, y=y: quantile(misfit(factor, x, y), 0.9),
                quantile(misfit(1.0, x, y), 0.9), allowed, 100.0,
            )
        )  # fmt: skip
    factor, error = np.array(found).T
    # the scatter of a hundred is known to 7 %, and the spacing of 500 draws to twice that
    assert np.sqrt((error**2).mean()) == pytest.approx(factor.std(), rel=0.3)


def test_draws_without_a_solution_bound_the_factor():
    x = np.abs(np.random.default_rng(0).standard_normal(2000))
    found = largest(
        lambda factor: quantile(np.where(factor * x > 1.0, np.inf, 0.5), 0.9),
        Estimate(math.inf, math.inf),
        1.0,
        9.0,
    )
    assert found.value == pytest.approx(1.0 / np.sort(x)[1799], rel=1e-3)
    assert found.error == math.inf


def test_misfits_without_a_solution_count_as_infinite():
    misfit = np.array([0.1, 0.2, 0.3, np.inf])
    assert quantile(misfit, 0.5).value == 0.2
    assert quantile(misfit, 0.95) == Estimate(math.inf, math.inf)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"draws": 1}, "draws = 1 must be a whole number of at least 2"),
        ({"parameters": {"load": 0.1}}, "parameters has no parameter 'load'"),
        ({"parameters": {"radius": 0.2}}, "parameters.radius"),
    ],
)
def test_bad_inputs_are_refused(design, changes, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.studies.combined(design, TOLERANCES, **changes)
    for given, must in ((0.0, 0.9), "misfit = 0 must be greater than 0"), ((0.1, 1.0), "must be below 1"):
        with pytest.raises(mf.InvalidInput, match=must):
            Requirement(*given)
