"""The compliance of a cap's pedestal: the table of the models, compared with finite elements."""

from __future__ import annotations

import math

import numpy as np

from metafem.contact.pedestal import pedestal_compliance
from validation.check import Claim, Picture, below
from validation.figures import panels
from validation.finite_elements.pedestal import measure_pedestal
from validation.scenes.pedestals import FOOT_RATIOS, TABLE
from validation.sources import second_method

# h/R and contact radius over foot radius, between the nodes of the table.
BETWEEN = ((0.06, 0.3), (0.23, 0.5), (0.38, 0.1), (0.57, 0.3))

# Several seconds of finite elements.
SLOW = True

SOURCE = second_method(measure_pedestal, "finite elements of a shape between the nodes of the table")


def claim() -> Claim:
    """Below its contact a cap yields as a pedestal on the block. The models interpolate this compliance in a
    table over the shape of the cap and the size of the contact. Here it is computed by finite elements at
    four shapes between the nodes of the table.
    """
    checks = []
    for ratio, fraction in BETWEEN:
        a = fraction * math.sqrt(ratio * (2.0 - ratio))
        error = abs(float(pedestal_compliance(ratio, 1.0, a)) / measure_pedestal(ratio, a) - 1.0)
        checks.append(below(f"h/R = {ratio}, a/R = {a:.3f}: error of the table", error, 1e-3, SOURCE))
    figures = {"Compliance of the pedestal": Picture(_figure)}
    return Claim("The pedestal's compliance", checks, figures)


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
