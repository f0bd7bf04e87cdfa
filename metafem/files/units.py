"""Conversion of quantities with units, such as "120 um", to floats in mm, N, MPa and radians."""

from __future__ import annotations

import datetime
import re
from collections.abc import Mapping
from contextlib import suppress
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any

from metafem._given import Names, printable, shown
from metafem.errors import InvalidInput

# A decimal number, followed by a product of units whose exponents have one digit. No other text reaches pint,
# which would read "1,5 mm" as 15 mm and evaluate "9**9**9".
_NUMBER = r"[+-]?(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:[eE][+-]?\d{1,3})?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(.*?)\s*", re.DOTALL | re.ASCII)
_FACTOR = r"[^\W\d_]+(?:(?:\^|\*\*)?-?\d)?|%|°"
_UNIT = re.compile(rf"(?:{_FACTOR})(?:\s*[*/·]\s*(?:{_FACTOR})| +(?:{_FACTOR}))*")
_EXPONENT = re.compile(r"([^\W\d_])(-?\d)")
_SUPERSCRIPT = str.maketrans("²³", "23")

# Longest product of units [characters]: pint makes one nested call for each factor.
_LONGEST = 100

# The usual units and their size in the package's units. All other units need pint, whose import takes a third
# of a second.
_KNOWN = {
    "um": ("mm", Fraction(1, 1000)),
    "µm": ("mm", Fraction(1, 1000)),
    "μm": ("mm", Fraction(1, 1000)),
    "mm": ("mm", Fraction(1)),
    "mm^2": ("mm^2", Fraction(1)),
    "mN": ("N", Fraction(1, 1000)),
    "N": ("N", Fraction(1)),
    "kPa": ("MPa", Fraction(1, 1000)),
    "MPa": ("MPa", Fraction(1)),
    "GPa": ("MPa", Fraction(1000)),
    "mJ/m^2": ("N/mm", Fraction(1, 1_000_000)),
}

# Usual units of each dimension, by the package's unit. The parser reads all other units of the dimension too.
USUAL = {
    "mm": ("nm", "um", "µm", "μm", "mm", "cm", "m", "inch"),
    "mm^2": ("um^2", "µm^2", "μm^2", "mm^2", "cm^2", "m^2"),
    "N": ("uN", "µN", "μN", "mN", "N", "kN"),
    "N/mm": ("mJ/m^2", "J/m^2", "uN/mm", "mN/m", "N/m", "N/mm"),
    "MPa": ("Pa", "kPa", "MPa", "GPa", "N/mm^2", "bar", "psi"),
    "rad": ("deg", "°", "mrad", "rad"),
}

# Pattern of the numbers that the parser reads and that neither overflow nor underflow in any of the units.
EXPONENT = r"([eE][+-]?[0-9]{1,2})?"
NUMBER = rf"[+-]?([0-9]{{1,40}}\.?[0-9]{{0,40}}|\.[0-9]{{1,40}}){EXPONENT}"

# Pattern of those numbers above 0: they contain a digit from 1 to 9.
ABOVE_ZERO = (
    r"[+]?([0-9]{0,19}[1-9][0-9]{0,20}\.?[0-9]{0,40}|[0-9]{0,40}\.[0-9]{0,19}[1-9][0-9]{0,20})" + EXPONENT
)

# Pattern of the four ways to write a square.
SQUARE = r"(\^2|2|\*\*2|²)"

EXAMPLES = {
    "mm": "120 um",
    "mm^2": "0.144 mm^2",
    "N": "0.2 N",
    "N/mm": "9 mJ/m^2",
    "MPa": "1.36 MPa",
    "rad": "0.1 deg",
    "1": "0.85",
    "%": "5 %",
}


def quantity(key: str, given: Any, unit: str, example: str | None = None) -> float:
    """Return the value of a quantity in a unit, as a float; the result is rounded only once.

    Parameters
    ----------
    key : str
        Name of the quantity in errors, such as ``limits.max_height``.
    given : str
        Number and unit, such as ``"120 um"``. Both Unicode micro signs are read. A square is ``mm^2``,
        ``mm2``, ``mm**2`` or ``mm²``.
    unit : str
        Unit of the result: "mm", "mm^2", "N", "N/mm", "MPa", "rad" or "1". With "%", a text such as
        ``"3 %"`` is required, and the fraction 0.03 is returned.
    example : str, optional
        A valid value, which errors state; default: one for the unit.

    Raises
    ------
    InvalidInput
        If the unit is missing, unknown or of another dimension, or if the value is not a quantity.

    Examples
    --------
    >>> quantity("limits.max_height", "120 µm", "mm")
    0.12
    >>> quantity("target.crossover_load", "0.038 mm2", "mm^2")
    0.038
    >>> quantity("--misfit", "3 %", "%")
    0.03
    """
    try:
        return converted(given, unit, example)
    except InvalidInput as error:
        raise error.at(key) from None


