"""The compliance of a cap's pedestal: the fit, compared with finite elements at small and at large strain."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.interpolate import PchipInterpolator

from metafem.contact.pedestal import pedestal_compliance
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.finite_elements.frozen_meshes import DEEP_HEIGHTS, FOLDER, RADIUS, SOFT_HEIGHT, deep_caps
from validation.finite_elements.pedestal import measure_pedestal
from validation.scenes.pedestals import FOOT_RATIOS, TABLE
from validation.sources import self_consistency

# h/R and contact radius over foot radius, between the nodes of the table.
BETWEEN = ((0.06, 0.3), (0.23, 0.5), (0.38, 0.1), (0.57, 0.3))

# Several seconds of finite elements.
SLOW = True

SOURCE = self_consistency(measure_pedestal, "finite elements of a shape between the nodes of the fit")

# Heights of the two caps that are compared at large strain [mm], and the error of the fit's limit at light
# loads that is allowed: at large strain it falls by 2 % from a/R = 0.11 to 0.18.
LOW, HIGH, LARGE_STRAIN = SOFT_HEIGHT, DEEP_HEIGHTS[0], 0.03
STORED = self_consistency(deep_caps, "stored finite elements at large strain, neo-Hookean caps")


def claim() -> Claim:
    """Below its contact a cap yields as a pedestal on the block. A formula of the shape of the cap and of the
    size of the contact is fitted to this compliance at small strain. It is compared with finite elements at
    four shapes between those of the fit. Models with `pedestal=True` use its limit at light loads, as the
    growth with the contact is that of the contact law. This limit is compared with large strain: with the
    difference of two caps of a neo-Hookean material at equal loads, from the contact laws in `meshes`. No
    code but that of metafem computes pedestals.
    """
    checks: list[Row] = []
    for ratio, fraction in BETWEEN:
        a = fraction * math.sqrt(ratio * (2.0 - ratio))
        error = abs(float(pedestal_compliance(ratio, 1.0, a)) / measure_pedestal(ratio, a) - 1.0)
        checks.append(below(f"h/R = {ratio}, a/R = {a:.3f}: error of the fit", error, 1e-3, SOURCE))
        limit = float(pedestal_compliance(ratio, 1.0) / pedestal_compliance(ratio, 1.0, a))
        name = f"h/R = {ratio}, a/R = {a:.3f}: limit at light loads over the fit"
        checks.append(reported(name, limit, "small strain"))
    checks += _large_strain()
    figures = {"Compliance of the pedestal": Picture(_figure)}
    return Claim("The pedestal's compliance", checks, figures)


def _large_strain() -> Iterator[Row]:
    """Compare c_p R of a cap, less that of a lower one, with the stored laws of both at equal loads."""
    depth, load, area = deep_caps()[HIGH].T
    low_depth, low_load, _ = np.log(np.loadtxt(FOLDER / "soft_cap.csv", delimiter=",", skiprows=1).T)
    lower = np.exp(PchipInterpolator(low_load, low_depth)(np.log(load)))
    expected = math.pi * RADIUS * (depth - lower) / load
    limit = float(np.diff(pedestal_compliance([LOW, HIGH], RADIUS))[0] * RADIUS)
    words = f"c_p R at light loads of a cap {HIGH:g} mm high, less that of {LOW:g} mm"
    yield near(words, limit, expected[0], LARGE_STRAIN * expected[0], STORED)
    for radius, value in zip(np.sqrt(area / math.pi) / RADIUS, expected, strict=True):
        if radius < 0.5:
            yield reported(f"the same at large strain, a/R = {radius:.2g}", value, STORED.text)


@panels(5.0, 3.4)
def _figure(ax):
    """Compliance of the pedestal, times R, over the height of the cap relative to R: nodes of the table
    (dots) and their interpolation (lines), for contacts of 0.05, 0.2, 0.4 and 0.6 of the foot's radius, which
    lie close together. High caps yield more, and nearly independently of the size of the contact.
    """
    table = np.array(TABLE)
    ratio = np.linspace(table[0, 0], table[-1, 0], 80)
    for fraction, column in zip(FOOT_RATIOS, table[:, 1:].T, strict=True):
        ax.plot(table[:, 0], column, "o", ms=3)
        a = fraction * np.sqrt(ratio * (2.0 - ratio))
        ax.plot(ratio, pedestal_compliance(ratio, 1.0, a), "k-", lw=0.7)
    ax.set(xlabel="h/R", ylabel="compliance c_p R", title="contacts of 0.05, 0.2, 0.4, 0.6 of the foot")
    ax.title.set_fontsize(9)
