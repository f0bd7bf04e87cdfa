"""Area ratio and shear strength from synthetic shear tests: bias and coverage of 5,000 calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasuredLaw, shear, shear_strength
from metafem.calibration.sheared.fits import parameters
from metafem.calibration.sheared.proportional import proportional
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.paper.surfaces import template
from validation.published import paper, table
from validation.scenes.repeated_estimates import Errors, bias_and_coverage, judged
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
OTHER = "least squares of each line alone on the same data"
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
    bias and with right uncertainties, and states that they are correlated, which two fits of one line each do
    not: the uncertainty of σB from those alone is too large. σ from a surface in full contact, as in the
    paper, has the uncertainty {known:.2g} MPa if E* and B are known, and {calibrated:.2g} MPa with the
    published errors of E* and B; the paper prints 0.004 to 0.006 MPa.
    """
    checks: list[Row] = []
    for contacts in CONTACTS:
        checks += _checks(contacts)
    return Claim(
        "Area ratio and shear strength from areas and friction forces",
        [*checks, *_regressions(), *_full_contact()],
        {
            "errors over their stated uncertainty": Picture(_figure),
            "bias and coverage": Picture(_biases),
        },
        {"known": strengths()[0].sd.mean(), "calibrated": strengths()[1].sd.mean()},
    )


def _checks(contacts: int) -> Iterator[Row]:
    errors, found, covariance = results(contacts)
    case = f"{contacts} contact{'s' * (contacts > 1)}"
    for name, error in errors.items():
        yield from judged(case, name, error)
    stated = covariance[:, 0, 1] / np.sqrt(covariance[:, 0, 0] * covariance[:, 1, 1])
    yield near(
        f"{case}: stated correlation of B and σ",
        float(stated.mean()),
        float(np.corrcoef(found.T)[0, 1]),
        4.0 / math.sqrt(TRIALS),
        SCATTER,
    )
    for name, square in zip(("Af = B A0", "F = σ Af"), _chi_squares(contacts), strict=True):
        deviation = 4.0 * math.sqrt(2.0 * 59.0 / TRIALS)
        yield near(f"{case}: mean chi-square of {name}", square, 59.0, deviation, CHI_SQUARE)
    yield reported(f"{case}: stated uncertainty of B", float(errors["B"].sd.mean()), FIT)
    yield reported(f"{case}: stated uncertainty of σ [MPa]", float(errors["σ"].sd.mean()), FIT)
    yield from _other_estimates(contacts)


def _chi_squares(contacts: int) -> list[float]:
    """Return the mean chi-square of either line."""
    before, areas, force = np.moveaxis(measured(contacts), 1, 0)
    _, found, _ = results(contacts)
    ratio, strength = (each[:, None] for each in found.T)
    value = parameters(measured(contacts), ERRORS)[2]
    area_sd, sheared_sd = ERRORS.of_area(value), ERRORS.of_area(ratio * value)
    force_sd = ERRORS.of_friction_force(ratio * strength * value)
    first = (areas - ratio * before) ** 2 / (sheared_sd**2 + (ratio * area_sd) ** 2)
    second = (force - strength * areas) ** 2 / (force_sd**2 + (strength * sheared_sd) ** 2)
    return [float(each.sum(axis=1).mean()) for each in (first, second)]


def _other_estimates(contacts: int) -> list[Row]:
    """Compare with a fit of each line, with weights at measured values and with plain least squares."""
    data, case = measured(contacts), f"{contacts} contact{'s' * (contacts > 1)}"
    errors, _, _ = results(contacts)
    alone = []
    for rows, friction in ((slice(0, 2), ERRORS.of_area), (slice(1, 3), ERRORS.of_friction_force)):
        factor, variance, _ = proportional(data[:, rows], (ERRORS.of_area, friction))
        alone.append((factor[:, 0], np.sqrt(variance[:, 0, 0])))
    (ratio, ratio_sd), (strength, strength_sd) = alone
    independent = np.hypot(ratio * strength_sd, strength * ratio_sd)
    checks: list[Row] = [
        reported(
            f"{case}: scatter of {name} over that of the fit of its line alone",
            float(errors[name].error.std() / each.std()),
            OTHER,
        )
        for name, each in (("B", ratio), ("σ", strength))
    ]
    checks.append(
        reported(
            f"{case}: uncertainty of σB from those of two separate fits over its scatter",
            float(independent.mean() / (ratio * strength).std()),
            OTHER,
        )
    )
    for name, first, true, deviation in (
        ("B", 0, RATIO, ERRORS.of_area),
        ("σ", 1, STRENGTH, ERRORS.of_friction_force),
    ):
        x, y = data[:, first], data[:, first + 1]
        weight = 1.0 / (deviation(y) ** 2 + (true * ERRORS.of_area(x)) ** 2)
        for what, w in (("weights at measured values", weight), ("plain least squares", np.ones_like(x))):
            slope = (w * x * y).sum(axis=1) / (w * x * x).sum(axis=1)
            bias = float((slope.mean() - true) / errors[name].sd.mean())
            checks.append(reported(f"{case}: {what}, bias of {name} over its uncertainty", bias, OTHER))
    return checks