def converted(given: Any, unit: str, example: str | None = None) -> float:
    """Return the value of `given` in `unit`, as `quantity` does; errors do not name a key."""
    valid = f'"{example or EXAMPLES[unit]}"'
    if not isinstance(given, str):
        cause = "needs a unit" if isinstance(given, (int, float)) else f"must be a text in {unit}"
        raise InvalidInput(cause, value=as_written(given), example=valid)
    text = f'"{printable(given, 60)}"'
    match = _QUANTITY.fullmatch(given)
    if match is None:
        raise InvalidInput("does not begin with a number", value=text, example=valid)
    number, name = match.groups()
    if not name and unit == "%":
        both = f'"{number} %" or "{100.0 * float(number):.6g} %"'
        raise InvalidInput(f"needs a unit; write {both}", value=text)
    if not name and unit != "1":
        raise InvalidInput("needs a unit", value=text, example=valid)
    try:
        return float(Fraction(number) * factor(name, unit))
    except InvalidInput as error:
        raise InvalidInput(error.must, value=text, example=valid) from None
    except OverflowError:
        raise InvalidInput("is too large a number", value=text, example=valid) from None


def as_written(value: Any) -> str:
    """Return a value of a TOML file as it is written there, on one line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (datetime.date, datetime.time)):
        return value.isoformat()
    return shown(value)


def decimal(text: str) -> Fraction:
    """Return a decimal number as an exact fraction; raise ValueError for any other text."""
    if not re.fullmatch(_NUMBER, text, re.ASCII):
        raise ValueError(text)
    return Fraction(text)


def option_names(options: Mapping[str, str | None]) -> Names:
    """Return how errors name the options of a command, and the unit in which each option was written."""
    names = {name: f"--{name.replace('_', '-')}" for name in options}
    units = {name: written_unit(text) for name, text in options.items()}
    return Names(names, {name: unit for name, unit in units.items() if unit is not None})


def written_units(table: Mapping[str, Any]) -> dict[str, tuple[str, float]]:
    """Return the written unit of each quantity in a TOML file, and its size in the package's unit."""
    units = {
        f"{section}.{key}": written_unit(value)
        for section, keys in table.items()
        for key, value in (keys.items() if isinstance(keys, dict) else ())
    }
    return {key: unit for key, unit in units.items() if unit is not None}


def written_unit(value: Any) -> tuple[str, float] | None:
    """Return the unit of a quantity or of a list's first quantity, and its size in the package's unit."""
    while isinstance(value, list) and value:
        value = value[0]
    match = _QUANTITY.fullmatch(value) if isinstance(value, str) else None
    name = match[2] if match else ""
    size = _size(name) if name else None
    return None if size is None else (name, size)


def pattern(units: tuple[str, ...], positive: bool = False) -> str:
    """Return the regular expression for a number with a usual unit of the dimensions of `units`.

    Examples
    --------
    >>> import re
    >>> length = re.compile(pattern(("mm",)))
    >>> bool(length.search("120 um")), bool(length.search("120")), bool(length.search("120 mm^2"))
    (True, False, False)
    """
    names = "|".join(name.replace("^2", SQUARE) for unit in units for name in USUAL[unit])
    return rf"^[ \t]*{ABOVE_ZERO if positive else NUMBER}[ \t]*({names})[ \t]*$"


@lru_cache(maxsize=256)
def _size(name: str) -> float | None:
    """Return the size of a unit in the package's unit of its dimension; None for an unknown unit."""
    for unit in EXAMPLES:
        with suppress(InvalidInput, OverflowError):
            return float(factor(name, unit))
    return None


@cache
def factor(name: str, unit: str) -> Fraction:
    """Return the factor from the unit `name` to `unit`; it is exact where it is rational."""
    if name == unit or (not name and unit == "1"):
        return Fraction(1, 100 if unit == "%" else 1)
    comma = "; write decimals with a point" if name.startswith(",") else ""
    unknown = InvalidInput(f'has the unknown unit "{printable(name, 40)}"{comma}')
    plain = name.translate(_SUPERSCRIPT)
    if len(plain) > _LONGEST or not _UNIT.fullmatch(plain):
        raise unknown
    plain = _EXPONENT.sub(r"\1^\2", plain.replace("**", "^"))
    wrong = "but is a number without unit" if unit == "1" else f"which does not measure in {unit}"
    other = InvalidInput(f'has the unit "{printable(name, 40)}", {wrong}')
    if plain in _KNOWN:
        own, size = _KNOWN[plain]
        if own != unit:
            raise other
        return size
    import pint

    registry = _registry()
    try:
        given = registry.parse_units(plain)
    except (pint.errors.PintError, ValueError, AssertionError):
        raise unknown from None
    # pint treats angles and percentages as dimensionless; "1 %" of a ratio is ambiguous
    if name == "%" or unit in ("1", "%"):
        raise other
    wanted = registry.parse_units(unit)
    try:
        return Fraction(registry.Quantity(Fraction(1), given).to(wanted).magnitude)
    except (pint.errors.PintError, OverflowError):
        raise other from None


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(non_int_type=Fraction)
