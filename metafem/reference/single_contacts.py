"""Closed-form solutions for one frictionless contact on a half-space of composite modulus 1."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray


def hertz(contact_radius: float, radius: float) -> tuple[float, float]:
    """Return the load P/E* = ``4 a^3/(3 R)`` [mm^2] and the indentation ``a^2/R`` [mm] of a paraboloid.

    Hertz (1882), doi:10.1515/crll.1882.92.156.
    """
    return 4.0 / 3.0 * contact_radius**3 / radius, contact_radius**2 / radius


def hertz_pressure(r: FloatArray, contact_radius: float, radius: float) -> FloatArray:
    """Return the pressure over E*, ``2 a/(pi R) sqrt(1 - r^2/a^2)`` [-], and 0 outside the contact, (k,)."""
    square = np.maximum(1.0 - (r / contact_radius) ** 2, 0.0)
    return np.asarray(2.0 * contact_radius / (math.pi * radius) * np.sqrt(square))


def hertz_displacement(r: FloatArray, contact_radius: float, radius: float) -> FloatArray:
    """Return the surface displacement at distances r >= a, (k,) [mm].

    ``p0/(2 E* a) [(2 a^2 - r^2) asin(a/r) + a sqrt(r^2 - a^2)]``, Johnson, Contact Mechanics (1985),
    eq. 3.42a, doi:10.1017/CBO9781139171731.
    """
    a, peak = contact_radius, 2.0 * contact_radius / (math.pi * radius)
    return np.asarray(
        0.5 * peak / a * ((2.0 * a**2 - r**2) * np.arcsin(a / r) + a * np.sqrt((r - a) * (r + a)))
    )


def sneddon_sphere(contact_radius: float, radius: float) -> tuple[float, float]:
    """Return the load P/E* [mm^2] and the indentation [mm] of a spherical punch, for a < R.

    ``(a^2 + R^2)/2 ln((R + a)/(R - a)) - a R`` and ``a/2 ln((R + a)/(R - a))``,
    Sneddon, Int. J. Eng. Sci. 3, 47 (1965), doi:10.1016/0020-7225(65)90019-4.
    """
    a, half = contact_radius, math.atanh(contact_radius / radius)
    return (a**2 + radius**2) * half - a * radius, a * half


def jkr_contact_radius(load: float, radius: float, adhesion_energy: float) -> float:
    """Return the contact radius [mm] of an adhesive paraboloid.

    `load` is P/E* [mm^2], and `adhesion_energy` is w/E* [mm].
    ``a^3 = 3 R/4 [P/E* + 3 pi R w/E* + sqrt(6 pi R w/E* P/E* + (3 pi R w/E*)^2)]``, Johnson, Kendall and
    Roberts, Proc. R. Soc. A 324, 301 (1971), doi:10.1098/rspa.1971.0141.
    """
    pull = 3.0 * math.pi * radius * adhesion_energy
    force = load + pull + math.sqrt(2.0 * pull * load + pull**2)
    return math.cbrt(0.75 * radius * force)


def power_law(contact_radius: float, coefficient: float, exponent: float) -> tuple[float, float]:
    """Return the load P/E* [mm^2] and the indentation [mm] of a punch with the profile ``c r^n``.

    c is the `coefficient` and n the `exponent`. ``d = c a^n sqrt(pi) Gamma(n/2 + 1)/Gamma(n/2 + 1/2)``,
    ``P/E* = 2 a d n/(n + 1)``, Sneddon (1965), cited in `sneddon_sphere`.
    """
    n = exponent
    rise = math.sqrt(math.pi) * math.gamma(0.5 * n + 1.0) / math.gamma(0.5 * n + 0.5)
    indentation = coefficient * contact_radius**n * rise
    return 2.0 * contact_radius * indentation * n / (n + 1.0), indentation


def conductance(stiffness: float, composite_modulus: float, resistivity: float) -> float:
    """Return the conductance of contacts on a half-space, ``G = 2 k/(E* rho)``, from their stiffness k.

    `stiffness` is in N/mm and `composite_modulus` in MPa. `resistivity` is the sum of those of both bodies
    [ohm mm] or [mm K/W]; G is then in S or W/K. The identity holds for all elastic contacts without adhesion:
    Barber, Proc. R. Soc. A 459, 53 (2003), doi:10.1098/rspa.2002.1038.

    >>> conductance(stiffness=4.0, composite_modulus=2.0, resistivity=1.0)
    4.0
    """
    return 2.0 * stiffness / (composite_modulus * resistivity)