def _regressions() -> list[Row]:
    """Compare lines with ODRPACK, and the public function with the first of all trials."""
    import odrpack

    data = measured(1)
    apart = []
    for i in range(20):
        x, y = data[i, 1], data[i, 2]
        deviation = (ERRORS.of_area, ERRORS.of_friction_force)
        factor, variance, value = proportional(data[i, 1:], deviation)
        other = odrpack.odr_fit(
            lambda x, beta: beta[0] * x,
            x,
            y,
            np.array([0.3]),
            weight_x=ERRORS.of_area(value) ** -2,
            weight_y=ERRORS.of_friction_force(factor[0] * value) ** -2,
            diff_scheme="central",
            sstol=1e-15,
            partol=1e-15,
        )
        apart.append(abs(other.beta[0] - factor[0]) / math.sqrt(variance[0, 0]))
    one, (_, found, _) = shear(*data[0]), results(1)
    return [
        below(
            "largest difference of σ from ODRPACK over the uncertainty, 20 fits of one line",
            float(max(apart)),
            1e-5,
            second_method(odrpack.odr_fit, "ODRPACK, variances at the fitted values"),
        ),
        near(
            "metafem.calibration.shear on the first set of data, σ [MPa]",
            one.shear_strength,
            float(found[0, 1]),
            1e-9,
            BATCH,
        ),
    ]


@cache
def strengths() -> tuple[Errors, Errors]:
    """Return the errors of sigma of a surface in full contact: with known E* and B, and with errors of both.

    The surface has the heights of Fig. 5, blue. E* and B have the published standard deviations.
    """
    rng = np.random.default_rng(5)
    heights = 1e-3 * np.array(table("table_s2")["blue"])
    surface = template("fig5_blue").replaced(height=heights)
    true, batch = surface.friction.shear_strength, paper()["batch"]["1"]
    sd = np.array([batch["composite_modulus_sd"], batch["area_ratio_sd"]])
    least = mf.equilibrium(surface, approach=float(np.ptp(heights))).load
    law = mf.friction_law(surface, load=least * FULL)
    errors: list[tuple[float, ...]] = []
    for _ in range(SURFACES):
        load = law.load + ERRORS.of_load(law.load) * rng.standard_normal(law.load.shape)
        force = law.friction_force + ERRORS.of_friction_force(law.friction_force) * rng.standard_normal(
            law.load.shape
        )
        modulus, ratio = [surface.material.composite_modulus, surface.friction.area_ratio] + sd * (
            rng.standard_normal(2)
        )
        found = MeasuredLaw(load, friction_force=force, material=surface.material, friction=surface.friction)
        known = shear_strength(found, surface, 1.5 * least)
        calibrated = surface.replaced(material=mf.Material(modulus), friction=mf.Friction(true, ratio))
        whole = shear_strength(found, calibrated, 1.5 * least, covariance=np.diag(sd**2))
        errors.append(
            (
                known.shear_strength - true,
                math.sqrt(known.covariance[-1, -1]),
                whole.shear_strength - true,
                math.sqrt(whole.covariance[-1, -1]),
            )
        )
    columns = np.array(errors).T
    return Errors(columns[0], columns[1]), Errors(columns[2], columns[3])


def _full_contact() -> Iterator[Row]:
    for what, found in zip(("E* and B known", "E* and B calibrated"), strengths(), strict=True):
        case = f"full contact, {what}"
        yield from judged(case, "σ", found)
        yield reported(f"{case}: stated uncertainty of σ [MPa]", float(found.sd.mean()), FIT)


@panels(8.0, 3.2, columns=2, sharey=True)
def _figure(*axes):
    """Errors of 5,000 calibrations in units of the uncertainty that each states, by shear tests of one
    contact and by a surface that is in contact everywhere. All must follow the curve.
    """
    edges, x = np.linspace(-4.0, 4.0, 41), np.linspace(-4.0, 4.0, 400)
    errors, _, _ = results(1)
    full = dict(zip(("E*, B known", "E*, B measured"), strengths(), strict=True))
    for ax, drawn in zip(axes, (errors, full), strict=True):
        for name, found in drawn.items():
            ax.hist(found.error / found.sd, edges, density=True, histtype="step", lw=1.4, label=name)
        ax.plot(x, np.exp(-0.5 * x**2) / math.sqrt(2.0 * math.pi), color="black", lw=0.9, label="as stated")
        ax.set_xlabel("error over the stated uncertainty")
    axes[0].set_ylabel("density")
    axes[0].set_title("shear tests", fontsize="medium")
    axes[1].set_title("fully contacting surface", fontsize="medium")


def _biases():
    """Left, the mean error in units of the stated uncertainty. Right, the share of 68 % intervals that hold
    the true value. All points must lie in the grey bands.
    """
    found = {
        f"{contacts} contact{'s' * (contacts > 1)}: {name}": error
        for contacts in CONTACTS
        for name, error in results(contacts)[0].items()
    }
    full = zip(("E* and B known", "E* and B calibrated"), strengths(), strict=True)
    return bias_and_coverage({"": found | {f"full contact, {what}: σ": error for what, error in full}})
