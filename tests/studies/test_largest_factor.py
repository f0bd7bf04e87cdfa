"""Largest multiples of errors, from draws whose misfit is known."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from metafem.studies.largest_tolerances import largest, quantile
from metafem.studies.sampling.moments import Estimate


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
