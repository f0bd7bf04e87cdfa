"""Numbers as text in a specification, in the units of the text and with only the digits that are visible."""

from __future__ import annotations

import math
import re

from metafem.errors import InvalidInput
from metafem.files import quantity

# A number, the space after it, and its unit.
QUANTITY = re.compile(r"\s*[+-]?[\d.]+(?:[eE][+-]?\d+)?(\s*)(.*?)\s*", re.DOTALL)

# Number of significant digits that double precision always preserves.
ALL_DIGITS = 15

# Relative resolution of values that are copied from a table.
EXACT = 10.0 ** (1 - ALL_DIGITS)

# Smallest distance of a value from its neighbours, in units of the resolution. Rounding moves a value by at
# most half a unit.
APART = 2.0


def digits_of(resolution: float) -> int:
    """Return the number of significant digits for a relative resolution.

    Examples
    --------
    >>> digits_of(1e-3), digits_of(0.02)
    (4, 3)
    """
    return min(ALL_DIGITS, math.ceil(-math.log10(resolution)) + 1)


def rounded(value: float, resolution: float) -> float:
    """Return a number rounded to the significant digits of a relative resolution."""
    number = float(f"{value:.{digits_of(resolution) - 1}e}")
    if not math.isfinite(number):
        raise InvalidInput(f"{value:g} is not a finite number")
    return number


def stated(rescaled: float, like: str, stress: float | None, resolution: float) -> str:
    """Return a rescaled load or friction [mm^2] as a quantity in the unit of the quantity `like`.

    For a unit of force, `stress` is the force per rescaled value [MPa]: E* for loads, sigma B for friction.

    Examples
    --------
    >>> stated(0.25, "140 mN", 1.36, 1e-3), stated(0.25, "0.14mm^2", None, 1e-3)
    ('340 mN', '0.25mm^2')
    """
    match = QUANTITY.fullmatch(like)
    space, unit = match.groups() if match else (" ", "mm^2")
    try:
        value = rescaled / quantity("value", f"1 {unit}", "mm^2")
    except InvalidInput:
        if stress is None:
            raise
        value = rescaled * stress / quantity("value", f"1 {unit}", "N")
    return f"{rounded(value, resolution):.{ALL_DIGITS}g}{space}{unit}"


def between(value: float, low: float, high: float, resolution: float) -> tuple[float, float]:
    """Return the value between two bounds that is nearest to `value`, and the resolution for writing it.

    Examples
    --------
    >>> between(0.5, 0.1, 0.4, 1e-3)
    (0.3992, 0.001)
    >>> between(0.5, 0.1, 0.1002, 1e-3)[0]
    0.1001
    """
    least = low * (1.0 + APART * resolution) if low > 0.0 else resolution * high
    most = high * (1.0 - APART * resolution)
    if math.isinf(high):
        least, most = (low * (1.0 + APART * resolution) if low > 0.0 else 0.0), high
    if least <= most:
        return min(max(value, least), most), resolution
    fine = 0.1 * (high - low) / high
    return 0.5 * (low + high), max(min(fine, resolution), EXACT)
