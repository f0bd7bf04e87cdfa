"""Numbers in the words of the report: as many digits as mean something, and powers of ten written out."""

from __future__ import annotations

import math
import re
from html import escape

from validation.check import Check

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

# Digits of a result, of a number beside its bound, and of one beside its expected value.
DIGITS, BESIDE_A_BOUND, MOST = 4, 3, 6

# Powers of ten that are written without an exponent.
PLAIN = range(-4, 6)

POWER = re.compile(r"(\d+(?:\.\d+)?)e([+-]?)0*(\d+)")
# Where a long name may break: behind dots, underscores and slashes.
IN_NAMES = re.compile(r"(?<=[A-Za-z])[._](?=\w)|/(?=[a-z]{3})")

NEAR = re.compile(r"(-?[\d.e+-]+) ± ([\d.e+-]+)( relative)?$")


def number(value: float, digits: int = DIGITS) -> str:
    """Return a number with some significant digits; integers keep all of theirs."""
    if not math.isfinite(value):
        return "none"
    if value == 0.0:
        return "0"
    power = math.floor(math.log10(abs(value)))
    if value == round(value) and power < 15:
        text = f"{round(value):,}"
    elif power in PLAIN:
        text = f"{float(f'{value:.{digits}g}'):,.{max(0, digits - 1 - power)}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
    else:
        text = powers(f"{value:.1e}")
    return text.replace("-", "−")


def powers(text: str) -> str:
    """Return a text in which numbers such as 1e-06 are powers of ten."""

    def written(found: re.Match[str]) -> str:
        power = "10" + (found[2].replace("+", "") + found[3]).translate(SUPERSCRIPTS)
        return power if found[1] == "1" else f"{found[1]} × {power}"

    return POWER.sub(written, text)


def cited(source: str) -> str:
    """Return a source as HTML, in which long names may break."""
    return IN_NAMES.sub(r"\g<0><wbr>", escape(powers(source)))


def computed(check: Check) -> str:
    """Return the computed number of a check, to the digits that its expected number states."""
    found = NEAR.match(check.expected)
    return number(check.computed, _digits(check.computed, found) if found else BESIDE_A_BOUND)


def expected(check: Check) -> str:
    """Return the expected number of a check; one with a relative tolerance to the digits that it allows."""
    found = NEAR.match(check.expected)
    if found and found[3]:
        value = float(found[1])
        return f"{number(value, _digits(value, found))} ± {powers(found[2])}{found[3]}"
    return powers(check.expected.removesuffix(" ± 0")).replace(" -", " −")


def _digits(value: float, near: re.Match[str]) -> int:
    """Return the significant digits of a number that an expected one with a tolerance allows."""
    tolerance = _tolerance(near)
    if tolerance == 0.0 or not math.isfinite(value) or value == 0.0:
        return MOST
    places = 1 - math.floor(math.log10(tolerance))
    return min(max(places + 1 + math.floor(math.log10(abs(value))), 2), MOST)


def _tolerance(near: re.Match[str]) -> float:
    """Return the absolute tolerance of an expected number."""
    return float(near[2]) * (abs(float(near[1])) if near[3] else 1.0)
