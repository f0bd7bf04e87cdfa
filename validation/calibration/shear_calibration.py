"""Area ratio and shear strength from synthetic shear tests: bias and coverage of 5,000 calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import shear
from metafem.calibration.sheared import parameters, proportional
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.scenes.repeated_estimates import Errors, histograms, judged
from validation.scenes.sheared_contacts import ERRORS, RATIO, STRENGTH, sheared
from validation.sources import second_method

TRIALS = 5000

# Number of contacts under one friction force.
CONTACTS = (1, 5)

FIT = "mean of 5,000 fits with errors of areas and friction force"
SCATTER = second_method(np.corrcoef, "scatter of the same 5,000 calibrations")
BATCH = second_method(parameters, "the same data among 5,000 that are fitted at once")


@cache
def measured(contacts: int) -> FloatArray:
    """Return A0, Af and F of all trials, (trials, 3, k)."""
    return sheared(np.random.default_rng(contacts), (TRIALS,), contacts=contacts)[0]


@cache
def results(contacts: int) -> tuple[dict[str, Errors], FloatArray, FloatArray]:
    """Return the errors of B, sigma and sigma B, B and sigma (trials, 2), and their covariance."""
    found, covariance, _ = parameters(measured(contacts), ERRORS)
    ratio, strength = found.T
    product = np.stack([strength, ratio], axis=-1)
    square = np.einsum("ni,nij,nj->n", product, covariance, product)
    errors = {
        "B": Errors(ratio - RATIO, np.sqrt(covariance[:, 0, 0])),
        "σ": Errors(strength - STRENGTH, np.sqrt(covariance[:, 1, 1])),
        "σB": Errors(ratio * strength - RATIO * STRENGTH, np.sqrt(square)),
    }
    return errors, found, covariance


def claim() -> Claim:
    """Synthetic shear tests of known area ratio B and shear strength σ are calibrated 5,000 times, with the
    error bars of the paper: ±1.4 µm at the edge of a contact, ±(1 mN + 0.01 F). One fit finds both, without
    bias and with right uncertainties, and states that they are correlated.
    """
    rows = [row for contacts in CONTACTS for row in _checks(contacts)]
    title = "Area ratio and shear strength from areas and friction forces"
    figures = {"errors over their stated uncertainty": Picture(_figure)}
    return Claim(title, [*rows, *_regressions()], figures)


def _checks(contacts: int) -> Iterator[Row]:
    errors, found, covariance = results(contacts)
    case = f"{contacts} contact{'s' * (contacts > 1)}"
    for name, error in errors.items():
        yield from judged(case, name, error)
    stated = float((covariance[:, 0, 1] / np.sqrt(covariance[:, 0, 0] * covariance[:, 1, 1])).mean())
    scatter = float(np.corrcoef(found.T)[0, 1])
    yield near(f"{case}: stated correlation of B and σ", stated, scatter, 4.0 / math.sqrt(TRIALS), SCATTER)
    yield reported(f"{case}: stated uncertainty of B", float(errors["B"].sd.mean()), FIT)
    yield reported(f"{case}: stated uncertainty of σ [MPa]", float(errors["σ"].sd.mean()), FIT)


def _regressions() -> Iterator[Row]:
    """Compare lines with ODRPACK, and the public function with the first of all trials."""
    import odrpack

    data = measured(1)
    apart = []
    for x, y in data[:20, 1:]:
        fit = proportional(np.stack([x, y]), (ERRORS.of_area, ERRORS.of_friction_force))
        factor, variance, value = fit.parameter, fit.covariance, fit.abscissa[:, 0]
        other = odrpack.odr_fit(
            lambda x, beta: beta[0] * x, x, y, np.array([0.3]), weight_x=ERRORS.of_area(value) ** -2,
            weight_y=ERRORS.of_friction_force(factor[0] * value) ** -2,
            diff_scheme="central", sstol=1e-15, partol=1e-15,
        )  # fmt: skip
        apart.append(abs(other.beta[0] - factor[0]) / math.sqrt(variance[0, 0]))
    name = "largest difference of σ from ODRPACK over the uncertainty, 20 fits of one line"
    source = second_method(odrpack.odr_fit, "ODRPACK, variances at the fitted values")
    yield below(name, float(max(apart)), 1e-5, source)
    strength = shear(*data[0]).shear_strength
    name = "metafem.calibration.shear on the first set of data, σ [MPa]"
    yield near(name, strength, float(results(1)[1][0, 1]), 1e-9, BATCH)


@panels(4.6, 3.2)
def _figure(ax):
    """Errors of 5,000 calibrations by shear tests of one contact, in units of the uncertainty that each
    states. All must follow the curve.
    """
    histograms([ax], [results(1)[0]], np.linspace(-4.0, 4.0, 41))
