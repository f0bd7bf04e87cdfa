"""Texts of measured values with their errors, rounded as in publications."""

from __future__ import annotations

import math


def rounded(value: float, sd: float, digits: int = 2) -> str:
    """Return a value as text, with the decimals that show `digits` digits of its standard deviation.

    Examples
    --------
    >>> rounded(1.35987, 0.0193), rounded(0.37, 0.0)
    ('1.360', '0.37')
    """
    if not (sd > 0.0 and math.isfinite(sd)):
        return f"{value:.6g}"
    return f"{value:.{_places(sd, digits)}f}"


def published(value: float, sd: float, unit: str = "") -> str:
    """Return "value ± standard deviation"; the deviation has one digit, or two if its first digit is 1.

    Examples
    --------
    >>> published(1.35987, 0.0393, "MPa"), published(0.8512, 0.0121)
    ('1.36 ± 0.04 MPa', '0.851 ± 0.012')
    """
    digits = 1
    if sd > 0.0 and f"{sd:.1e}"[0] == "1":
        digits = 2
    return f"{rounded(value, sd, digits)} ± {rounded(sd, sd, digits)} {unit}".rstrip()


def interval(ends: tuple[float, float], sd: float, unit: str = "") -> str:
    """Return an interval as text, with the decimals that show two digits of the standard deviation.

    Examples
    --------
    >>> interval((1.3406, 1.3794), 0.0193, "MPa")
    '1.341 to 1.379 MPa'
    """
    low, high = (rounded(end, sd) for end in ends)
    return f"{low} to {high} {unit}".rstrip()


def _places(sd: float, digits: int) -> int:
    """Return the number of decimals that show `digits` digits of a standard deviation."""
    return max(0, digits - 1 - math.floor(math.log10(float(f"{sd:.{digits - 1}e}"))))
