"""Surface displacement of a bonded elastic layer by quadrature of its Hankel integral."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.special import j0

# Beyond this argument 1 - M is below 1e-19 of the integral.
LAST = 50.0

# Wanted from each piece of the quadrature, on a quantity of order one.
ACCURACY = 1e-13


def multiplier(x: float, poisson_ratio: float) -> float:
    """M(x) of a layer on a rigid base, 1 for a half-space.

    ``(2 k sinh 2x - 4x)/(2 k cosh 2x + 4 x^2 + 1 + k^2)``, k = 3 - 4 nu; Johnson, Contact Mechanics
    (1985), section 5.8, doi:10.1017/CBO9781139171731.
    """
    k = 3.0 - 4.0 * poisson_ratio
    small = math.exp(-2.0 * x)
    above = k * (1.0 - small**2) - 4.0 * x * small
    below = k * (1.0 + small**2) + (4.0 * x**2 + 1.0 + k**2) * small
    return above / below


def regular_influence(r: float, thickness: float, poisson_ratio: float) -> float:
    """What the layer adds to a half-space's 1/(pi r) per unit P/E* [1/mm]: finite at r = 0.

    ``1/(pi t) int_0^inf (M(x) - 1) J0(x r/t) dx``, in pieces no longer than half a wave of J0.
    """
    ratio = r / thickness
    count = max(8, math.ceil(LAST * ratio / math.pi))
    edges = np.linspace(0.0, LAST, count + 1)
    total = math.fsum(
        quad(
            lambda x: (multiplier(x, poisson_ratio) - 1.0) * j0(x * ratio),
            a,
            b,
            epsabs=ACCURACY,
            epsrel=ACCURACY,
        )[0]
        for a, b in pairwise(edges)
    )
    return total / (math.pi * thickness)


def influence(r: float, thickness: float, poisson_ratio: float) -> float:
    """Surface displacement at the distance r > 0 per unit P/E* [1/mm]."""
    return 1.0 / (math.pi * r) + regular_influence(r, thickness, poisson_ratio)
