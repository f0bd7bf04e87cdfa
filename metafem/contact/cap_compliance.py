"""The sinking of a cap into the half-space that it stands on."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from metafem._validate import FloatArray
from metafem.errors import InvalidInput

# c_p R by finite elements (metafem.fe.measure_pedestal), nu = 0.5, error 3e-5: h/R, then at contact radii of
# these shares of the cap's foot.
SHARES = (0.05, 0.2, 0.4, 0.6)
TABLE = (
    (0.05, 0.02602, 0.03854, 0.05461, 0.06999),
    (0.075, 0.03893, 0.05403, 0.07321, 0.09134),
    (0.1, 0.05225, 0.06942, 0.09103, 0.11123),
    (0.15, 0.08007, 0.10052, 0.12576, 0.14890),
    (0.2, 0.10949, 0.13246, 0.16031, 0.18535),
    (0.25, 0.14046, 0.16546, 0.19524, 0.22150),
    (0.3, 0.17301, 0.19967, 0.23089, 0.25786),
    (0.35, 0.20714, 0.23518, 0.26747, 0.29476),
    (0.4, 0.24290, 0.27209, 0.30514, 0.33247),
    (0.45, 0.28035, 0.31050, 0.34408, 0.37120),
    (0.5, 0.31955, 0.35050, 0.38441, 0.41113),
    (0.55, 0.36060, 0.39221, 0.42629, 0.45247),
    (0.6, 0.40362, 0.43576, 0.46988, 0.49539),
)

# Fitted to the table: c_p R = sum of coefficient theta^i x^j, with the slope theta of the sphere at the
# foot and x = a/R; largest error 3e-4 of the value.
POWERS = ((2, 0), (3, 0), (4, 0), (5, 0), (0, 1), (1, 1), (2, 1), (0, 2), (1, 2), (0, 3))
COEFFICIENTS = (
    0.185815,
    0.097759,
    -0.01401,
    0.007099,
    0.27508,
    0.000324,
    -0.003441,
    -0.072683,
    -0.085914,
    0.041567,
)
FIT_ERROR = 3e-4


def pedestal_compliance(height: ArrayLike, radius: ArrayLike, contact_radius: ArrayLike = 0.0) -> FloatArray:
    """Compliance c_p [1/mm] that a spherical cap adds by standing on its block.

    ``d = d_Hertz(P) + c_p P/(pi E*)`` on a half-space: c_p/pi belongs on the diagonal of the influence
    between asperities, beside the block's regular self term. Small strain, incompressible (at nu = 0.49 it
    is 7 % less at a/R = 0.1). It grows with the contact, by 0.25 a/R^2 about.

    Parameters
    ----------
    height, radius : array_like
        Of the cap [mm], 0.05 <= h/R <= 0.6.
    contact_radius : array_like
        a [mm], up to 0.6 of the cap's foot; 0 for the limit of light loads.

    Raises
    ------
    InvalidInput
        If h/R or a is outside the range of the table.

    Examples
    --------
    >>> pedestal_compliance(0.2, 0.526, contact_radius=0.05).round(2)
    np.float64(0.46)
    """
    size = np.asarray(radius, dtype=np.float64)
    ratio = np.asarray(height, dtype=np.float64) / size
    low, high = TABLE[0][0], TABLE[-1][0]
    if not ((ratio >= low) & (ratio <= high)).all():
        raise InvalidInput(f"height/radius must lie from {low:g} to {high:g}, the range of the table")
    x = np.asarray(contact_radius, dtype=np.float64) / size
    if not ((x >= 0.0) & (x <= SHARES[-1] * np.sqrt(ratio * (2.0 - ratio)))).all():
        raise InvalidInput(f"contact_radius must lie from 0 to {SHARES[-1]:g} of the cap's foot")
    angle = np.arccos(1.0 - ratio)
    terms = [c * angle**i * x**j for c, (i, j) in zip(COEFFICIENTS, POWERS, strict=True)]
    return np.asarray(np.sum(terms, axis=0) / size)
