"""Area ratio and shear strength from synthetic shear tests: bias and coverage of 5,000 calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasuredLaw, shear, shear_strength
from metafem.calibration.sheared import parameters, proportional
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.paper.surfaces import template
from validation.published import table
from validation.scenes.repeated_estimates import Errors, histograms, judged
from validation.scenes.sheared_contacts import ERRORS, RATIO, STRENGTH, sheared
from validation.sources import known_input, second_method

SLOW = True

# Calibrations by shear tests, and by fully contacting surfaces.
TRIALS, SURFACES = 5000, 5000

# Number of contacts under one friction force.
CONTACTS = (1, 5)

# Loads of the fully contacting surface over that at which its last asperity comes into contact.
FULL = np.linspace(2.0, 6.0, 12)

FIT = "mean of 5,000 fits with errors of areas and friction force"
CHI_SQUARE = known_input("noise of known size in 60 points, one number fitted: chi-square of mean 59")
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
    bias and with right uncertainties, and states that they are correlated. σ from a surface in full contact,
    as in the paper, has the uncertainty {known:.2g} MPa if E* and B are known; the paper, with the errors of
    both, prints 0.004 to 0.006 MPa.
    """
    figures = {
        "errors over their stated uncertainty": Picture(_figure),
    }
    rows = [row for contacts in CONTACTS for row in _checks(contacts)]
    return Claim(
        "Area ratio and shear strength from areas and friction forces",
        [*rows, *_regressions(), *_full_contact()],
        figures,
        {"known": strengths().sd.mean()},
    )


def _case(contacts: int) -> str:
    return f"{contacts} contact{'s' * (contacts > 1)}"


def _checks(contacts: int) -> Iterator[Row]:
    errors, found, covariance = results(contacts)
    case = _case(contacts)
    for name, error in errors.items():
        yield from judged(case, name, error)
    stated = float((covariance[:, 0, 1] / np.sqrt(covariance[:, 0, 0] * covariance[:, 1, 1])).mean())
    scatter = float(np.corrcoef(found.T)[0, 1])
    yield near(f"{case}: stated correlation of B and σ", stated, scatter, 4.0 / math.sqrt(TRIALS), SCATTER)
    deviation = 4.0 * math.sqrt(2.0 * 59.0 / TRIALS)
    for name, square in zip(("Af = B A0", "F = σ Af"), _chi_squares(contacts), strict=True):
        yield near(f"{case}: mean chi-square of {name}", square, 59.0, deviation, CHI_SQUARE)
    yield reported(f"{case}: stated uncertainty of B", float(errors["B"].sd.mean()), FIT)
    yield reported(f"{case}: stated uncertainty of σ [MPa]", float(errors["σ"].sd.mean()), FIT)


def _chi_squares(contacts: int) -> list[float]:
    """Return the mean chi-square of either line."""
    before, areas, force = np.moveaxis(measured(contacts), 1, 0)
    found, _, fit = parameters(measured(contacts), ERRORS)
    value = fit.abscissa[..., 0]
    ratio, strength = (each[:, None] for each in found.T)
    area_sd, sheared_sd = ERRORS.of_area(value), ERRORS.of_area(ratio * value)
    force_sd = ERRORS.of_friction_force(ratio * strength * value)
    first = (areas - ratio * before) ** 2 / (sheared_sd**2 + (ratio * area_sd) ** 2)
    second = (force - strength * areas) ** 2 / (force_sd**2 + (strength * sheared_sd) ** 2)
    return [float(each.sum(axis=1).mean()) for each in (first, second)]


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


@cache
def strengths() -> Errors:
    """Return the errors of sigma of a surface in full contact, with known E* and B: that of Fig. 5, blue."""
    rng = np.random.default_rng(5)
    heights = 1e-3 * np.array(table("table_s2")["blue"])
    surface = template("fig5_blue").replaced(height=heights)
    least = mf.equilibrium(surface, approach=float(np.ptp(heights))).load
    law = mf.friction_law(surface, load=least * FULL)
    fits = []
    for _ in range(SURFACES):
        load = law.load + ERRORS.of_load(law.load) * rng.standard_normal(law.load.shape)
        force_sd = ERRORS.of_friction_force(law.friction_force)
        force = law.friction_force + force_sd * rng.standard_normal(law.load.shape)
        pair = {"material": surface.material, "friction": surface.friction}
        fits.append(shear_strength(MeasuredLaw(load, friction_force=force, **pair), surface, 1.5 * least)[:2])
    strength, sd = np.transpose(fits)
    return Errors(strength - surface.friction.shear_strength, sd)


def _full_contact() -> Iterator[Row]:
    yield from judged("full contact, E* and B known", "σ", strengths())
    sd = float(strengths().sd.mean())
    yield reported("full contact, E* and B known: stated uncertainty of σ [MPa]", sd, FIT)


@panels(8.0, 3.2, columns=2, sharey=True)
def _figure(*axes):
    """Errors of 5,000 calibrations in units of the uncertainty that each states, by shear tests of one
    contact and by a surface that is in contact everywhere. All must follow the curve.
    """
    histograms(axes, (results(1)[0], {"E* and B known": strengths()}), np.linspace(-4.0, 4.0, 41))
    for ax, title in zip(axes, ("shear tests", "fully contacting surface"), strict=True):
        ax.set_title(title, fontsize="medium")
