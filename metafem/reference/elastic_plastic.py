"""Published formulas for elastic-plastic contact of a sphere and a rigid plane, including their jumps.

The indentation w* = w/w_c, load P/P_c and area A/A_c are relative to those of a Hertz contact at first yield.
"""

from __future__ import annotations

from math import exp, pi


def kogut_etsion(w: float, poisson_ratio: float) -> tuple[float, float]:
    """Return the load P/P_c and the area A/A_c [-] at an indentation w/w_c [-].

    Kogut and Etsion, J. Appl. Mech. 69, 657 (2002), doi:10.1115/1.1490373. Beyond 110 w_c the contact is
    fully plastic: ``P = H A``, ``A = 2 pi R w``, with ``P_c = 2/3 K H pi w_c R`` and ``K = 0.454 + 0.41 nu``.
    """
    if w <= 1.0:
        return w**1.5, w
    if w <= 6.0:
        return 1.03 * w**1.425, 0.93 * w**1.136
    if w <= 110.0:
        return 1.40 * w**1.263, 0.94 * w**1.146
    return 3.0 / (0.454 + 0.41 * poisson_ratio) * w, 2.0 * w


def jackson_green(w: float, poisson_ratio: float, strain: float) -> tuple[float, float]:
    """Return the load P/P_c and the area A/A_c [-] at an indentation w/w_c [-]; `strain` is S_y/E* [-].

    Jackson and Green, J. Tribol. 127, 343 (2005), doi:10.1115/1.1866166.
    """
    if w <= 1.9:
        return w**1.5, w
    factor = 1.295 * exp(0.736 * poisson_ratio)  # C
    area = w * (w / 1.9) ** (0.14 * exp(23.0 * strain))
    yielding = 0.5 * pi * factor * strain  # sqrt(w_c/R)
    hardness = 2.84 * (1.0 - exp(-0.82 * (yielding * area**0.5) ** -0.7))  # H/S_y
    elastic = exp(-(w ** (5.0 / 12.0)) / 4.0) * w**1.5
    plastic = 4.0 * hardness / factor * (1.0 - exp(-(w ** (5.0 / 9.0)) / 25.0)) * w
    return elastic + plastic, area
