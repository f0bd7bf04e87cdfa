"""The soft cap at large strain, with slip and with stick, compared with Hertz's law and small strain."""

from __future__ import annotations

from functools import cache

import numpy as np

from metafem import fe
from metafem.drawing import new_figure
from metafem.fe.axisymmetric.geometry import Cap
from metafem.fe.large_strain.press import FiniteContact, press_sequence
from metafem.reference import single_contacts as exact
from validation.check import Check, Claim, below, near
from validation.published import SEPARATE

# Ten contacts on two meshes take a minute.
SLOW = True

R = 0.526
CAP = Cap(R, 0.2, 10.0, 7.2)

# Load over that of Hertz at the same deformed radius, with slip, by a/R, from the separate program.
ROWS = {0.095: 0.989, 0.19: 0.981, 0.35: 0.974, 0.43: 0.974, 0.51: 0.978}

# Half of their last digit, and the effect of the height of their cap, which is not known: a height 5 % larger
# lowers the last row by 0.0009 and the others by at most 0.0002.
TOLERANCE = 1e-3

# At small strain an incompressible surface does not move tangentially, so stick and slip agree. They differ
# at second order in a/R, with a coefficient of about 0.03.
SECOND_ORDER = 0.04

OTHER = f"neo-Hookean cap by {SEPARATE}"
SLIP = "the row with slip; stick and slip differ at second order in a/R"

TEXT = """Small strain must not be used to improve Hertz's law of a soft sphere at large a/R. At a/R = 0.5 the
load of the true cap over that of Hertz at the same contact radius is 1.11 by small strain, but only 0.98 by
large strain (incompressible neo-Hookean, without friction; 0.97 with stick). The corrections have opposite
signs, and Hertz's law lies between them, closer to large strain. From a/R = 0.1 to 0.5 the load of the soft
cap is 0.974 to 0.989 of that of Hertz. This nearly constant factor is included in a fitted E*, so Hertz's law
with a fitted E* is the better law. The numbers hold for a cap of height 0.38 R on a wide bonded block. A
height of 0.51 R lowers the load at a/R = 0.5 by 0.005, a hemisphere by 0.018, and half the thickness of the
block by less than 0.001."""


def claim() -> Claim:
    """Compare loads with the separate program, and stick with slip."""
    slip, stick = _contacts(False), _contacts(True)
    checks: list[Check] = []
    for ratio, contact, expected in zip(ROWS, slip, ROWS.values(), strict=True):
        name = f"slip, a/R = {ratio}: load over Hertz"
        checks.append(near(name, _over_hertz(contact), expected, TOLERANCE, OTHER))
    for ratio, contact, other in zip(ROWS, stick, slip, strict=True):
        name = f"stick, a/R = {ratio}: load over Hertz"
        checks.append(near(name, _over_hertz(contact), _over_hertz(other), SECOND_ORDER * ratio**2, SLIP))
    worst = max(contact.error_estimate for contact in (*slip, *stick))
    checks.append(
        below(
            "error estimate, worst",
            worst,
            2e-3,
            "difference between two meshes, this check; required: 0.2 %",
        )
    )
    small = _small(0.5 * R)
    checks.append(near("small strain, a/R = 0.5: load over Hertz", small, 1.11, 1e-2, OTHER))
    return Claim("Finite elements: the soft cap at large strain", checks, {"load": _load}, TEXT)


@cache
def _contacts(stick: bool) -> list[FiniteContact]:
    return press_sequence(R * np.array(list(ROWS)), CAP, stick)


def _over_hertz(contact: FiniteContact) -> float:
    return contact.rescaled_load / exact.hertz(contact.contact_radius, R)[0]


def _small(a: float) -> float:
    contact = fe.press(a, R, height=CAP.height, thickness=CAP.thickness, block_radius=CAP.outer)
    return contact.rescaled_load / exact.hertz(a, R)[0]


def _load():
    figure = new_figure(5.6, 3.4)
    ax = figure.add_subplot()
    ratio = np.array(list(ROWS))
    for stick, style in ((False, "o-"), (True, "s-")):
        name = "stick" if stick else "slip"
        ax.plot(ratio, [_over_hertz(c) for c in _contacts(stick)], style, ms=4, label=f"large strain, {name}")
    ax.plot(ratio, [_small(x * R) for x in ratio], "^-", ms=4, label="small strain, slip")
    ax.plot(ratio, list(ROWS.values()), "kx", ms=5, label="separate program")
    ax.axhline(1.0, color="k", lw=0.7, ls="--")
    ax.set(xlabel="a/R, deformed", ylabel="load over that of Hertz at the same a")
    ax.legend(frameon=False, fontsize=8)
    return figure
