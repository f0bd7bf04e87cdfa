"""Sentences about the errors that explain a measured law."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import MICROMETRES, percent, two_digits
from metafem.calibration.verdict import Verdict, chi

# Names of causes and groups of causes in sentences.
NAMES = {
    "tilt": "tilt",
    "angle_x": "tilt along x",
    "angle_y": "tilt along y",
    "height_scale": "height scale",
    "composite_modulus": "E*",
    "friction": "σB",
    "adhesion_root": "√w",
    "height": "single heights",
    "radius": "radii",
    "position": "positions",
}

# Smallest share of the misfit that is stated in a sentence.
SMALL = 0.01

# Smallest difference of log evidence at which the data favour a model (odds of 20 to 1).
FAVOURED = math.log(20.0)

# Logarithm of the largest odds that are printed as a number.
LARGE = math.log(1e6)


def amount(name: str, value: float, form: str = "+.3g") -> str:
    """Return an error as text with its unit: degrees for angles, percent for factors, um for lengths."""
    if name.startswith("angle"):
        return f"{math.degrees(value):{form}}°"
    if name in ("height", "radius", "position"):
        return f"{MICROMETRES * value:{form}} µm"
    return percent(value, form)


def interval(name: str, mean: float, sd: float, form: str = "+.3g") -> str:
    """Return an error and its standard deviation as text."""
    return f"{amount(name, mean, form)} ± {amount(name, sd, '.2g')}"


def spread(name: str, mean: FloatArray, sd: FloatArray) -> str:
    """Return text on the size of the errors of single asperities."""
    rms = amount(name, float(np.sqrt((mean**2).mean())), ".2g")
    return f"{rms} rms, each ± {amount(name, float(np.median(sd)), '.2g')}"


def stated(name: str, found: str, prior_sd: float) -> str:
    """Return text that compares an error with its prior standard deviation."""
    return f"{NAMES[name]} {found} (expected: 0 ± {amount(name, prior_sd, '.2g')})"


def misfit(design: float, left: float, count: int, areas: bool) -> str:
    """Return a sentence on the misfit before and after; `areas` states whether contact areas are included."""
    values = "1 measured value" if count == 1 else f"{count} measured values"
    return (
        f"The measured law differs from the design by chi² = {chi(design)} over {values}"
        f"{', the areas of the single contacts included' if areas else ''}; with the errors found it is "
        f"{chi(left)}."
    )


def ranking(shares: Mapping[str, float]) -> list[str]:
    """Return sentences on the causes that explain the misfit, the largest share first."""
    named = [f"{NAMES[name]} ({part(value)})" for name, value in shares.items() if value >= SMALL]
    if not named:
        return []
    found = [f"It is explained by {joined(named)}."]
    against = [f"{NAMES[name]} ({part(value)})" for name, value in shares.items() if value <= -SMALL]
    if against:
        found.append(
            f"All shares add to 100 %: negative is that of {joined(against)}, which takes back a part of "
            "what the others explain."
        )
    return found


def part(share: float) -> str:
    """Return a share of the misfit as text in whole percent."""
    return percent(round(share, 2) + 0.0, ".0f")


def outlier(name: str, i: int, sites: IntArray | None, mean: float, sd: float, prior_sd: float) -> str:
    """Return a sentence on an asperity whose error is far outside its tolerance."""
    asperity = f"Asperity {i}" if sites is None else f"The asperity at site {sites[i]}"
    words = {"height": ("higher", "lower"), "radius": ("larger in radius", "smaller in radius")}[name]
    return (
        f"{asperity} is {interval(name, abs(mean), sd, '.3g')} {words[int(mean <= 0.0)]} than designed, "
        f"{abs(mean) / prior_sd:.0f} times the expected deviation."
    )


def unresolved(change: Mapping[str, float], variance_left: float) -> str:
    """Return a sentence on a combination of errors that the data do not determine."""
    left = percent(math.sqrt(min(variance_left, 1.0)), ".0f")
    if len(change) == 1:
        (name,) = change
        return f"These values do not determine {NAMES[name]}: {left} of its expected deviation is left."
    parts = joined([f"{amount(name, value, '+.2g')} of {NAMES[name]}" for name, value in change.items()])
    named = joined([NAMES[name] for name in change])
    return (
        f"These values do not tell {named} apart: {parts} together change them by less than their errors "
        f"({left} of the expected deviation is left)."
    )


def joined(words: list[str]) -> str:
    """Return words joined as a list for a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def models(log_evidence: Mapping[str, float]) -> list[str]:
    """Return sentences on the model that the measured values favour."""
    if len(log_evidence) < 2:
        return []
    (best, most), (second, less), *_ = sorted(log_evidence.items(), key=lambda item: -item[1])
    ratio = most - less
    odds = two_digits(math.exp(ratio)) if ratio < LARGE else "more than 10^6"
    if ratio < FAVOURED:
        return [f"The measured values do not tell the models {best} and {second} apart ({odds} to 1)."]
    return [f"The measured values favour the model {best} over {second} ({odds} to 1)."]


def remaining(verdict: Verdict) -> str:
    """Return a sentence on the residuals that remain unexplained."""
    if verdict.fits:
        return f"What remains is no larger than the errors of the measurement: {verdict}."
    return f"Other errors remain: what is left is not explained by the errors of the measurement; {verdict}."
