"""Numbers in the words of the report: as many digits as mean something, and powers of ten written out."""

from __future__ import annotations

import math
import re

from validation.check import Check

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

# Digits of a result, of a number beside its bound, and of one beside its expected value.
DIGITS, BESIDE_A_BOUND, MOST = 4, 3, 6

POWER = re.compile(r"(\d+(?:\.\d+)?)e([+-]?)0*(\d+)")


def number(value: float, digits: int = DIGITS) -> str:
    """Return a number with some significant digits; integers keep all of theirs."""
    if not math.isfinite(value):
        return "none"
    text = f"{value:,.0f}" if value == round(value) and abs(value) < 1e15 else powers(f"{value:.{digits}g}")
    return text.replace("-", "−")


def powers(text: str) -> str:
    """Return a text in which numbers such as 1e-06 are powers of ten."""

    def written(found: re.Match[str]) -> str:
        power = "10" + (found[2].replace("+", "") + found[3]).translate(SUPERSCRIPTS)
        return power if found[1] == "1" else f"{found[1]} × {power}"

    return POWER.sub(written, text)


def computed(check: Check) -> str:
    """Return the computed number of a check, with fewer digits beside a bound."""
    return number(check.computed, MOST if "±" in check.expected else BESIDE_A_BOUND)


def expected(check: Check) -> str:
    """Return the expected number of a check."""
    return powers(check.expected.removesuffix(" ± 0")).replace(" -", " −")


def rounded(value: float) -> float:
    """Return a number rounded to 1, 2 or 5 times a power of ten, so that it seldom changes between runs."""
    power = 10.0 ** math.floor(math.log10(value))
    return min((power * each for each in (1.0, 2.0, 5.0, 10.0)), key=lambda each: abs(math.log(each / value)))
