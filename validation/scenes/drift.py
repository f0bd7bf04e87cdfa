"""Compression tests whose loads drift, or of which one is an outlier."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from metafem._validate import FloatArray
from metafem.calibration import ContactCalibration, Sample, fit_compression
from metafem.calibration.bounded_interval import WIDTH
from metafem.calibration.verdict import REJECTED
from validation.scenes.compression_tests import (
    ENERGY,
    ERRORS,
    MODULUS,
    RADII,
    RADIUS,
    TESTS,
    compression_tests,
    fitted,
    loads,
)

# Calibrations of each kind.
REPETITIONS = 300

# Correlation of the errors of successive loads, and outlier in standard deviations of a load.
RHO, OUTLIER = 0.9, 4.0


def drifting(
    rng: np.random.Generator, contacts: int, *, noise_only: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return loads (60,) with errors correlated by 0.9 within each test, and total areas (60,)."""
    error = rng.standard_normal((TESTS, RADII.size))
    for i in range(1, RADII.size):
        error[:, i] = RHO * error[:, i - 1] + math.sqrt(1.0 - RHO**2) * error[:, i]
    _, areas = compression_tests(1, contacts, ENERGY, rng)
    exact = 0.0 if noise_only else contacts * loads(np.tile(RADII, TESTS))
    return exact + ERRORS.load * error.ravel(), areas[0]


def with_outlier(
    rng: np.random.Generator, contacts: int, place: int | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return loads and total areas (60,); one load, at random unless its place is given, is an outlier."""
    load, area = (each[0] for each in compression_tests(1, contacts, ENERGY, rng))
    load[int(rng.integers(load.size)) if place is None else place] += OUTLIER * ERRORS.load
    return load, area


@dataclass(frozen=True)
class Repeated:
    """Of repeated calibrations: shares whose 68 % interval holds E* and that state a misfit, and the fits."""

    covered: float
    noticed: float
    found: tuple[ContactCalibration, ...]


def repeated(
    scene: Callable[[np.random.Generator, int], tuple[FloatArray, FloatArray]], contacts: int
) -> Repeated:
    """Calibrate 300 times to three tests of 20 loads."""
    rng, test = np.random.default_rng(5), np.repeat(np.arange(TESTS), RADII.size)
    found = tuple(
        fit_compression(*scene(rng, contacts), RADIUS, sample=Sample(contacts=contacts), test=test)
        for _ in range(REPETITIONS)
    )
    intervals = np.array([each.composite_modulus_interval for each in found])
    held = (intervals[:, 0] <= MODULUS) & (intervals[:, 1] >= MODULUS)
    return Repeated(float(held.mean()), float(np.mean([not each.verdict.fits for each in found])), found)


def last_outlying(rng: np.random.Generator, contacts: int) -> tuple[FloatArray, FloatArray]:
    """Return loads and total areas (60,) of which the largest load is an outlier, where it does most harm."""
    return with_outlier(rng, contacts, -1)


def steady(rng: np.random.Generator, contacts: int) -> tuple[FloatArray, FloatArray]:
    """Return loads and total areas (60,) with independent normal errors."""
    load, area = compression_tests(1, contacts, ENERGY, rng)
    return load[0], area[0]


def held(
    scene: Callable[[np.random.Generator, int], tuple[FloatArray, FloatArray]],
    contacts: int,
    *,
    robust: bool = False,
) -> float:
    """Return the share of intervals of E* that hold it if errors are taken for independent ones."""
    rng = np.random.default_rng(5)
    load, area = np.array([scene(rng, contacts) for _ in range(REPETITIONS)]).transpose(1, 0, 2)
    fit = fitted(load, area, contacts, robust=robust)
    return float((np.abs(fit.modulus - MODULUS) <= WIDTH * np.sqrt(fit.covariance[:, 0, 0])).mean())


def power(contacts: int) -> float:
    """Return how often the most powerful test of one outlier notices it: its point is the farthest.

    Of k residuals with unit variance the farthest is beyond z by chance in 1 %. An outlier of d standard
    deviations in a point of the leverage h exceeds z with the probability ``Phi(d sqrt(1 - h) - z)``.
    """
    load, area = np.tile(contacts * loads(RADII), TESTS), np.tile(contacts * math.pi * RADII**2, TESTS)
    fit = fitted(load[None], area[None], contacts)
    regressor = fit.regressor[0]
    sd = contacts * 4.0 / 3.0 * np.tile(RADII, TESTS) ** 3 / RADIUS / regressor[:, 0]
    leverage = (np.linalg.qr(regressor)[0] ** 2).sum(axis=1)
    z = -ndtri(-0.5 * np.expm1(np.log1p(-REJECTED) / load.size))
    return float(ndtr(OUTLIER * ERRORS.load / sd * np.sqrt(1.0 - leverage) - z).mean())
