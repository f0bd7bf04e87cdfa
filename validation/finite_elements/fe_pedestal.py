"""The compliance of a cap's pedestal: the models' table against finite elements."""

from __future__ import annotations

import math

import numpy as np

from metafem import fe
from metafem.contact.cap_compliance import SHARES, TABLE, pedestal_compliance
from metafem.drawing import new_figure
from validation.check import Claim, below

# Between the rows and columns of the table.
PLACES = ((0.06, 0.3), (0.23, 0.5), (0.38, 0.1), (0.57, 0.3))

# Several seconds of finite elements: the test suite runs it with the slow ones.
SLOW = True


def claim() -> Claim:
    """Compute the compliance anew where the table has no row."""
    checks = []
    for ratio, share in PLACES:
        a = share * math.sqrt(ratio * (2.0 - ratio))
        error = abs(float(pedestal_compliance(ratio, 1.0, a)) / fe.measure_pedestal(ratio, a) - 1.0)
        checks.append(
            below(f"h/R = {ratio}, a/R = {a:.3f}: error of the fit", error, 1e-3, "finite elements")
        )
    return Claim("The pedestal's compliance", checks, {"compliance": _figure})


def _figure():
    figure = new_figure(5.0, 3.4)
    ax = figure.add_subplot()
    table = np.array(TABLE)
    ratio = np.linspace(table[0, 0], table[-1, 0], 80)
    for share, column in zip(SHARES, table[:, 1:].T, strict=True):
        ax.plot(table[:, 0], column, "o", ms=3)
        a = share * np.sqrt(ratio * (2.0 - ratio))
        ax.plot(ratio, pedestal_compliance(ratio, 1.0, a), "k-", lw=0.7)
    ax.set(xlabel="h/R", ylabel="compliance c_p R", title="contacts of 0.05, 0.2, 0.4, 0.6 of the foot")
    ax.title.set_fontsize(9)
    return figure
