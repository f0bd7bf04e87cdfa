"""Moments and quantiles from sums, against plain numpy and known distributions."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from metafem.studies.sampling.moments import added, moments, quantiles, sums_of


def total(batches):
    """Sums over batches of (u, x), each (m, q)."""
    found = {}
    for u, x in batches:
        found = added(found, sums_of(u, x))
    return found


def drawn(seed, batches=16, size=64):
    """u = c + a part of x^2 + an independent one, and x, standard normal: plain random numbers."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(batches):
        x, other = rng.standard_normal((2, size, 1))
        found.append((0.01 * (x + 0.3 * x**2 + 0.2 * other), x))
    return found


EXACT_MEAN, EXACT_SD = 0.003, 0.01 * np.sqrt(1.0 + 2.0 * 0.09 + 0.04)


def test_plain_moments_are_those_of_numpy():
    batches = drawn(0)
    u = np.concatenate([u for u, _ in batches])[:, 0]
    found = moments(total(batches), plain=True)
    assert found.value[0, 0] == pytest.approx(u.mean(), rel=1e-12)
    assert found.value[1, 0] == pytest.approx(u.std(ddof=1), rel=1e-12)
    assert found.error[0, 0] == pytest.approx(u.std(ddof=1) / np.sqrt(len(u)), rel=1e-12)
    fourth = ((u - u.mean()) ** 4).mean()
    expected = np.sqrt((fourth - u.var() ** 2) / len(u)) / (2.0 * u.std())
    assert found.error[1, 0] == pytest.approx(expected, rel=2e-3)
    assert found.saving[1, 0] == pytest.approx(1.0, rel=2e-3)


def test_control_variates_are_the_regressions_of_numpy():
    batches = drawn(1)
    u, x = (np.concatenate(parts)[:, 0] for parts in zip(*batches, strict=True))
    table = np.column_stack([np.ones_like(x), x, x**2 - 1.0])
    shift, square = (np.linalg.lstsq(table, y, rcond=None)[0][0] for y in (u, u**2))
    found = moments(total(batches))
    assert found.value[0, 0] == pytest.approx(shift, rel=1e-10)
    variance = square - shift**2 + found.error[0, 0] ** 2
    assert found.value[1, 0] == pytest.approx(np.sqrt(variance), rel=1e-10)
    assert found.saving[0, 0] > 10.0


def test_quantiles_are_those_of_numpy_within_a_hundredth_of_the_deviation():
    u = 0.01 * np.random.default_rng(0).standard_normal((20_000, 1))
    probability = np.array([0.05, 0.5, 0.95])
    found = quantiles(total([(u, np.zeros_like(u))]), probability)
    assert_allclose(found.value, np.quantile(u, probability), atol=1e-4)
    density = np.exp(-0.5 * 1.645**2) / np.sqrt(2.0 * np.pi) / 0.01
    assert found.error[2] == pytest.approx(np.sqrt(0.05 * 0.95 / 20_000) / density, rel=0.1)
