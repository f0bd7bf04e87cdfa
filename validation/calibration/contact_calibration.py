"""E* and adhesion energy from synthetic compression tests: bias and coverage of 5,000 calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import fit_compression
from metafem.calibration.bounded_interval import bounded_interval
from metafem.calibration.compression.adhesive_line import adhesive_line
from metafem.calibration.compression.distance_fit import DistanceFit, adhesive_load, distance_fit
from metafem.calibration.compression.scene import cap_curve
from metafem.contact import Hertz
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.scenes.compression_tests import ENERGY, ERRORS, MODULUS, RADIUS, compression_tests, fitted
from validation.scenes.repeated_estimates import (
    ALLOWED,
    COVERED,
    NOMINAL,
    Errors,
    histograms,
    judged,
)
from validation.sources import known_input, second_method

TRIALS = 5000

# Number of contacts under one load, and adhesion energies [N/mm].
CONTACTS, ENERGIES = (1, 5), (ENERGY, 0.0)

# True values of the estimates with adhesion.
TRUE = (("E*", MODULUS), ("√w", math.sqrt(ENERGY)))

METHODS = {"fit": "fit with errors on both axes", "line": "straight line of the paper"}

FIT = "mean of 5,000 fits with errors of load and area"
LINE = "least squares of the paper's straight line on the same data"
CHI_SQUARE = known_input("noise of known size in 60 points, two numbers fitted: chi-square of mean 58")
BATCH = second_method(distance_fit, "the same data among 5,000 that are fitted at once")


@cache
def results(contacts: int, energy: float) -> tuple[DistanceFit, dict[str, Errors]]:
    """Return the fits of all trials, and the errors of E* and sqrt(w) by the fit and by the line."""
    load, area = compression_tests(TRIALS, contacts, energy, np.random.default_rng(0))
    fit = fitted(load, area, contacts)
    line = adhesive_line(load / contacts, area / contacts, RADIUS)
    true = np.array([MODULUS, math.sqrt(energy)])
    errors = {}
    for name, estimate, covariance in (
        ("fit", np.stack([fit.modulus, fit.root], axis=-1), fit.root_covariance),
        ("line", np.stack([line.composite_modulus, line.adhesion_root], axis=-1), line.root_covariance),
    ):
        sd = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        for i, quantity in enumerate(("E*", "√w")):
            errors[f"{name}, {quantity}"] = Errors((estimate - true)[:, i], sd[:, i])
    return fit, errors


def claim() -> Claim:
    """Synthetic compression tests of known E* and adhesion energy w are calibrated 5,000 times: three tests
    of 20 loads at contact radii from 0.08 to 0.4 mm, with the error bars of the paper, ±5 mN and ±1.4 µm at
    the edge of a contact. The fit finds both without bias, and its uncertainties are right. The straight line
    of the paper has the errors on its horizontal axis, which least squares neglect. Where one contact bears
    the load, its mean E* is {modulus_of_one} and its mean √w {root_of_one} times the true one; with five
    contacts under one load, as in the paper, {modulus_of_five} and {root_of_five} times.
    """
    rows = [row for contacts in CONTACTS for energy in ENERGIES for row in _checks(contacts, energy)]
    values = {
        f"{key}_of_{word}": f"{1 + results(n, ENERGY)[1][f'line, {name}'].error.mean() / true:.3f}"
        for n, word in zip(CONTACTS, ("one", "five"), strict=True)
        for key, (name, true) in zip(("modulus", "root"), TRUE, strict=True)
    }
    return Claim(
        "E* and adhesion energy from loads and areas",
        [*rows, *_regressions()],
        {"errors over their stated uncertainty": Picture(_figure)},
        values,
    )


def _case(contacts: int, energy: float) -> str:
    return f"{contacts} contact{'s' * (contacts > 1)}, w = {1e6 * energy:g} mJ/m²"


def _checks(contacts: int, energy: float) -> Iterator[Row]:
    fit, errors = results(contacts, energy)
    case = _case(contacts, energy)
    for name in ("E*", "√w"):
        yield from judged(case, name, errors[f"fit, {name}"])
    low, high = bounded_interval(fit.root, np.sqrt(fit.root_covariance[:, 1, 1]))
    covered = float(((low**2 <= energy) & (energy <= high**2)).mean())
    yield near(f"{case}: 68 % intervals of w that hold it", covered, NOMINAL, ALLOWED, COVERED)
    square, off = float((fit.residual**2).sum(axis=1).mean()), 4.0 * math.sqrt(116.0 / TRIALS)
    yield near(f"{case}: mean chi-square", square, 58.0, off, CHI_SQUARE)
    yield reported(f"{case}: stated uncertainty of E* [MPa]", float(errors["fit, E*"].sd.mean()), FIT)
    for name in ("E*", "√w"):
        found, line = errors[f"line, {name}"], f"{case}: paper's line"
        yield reported(f"{line}, bias of {name} over its uncertainty", found.bias, LINE)
        yield reported(f"{line}, 68 % intervals of {name} that hold it", found.coverage, LINE)
    modulus, root = (float(errors[f"line, {name}"].error.mean()) for name in ("E*", "√w"))
    yield reported(f"{line}, mean E* [MPa]", MODULUS + modulus, LINE)
    yield reported(f"{line}, w of the mean √w [mJ/m²]", 1e6 * (math.sqrt(energy) + root) ** 2, LINE)


def square_variance(mean: float, sd: float) -> float:
    """Return the variance of the square of a normal variable, by a million draws."""
    return float((np.random.default_rng(1).normal(mean, sd, 1_000_000) ** 2).var())


def _regressions() -> Iterator[Row]:
    """Compare single fits with ODRPACK and with the public function."""
    import odrpack

    load, area = compression_tests(TRIALS, 1, ENERGY, np.random.default_rng(0))
    curve = cap_curve(Hertz(), RADIUS).load_and_slope

    def law(x: FloatArray, beta: FloatArray) -> FloatArray:
        return np.asarray(beta[0] * curve(x)[0] - beta[1] * adhesive_load(x)[0])

    fit, _ = results(1, ENERGY)
    apart = []
    for i in range(20):
        sd = ERRORS.of_area(fit.area[i, :, 0])
        other = odrpack.odr_fit(
            law, area[i], load[i], np.array([1.0, 0.0]), weight_x=sd**-2, weight_y=ERRORS.load**-2,
            diff_scheme="central", sstol=1e-15, partol=1e-15,
        )  # fmt: skip
        apart.append(abs(other.beta[0] - fit.modulus[i]) / math.sqrt(fit.covariance[i, 0, 0]))
    one = fit_compression(load[0], area[0], RADIUS).composite_modulus
    few = fit_compression(*np.concatenate(compression_tests(1, 1, 0.0, np.random.default_rng(0))), RADIUS)
    mean, sd = max(few.adhesion_root, 0.0), math.sqrt(few.root_covariance[1, 1])
    ratio = float(few.covariance[1, 1]) / square_variance(mean, sd)
    other_fit = second_method(odrpack.odr_fit, "ODRPACK, variances of the fitted areas")
    draws = second_method(square_variance, "variance of the squares of normal draws of √w")
    name = "largest difference of E* from ODRPACK over the uncertainty, 20 fits"
    yield below(name, float(max(apart)), 1e-5, other_fit)
    yield near("contacts without adhesion: variance of w over that of draws", ratio, 1.0, 0.02, draws)
    name = "metafem.calibration.fit_compression on the first set of data, E* [MPa]"
    yield near(name, one, float(fit.modulus[0]), 1e-9, BATCH)


@panels(8.0, 3.2, columns=2, sharey=True)
def _figure(*axes):
    """Errors of 5,000 calibrations with one contact under the load, in units of the uncertainty that each
    states. The fit with errors on both axes follows the curve, as it must; the paper's straight line finds
    too large an E* and too much adhesion, with uncertainties that do not cover it.
    """
    errors = results(1, ENERGY)[1]
    found = [{METHODS[method]: errors[f"{method}, {name}"] for method in METHODS} for name, _ in TRUE]
    histograms(axes, found, np.linspace(-5.0, 8.0, 66))
    for ax, (name, _) in zip(axes, TRUE, strict=True):
        ax.set_title(name, fontsize="medium")
