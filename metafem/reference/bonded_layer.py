"""Surface displacement of a bonded elastic layer under a point load, by quadrature of its Hankel integral."""

from __future__ import annotations

from math import cosh, pi, sinh

from scipy.integrate import quad
from scipy.special import j0

# The integrand has died by here: exp(-2 * 30) is below rounding.
LAST_WAVENUMBER = 30.0


def transfer(x: float, poisson_ratio: float) -> float:
    """M(x), the layer's response to a wave of number x/t over that of the half-space.

    Johnson, Contact Mechanics, section 5.8, doi:10.1017/CBO9781139171731.
    """
    kappa = 3.0 - 4.0 * poisson_ratio
    upper = 2.0 * kappa * sinh(2.0 * x) - 4.0 * x
    return upper / (2.0 * kappa * cosh(2.0 * x) + 4.0 * x**2 + 1.0 + kappa**2)


def influence(r: float, thickness: float, poisson_ratio: float) -> float:
    """Displacement at distance r per unit of P/E* [1/mm]; at r = 0, what the layer adds there.

    ``1/(pi r) + 1/pi int_0^inf (M(k t) - 1) J0(k r) dk``.
    """
    integral, _ = quad(
        lambda x: (transfer(x, poisson_ratio) - 1.0) * j0(x * r / thickness),
        0.0,
        LAST_WAVENUMBER,
        epsabs=1e-12,
        epsrel=1e-12,
        limit=1000,
    )
    return (1.0 / r if r > 0.0 else 0.0) / pi + float(integral) / (pi * thickness)
