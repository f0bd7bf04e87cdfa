"""Values of a specification as the form shows them, as the user types them, and as a drag writes them."""

from __future__ import annotations

import json
import math
import re
from typing import Any

from metafem.errors import InvalidInput
from metafem.files import Form

# A number, the space after it, and its unit.
QUANTITY = re.compile(r"\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)(\s*)(.*?)\s*", re.DOTALL)

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


def scaled(text: str, ratio: float, resolution: float) -> str:
    """Return a quantity so many times as large, with the digits of a resolution, in its unit.

    Examples
    --------
    >>> scaled("0.14mm^2", 25 / 14, 1e-3)
    '0.25mm^2'
    """
    found = QUANTITY.fullmatch(text)
    if found is None:
        raise InvalidInput(f"{text} is not a quantity")
    number, space, unit = found.groups()
    return f"{rounded(float(number) * ratio, resolution):.{ALL_DIGITS}g}{space}{unit}"


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


# A number with a decimal comma. A comma before three digits can also separate thousands, except after a zero.
DECIMAL_COMMA = re.compile(r"(?<![\w.^,])([+-]?(?:0+,\d+|\d+,(?!\d{3}(?!\d))\d+))(?!\d|,(?! ))")

# Separators of the entries of a list. Lists of integers (rows and columns) also accept spaces, a cross, or
# an x that is not part of a word.
SEPARATORS = re.compile(r"[,;\n]")
CROSS = re.compile(r"[,;\s×]|(?<![^\W\d])[xX](?![^\W\d])")

# An entry of a list: a group of entries in brackets, such as a pair, or a single entry.
GROUP_OR_ENTRY = re.compile(r"\[([^\[\]]*)\]|([^,;\n\[\]]+)")


def shown(value: Any) -> str:
    """Return a value of a specification as a field shows it: strings without quotes, lists without brackets.

    Examples
    --------
    >>> shown(["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]]), shown(True), shown(0.5)
    ('0.07 mm^2, [0.15 mm^2, 0.18 mm^2]', 'true', '0.5')
    """
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, (list, tuple)):
        return ", ".join(f"[{shown(part)}]" if isinstance(part, list) else shown(part) for part in value)
    if isinstance(value, float):
        return f"{value:.15g}"
    return json.dumps(value, default=str)


def unit_of(value: Any) -> str:
    """Return the unit of a quantity, or of all quantities of a list; "" if there is no such unit.

    Examples
    --------
    >>> unit_of("450mN"), unit_of(["1 N", ["2 N", "3 N"]]), unit_of(["1 N", "2 mN"]), unit_of(0.5)
    ('mN', 'N', '', '')
    """
    parts = [part for part in re.split(r"[,\[\]]", shown(value)) if part.strip()]
    units = {found[3] if (found := QUANTITY.fullmatch(part)) else "" for part in parts}
    return units.pop() if len(units) == 1 else ""


def typed_value(form: Form, typed: str, unit: str = "") -> Any:
    """Return typed text as a TOML value; text that does not match the type of the key stays a string.

    A quantity without a unit has the unit `unit`.

    Examples
    --------
    >>> from metafem.files import all_keys
    >>> forms = {key["name"]: key for key in all_keys() if key["section"] == "lattice"}
    >>> typed_value(forms["shape"], "8 x 12"), typed_value(forms["pitch"], "1,5", "mm")
    ([8, 12], '1.5 mm')
    """
    kind, listed = form["value"], form["listed"]
    if kind == "quantity" or (kind != "text" and (not listed or ";" in typed)):
        typed = with_points(typed)
    if not listed:
        return _entry(kind, typed, unit)
    if not form["pairs"]:
        return _entries(kind, typed.strip("[] "), unit)
    return [
        _entry(kind, entry, unit) if entry else _entries(kind, group, unit)
        for group, entry in GROUP_OR_ENTRY.findall(typed)
        if not entry or entry.strip()
    ]


def with_points(typed: str) -> str:
    """Return typed numbers with decimal points instead of decimal commas."""
    return DECIMAL_COMMA.sub(lambda number: number[1].replace(",", "."), typed)


def with_unit(typed: str, unit: str) -> str:
    """Return a typed quantity with a decimal point; a number without a unit has the unit `unit`."""
    typed = with_points(typed.strip())
    number = _number(typed)
    return typed if isinstance(number, str) or not unit else f"{shown(number)} {unit}"


def _entries(kind: str, typed: str, unit: str) -> list[Any]:
    parts = (CROSS if kind == "integer" else SEPARATORS).split(typed)
    return [_entry(kind, part, unit) for part in parts if part.strip()]


def _entry(kind: str, typed: str, unit: str) -> Any:
    typed = typed.strip().strip("\"'")
    if kind == "quantity":
        return with_unit(typed, unit)
    return typed if kind == "text" else {"true": True, "false": False}.get(typed, _number(typed))


def _number(typed: str) -> int | float | str:
    """Return typed text as a number if it is one."""
    for kind in (int, float):
        try:
            return kind(typed)
        except ValueError:
            pass
    return typed
