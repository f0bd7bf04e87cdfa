"""Largest multiples of errors, from draws whose misfit is known."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from metafem.studies.largest_tolerances import largest, quantile
from metafem.studies.sampling.moments import Estimate

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


def test_misfits_without_a_solution_count_as_infinite():
    misfit = np.array([0.1, 0.2, 0.3, np.inf])
    assert quantile(misfit, 0.5).value == 0.2
    assert quantile(misfit, 0.95) == Estimate(math.inf, math.inf)
