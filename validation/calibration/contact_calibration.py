"""E* and adhesion energy from synthetic compression tests: bias and coverage of 5,000 calibrations."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from metafem.calibration.compression import of_root
from metafem.calibration.statistics import Fit, bounded_interval
from validation.check import Claim, Picture, Row, near, reported
from validation.figures import panels
from validation.scenes.compression_tests import (
    ENERGY,
    MODULUS,
    compression_tests,
    fitted,
    straight_line,
)
from validation.scenes.repeated_estimates import (
    ALLOWED,
    COVERED,
    NOMINAL,
    Errors,
    histograms,
    judged,
)
from validation.sources import known_input

TRIALS = 5000

# Number of contacts under one load, and adhesion energies [N/mm].
CONTACTS, ENERGIES = (1, 5), (ENERGY, 0.0)

NAMES = ("E*", "√w")

METHODS = {"fit": "fit with errors on both axes", "line": "straight line of the paper"}

FIT = "mean of 5,000 fits with errors of load and area"
LINE = "least squares of the paper's straight line on the same data"
CHI_SQUARE = known_input("noise of known size in 60 points, two numbers fitted: chi-square of mean 58")


@cache
def results(contacts: int, energy: float) -> tuple[Fit, dict[str, Errors]]:
    """Return the fits of all trials, and the errors of E* and sqrt(w) by the fit and by the line.

    The straight line has no errors of its own here; those of the fit are its scale.
    """
    load, area = compression_tests(TRIALS, contacts, energy, np.random.default_rng(0))
    fit, line = fitted(load, area, contacts), straight_line(load / contacts, area / contacts)
    value, covariance = of_root(fit)
    true, sd = (
        np.array([MODULUS, math.sqrt(energy)]),
        np.sqrt(np.diagonal(covariance, axis1=1, axis2=2)),
    )
    by_line = np.stack([line.composite_modulus, line.adhesion_root], axis=-1)
    errors = {
        f"{name}, {quantity}": Errors((estimate - true)[:, i], sd[:, i])
        for name, estimate in (("fit", value), ("line", by_line))
        for i, quantity in enumerate(NAMES)
    }
    return fit, errors


def claim() -> Claim:
    """Synthetic compression tests of known E* and adhesion energy w are calibrated 5,000 times: three tests
    of 20 loads at contact radii from 0.08 to 0.4 mm, with the error bars of the paper, ±5 mN and ±1.4 µm at
    the edge of a contact. The fit finds both without bias, and its uncertainties are right. The straight line
    of the paper has the errors on its horizontal axis, which least squares neglect: its mean E* is too large
    where one contact bears the load, and less so with five contacts under one load, as in the paper.
    """
    rows = [row for contacts in CONTACTS for energy in ENERGIES for row in _checks(contacts, energy)]
    figures = {"errors over their stated uncertainty": Picture(_figure)}
    return Claim("E* and adhesion energy from loads and areas", rows, figures)


def _checks(contacts: int, energy: float) -> Iterator[Row]:
    fit, errors = results(contacts, energy)
    case = f"{contacts} contact{'s' * (contacts > 1)}, w = {1e6 * energy:g} mJ/m²"
    for name in NAMES:
        yield from judged(case, name, errors[f"fit, {name}"])
    value, covariance = of_root(fit)
    low, high = bounded_interval(value[:, 1], np.sqrt(covariance[:, 1, 1]))
    covered = float(((low**2 <= energy) & (energy <= high**2)).mean())
    yield near(f"{case}: 68 % intervals of w that hold it", covered, NOMINAL, ALLOWED, COVERED)
    square, off = float(fit.chi_square.sum(axis=1).mean()), 4.0 * math.sqrt(116.0 / TRIALS)
    yield near(f"{case}: mean chi-square", square, 58.0, off, CHI_SQUARE)
    yield reported(f"{case}: stated uncertainty of E* [MPa]", float(errors["fit, E*"].sd.mean()), FIT)
    line = f"{case}: paper's line"
    modulus, root = (float(errors[f"line, {name}"].error.mean()) for name in NAMES)
    yield reported(f"{line}, mean E* [MPa]", MODULUS + modulus, LINE)
    yield reported(f"{line}, w of the mean √w [mJ/m²]", 1e6 * (math.sqrt(energy) + root) ** 2, LINE)


@panels(8.0, 3.2, columns=2, sharey=True)
def _figure(*axes):
    """Errors of 5,000 calibrations with one contact under the load, in units of the uncertainty that each
    states. The fit with errors on both axes follows the curve, as it must; the paper's straight line finds
    too large an E* and too much adhesion.
    """
    errors = results(1, ENERGY)[1]
    found = [{METHODS[method]: errors[f"{method}, {name}"] for method in METHODS} for name in NAMES]
    histograms(axes, found, np.linspace(-5.0, 8.0, 66))
    for ax, name in zip(axes, NAMES, strict=True):
        ax.set_title(name, fontsize="medium")
