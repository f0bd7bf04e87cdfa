"""The fit with errors on both axes against ODRPACK and theory; its coverage is that of a claim."""

import math

import numpy as np
import pytest

from metafem.calibration import MeasurementErrors
from metafem.calibration.compression.distance_fit import adhesive_load, distance_fit

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6
ERRORS = MeasurementErrors()
AREA = math.pi * np.tile(np.linspace(0.08, 0.4, 20), 3) ** 2


def curve(area):
    load = 4.0 / 3.0 * (area / math.pi) ** 1.5 / RADIUS
    return load, 1.5 * load / area


def law(area):
    return MODULUS * curve(area)[0] - math.sqrt(ENERGY * MODULUS) * adhesive_load(area)[0]


def measured(trials, seed=0, spread=1.0):
    rng = np.random.default_rng(seed)
    load = law(AREA) + ERRORS.load * rng.standard_normal((trials, AREA.size))
    return load, (AREA + spread * ERRORS.of_area(AREA) * rng.standard_normal((trials, AREA.size)))[..., None]


def fit(load, area, contacts=1, area_sd=None):
    def sd(of):
        return ERRORS.of_area(of) / math.sqrt(contacts)

    return distance_fit(load, area, curve, contacts=contacts, load_sd=ERRORS.load, area_sd=area_sd or sd)


def test_exact_data_give_the_law_back():
    found = fit(5.0 * law(AREA), AREA[:, None], contacts=5)
    assert found.modulus == pytest.approx(MODULUS, rel=1e-12)
    assert found.root == pytest.approx(math.sqrt(ENERGY), rel=1e-10)
    assert found.converged


def test_of_given_variances_it_is_the_regression_of_odrpack():
    import odrpack

    (load,), (area,) = measured(1, seed=3)
    sd = ERRORS.of_area(AREA)
    found = fit(load, area, area_sd=lambda of: sd[:, None])

    def model(x, beta):
        return beta[0] * curve(x)[0] - beta[1] * adhesive_load(x)[0]

    other = odrpack.odr_fit(
        model, area[:, 0], load, np.array([1.0, 0.0]), weight_x=sd**-2, weight_y=ERRORS.load**-2,
        diff_scheme="central", sstol=1e-15, partol=1e-15,
    )  # fmt: skip
    deviation = np.sqrt(np.diag(found.covariance))
    assert abs(found.modulus - other.beta[0]) < 1e-5 * deviation[0]
    assert abs(found.product - other.beta[1]) < 1e-5 * deviation[1]
    assert np.abs(found.area[:, 0] - other.xplusd).max() < 1e-6 * sd.max()
    assert (found.residual**2).sum() == pytest.approx(other.sum_square, rel=1e-6)


def test_regressors_at_the_measured_areas_would_bias_the_fit():
    trials, spread = 1000, 5.0
    load, area = measured(trials, spread=spread)
    found = fit(load, area, area_sd=lambda of: spread * ERRORS.of_area(of))
    q, s = curve(area[..., 0])[0], adhesive_load(area[..., 0])[0]
    design = np.stack([q, -s], axis=-1)
    plain = np.array([np.linalg.lstsq(x, y, rcond=None)[0] for x, y in zip(design, load, strict=True)])
    scatter = found.modulus.std() / math.sqrt(trials)
    assert abs(found.modulus.mean() - MODULUS) < 6.0 * scatter
    assert abs(plain[:, 0].mean() - MODULUS) > 12.0 * scatter


def test_contacts_one_by_one_are_fitted_as_their_sum():
    rng = np.random.default_rng(4)
    area = AREA[:20, None] * rng.uniform(0.9, 1.1, (20, 5))
    found = fit(law(area).sum(axis=1), area)
    assert found.modulus == pytest.approx(MODULUS, rel=1e-12)
    assert found.area == pytest.approx(area, rel=1e-12)
