"""Errors of the exponents and coefficients of power caps against the closed form of one asperity."""

import math

import numpy as np
from scipy.special import gamma, ndtri

import metafem as mf
from metafem.studies import manufacturing

LOAD = np.linspace(0.02, 0.08, 20)
ELASTIC = mf.Independent(mf.Elastic())
RADIUS = 0.526


POWER = mf.Power(3.0, 0.4)


def surface(cap=POWER, count=1):
    position = 1.5 * np.column_stack([np.arange(count), np.zeros(count)])
    return mf.Surface(position, np.full(count, 0.1), RADIUS, mf.Material(1.36), cap=cap)


def area(exponent, coefficient, load=LOAD):
    """A of one power cap under a load P/E*: ``P = 2 n/(n + 1) a D(a)``, D of Galin and Sneddon."""
    factor = coefficient * RADIUS ** (1.0 - exponent) * math.sqrt(math.pi)
    factor *= gamma(exponent / 2.0 + 1.0) / gamma((exponent + 1.0) / 2.0)
    a = (load * (exponent + 1.0) / (2.0 * exponent * factor)) ** (1.0 / (exponent + 1.0))
    return math.pi * a**2


def test_each_sample_has_the_area_of_its_shape():
    tolerances = mf.Tolerances(exponent_sd=0.05, coefficient_sd=0.01)
    unit = np.array([[0.5, 0.5], [0.9, 0.2], [0.01, 0.99]])
    assert tolerances.dimensions(surface()) == 2
    found = tolerances.areas(ELASTIC, surface(), LOAD, unit)
    for row, (first, second) in zip(found, ndtri(unit), strict=True):
        expected = area(3.0 + 0.05 * first, 0.4 + 0.01 * second)
        np.testing.assert_allclose(row, expected, rtol=1e-11)


def test_study_has_the_moments_of_the_closed_form():
    """Gauss-Hermite quadrature of the closed form; the study within four times its sampling error."""
    z, weight = np.polynomial.hermite_e.hermegauss(15)
    weight = np.outer(weight, weight) / weight.sum() ** 2
    each = np.array([[area(3.0 + 0.02 * s, 0.4 + 0.01 * t) for t in z] for s in z])
    mean = np.einsum("ij,ijk->k", weight, each)
    sd = np.sqrt(np.einsum("ij,ijk->k", weight, (each - mean) ** 2))
    ends, others = (LOAD[0], LOAD[-1]), mf.Tolerances(exponent_sd=0.02, coefficient_sd=0.01)
    found = manufacturing(surface(), 0.0, draws=128, model=ELASTIC, load_range=ends, others=others)
    np.testing.assert_allclose(found.rescaled_load, LOAD, rtol=1e-12)
    assert (np.abs(found.area_mean[0] - mean) <= 4.0 * found.area_mean_error[0]).all()
    assert (np.abs(found.area_sd[0] - sd) <= 4.0 * found.area_sd_error[0]).all()
    assert found.area_sd_error[0].max() < 0.1 * sd.max()


def test_a_coefficient_is_a_radius():
    """The areas of the caps with the drawn coefficients, of three asperities that interact."""
    part, unit = surface(count=3), np.array([[0.9, 0.3, 0.6]])
    model = mf.Interacting(contact=mf.Elastic())
    drawn = part.replaced(cap=[mf.Power(3.0, 0.4 + 0.01 * z) for z in ndtri(unit[0])])
    found = mf.Tolerances(coefficient_sd=0.01).areas(model, part, LOAD, unit)
    np.testing.assert_allclose(found, model.areas(drawn, LOAD, drawn.height[None]), rtol=1e-10)


def test_no_error_of_the_shape_changes_nothing():
    part, unit = surface(count=2), np.array([[0.1, 0.7]])
    drawn = mf.Tolerances(height_sd=0.001).perturbed(part, unit)
    found = mf.Tolerances(height_sd=0.001).areas(ELASTIC, part, LOAD, unit)
    np.testing.assert_array_equal(found, ELASTIC.areas(part, LOAD, drawn.height))
