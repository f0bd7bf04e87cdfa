"""Compression tests of which one load is an outlier."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import ContactCalibration, Sample, fit_compression
from metafem.calibration.bounded_interval import WIDTH
from validation.scenes.compression_tests import (
    ENERGY,
    ERRORS,
    MODULUS,
    RADII,
    RADIUS,
    TESTS,
    compression_tests,
    fitted,
)

# Calibrations of each kind.
REPETITIONS = 300

# Outlier in standard deviations of a load.
OUTLIER = 4.0


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
) -> float:
    """Return the share of intervals of E* that hold it."""
    rng = np.random.default_rng(5)
    load, area = np.array([scene(rng, contacts) for _ in range(REPETITIONS)]).transpose(1, 0, 2)
    fit = fitted(load, area, contacts)
    return float((np.abs(fit.modulus - MODULUS) <= WIDTH * np.sqrt(fit.covariance[:, 0, 0])).mean())
