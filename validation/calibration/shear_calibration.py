"""Area ratio and shear strength from synthetic shear tests: bias and coverage of 5,000 calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.sheared import proportional
from validation.check import Claim, Picture, Row, near, reported
from validation.figures import panels
from validation.scenes.repeated_estimates import Errors, histograms, judged
from validation.scenes.sheared_contacts import ERRORS, RATIO, STRENGTH, sheared
from validation.sources import second_method

TRIALS = 5000

# Number of contacts under one friction force.
CONTACTS = (1, 5)

FIT = "mean of 5,000 fits with errors of areas and friction force"
SCATTER = second_method(np.corrcoef, "scatter of the same 5,000 calibrations")


@cache
def measured(contacts: int) -> FloatArray:
    """Return A0, Af and F of all trials, (trials, 3, k)."""
    return sheared(np.random.default_rng(contacts), (TRIALS,), contacts=contacts)[0]


@cache
def results(contacts: int) -> tuple[dict[str, Errors], FloatArray, FloatArray]:
    """Return the errors of B, sigma and sigma B, B and sigma (trials, 2), and their covariance."""
    of = ERRORS.of_area, ERRORS.of_area, ERRORS.of_friction_force
    fit = proportional(measured(contacts), of)
    found, covariance = fit.parameter, fit.covariance
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
    return Claim(title, rows, figures)


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


@panels(4.6, 3.2)
def _figure(ax):
    """Errors of 5,000 calibrations by shear tests of one contact, in units of the uncertainty that each
    states. All must follow the curve.
    """
    histograms([ax], [results(1)[0]], np.linspace(-4.0, 4.0, 41))
