"""Conversion of quantities with units, such as "120 um", to floats in mm, N, MPa and radians."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import Any

from metafem.errors import InvalidInput, printable, refuse_if

# Numbers that neither overflow nor underflow in any unit.
NUMBER = r"[+-]?([0-9]{1,40}\.?[0-9]{0,40}|\.[0-9]{1,40})([eE][+-]?[0-9]{1,2})?"
QUANTITY = re.compile(rf"\s*(?P<number>{NUMBER})\s*(?P<unit>.*?)\s*", re.DOTALL | re.ASCII)

# Other spellings of a micrometre's sign and of a square, and the pattern of all spellings of a square.
PLAIN = (("µ", "u"), ("μ", "u"), ("²", "^2"), ("**", "^"), ("m2", "m^2"), (" /", "/"), ("/ ", "/"))
SQUARE = r"(\^2|2|\*\*2|²)"

# Units that laboratories write, by the package's unit of their dimension, each with its size in that unit.
UNITS: dict[str, dict[str, str | Fraction]] = {
    "mm": {"nm": "1e-6", "um": "1e-3", "mm": "1", "cm": "10", "m": "1e3", "inch": "25.4"},
    "mm^2": {"um^2": "1e-6", "mm^2": "1", "cm^2": "100", "m^2": "1e6"},
    "N": {"uN": "1e-6", "mN": "1e-3", "N": "1", "kN": "1e3"},
    "N/mm": {"mJ/m^2": "1e-6", "J/m^2": "1e-3", "uN/mm": "1e-6", "mN/m": "1e-6", "N/m": "1e-3", "N/mm": "1"},
    "MPa": {"Pa": "1e-6", "kPa": "1e-3", "MPa": "1", "GPa": "1e3", "N/mm^2": "1", "bar": "0.1",
            "psi": Fraction("4.4482216152605") / Fraction("25.4") ** 2},
    "rad": {"deg": Fraction(math.pi) / 180, "°": Fraction(math.pi) / 180, "mrad": "1e-3", "rad": "1"},
    "1": {"": "1"},
    "%": {"%": "0.01"},
    "mm/min": {"mm/min": "1"},
    "1/min": {"1/min": "1"},
    "s": {"s": "1", "ms": "1e-3"},
}  # fmt: skip

EXAMPLES = {
    "mm": "120 um", "mm^2": "0.144 mm^2", "N": "0.2 N", "N/mm": "9 mJ/m^2", "MPa": "1.36 MPa",
    "rad": "0.1 deg", "1": "0.85", "%": "5 %", "mm/min": "20 mm/min", "1/min": "8000 1/min", "s": "0.5 s",
}  # fmt: skip


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
    valid: Any = {"value": as_written(given), "example": f'"{example or EXAMPLES[unit]}"'}
    words = "needs a unit" if isinstance(given, (int, float)) else f"must be a text in {unit}"
    refuse_if(not isinstance(given, str), words, **valid)
    match = QUANTITY.fullmatch(given)
    if match is None:
        raise InvalidInput("does not begin with a number", **valid)
    refuse_if(not match["unit"] and unit != "1", "needs a unit", **valid)
    try:
        return float(Fraction(match["number"]) * factor(match["unit"], unit))
    except InvalidInput as error:
        raise InvalidInput(error.must, **valid) from None


def as_written(value: Any) -> str:
    """Return a value of a TOML file as it is written there, on one line."""
    text = str(value).lower() if isinstance(value, bool) else printable(str(value), 60)
    return f'"{text}"' if isinstance(value, str) else text


def factor(name: str, unit: str) -> Fraction:
    """Return the exact factor from the unit `name` to `unit`."""
    plain, stated = plain_unit(name), f'unit "{printable(name, 40)}"'
    if plain in UNITS[unit]:
        return Fraction(UNITS[unit][plain])
    wrong = "but is a number without unit" if unit == "1" else f"which does not measure in {unit}"
    refuse_if(any(plain in known for known in UNITS.values()), f"has the {stated}, {wrong}")
    comma = "; write decimals with a point" if name.startswith(",") else ""
    raise InvalidInput(f"has the unknown {stated}{comma}; known are {', '.join(UNITS[unit])}")


def plain_unit(name: str) -> str:
    """Return a unit in the spelling of `UNITS`.

    Examples
    --------
    >>> plain_unit("µm²")
    'um^2'
    """
    for written, plain in PLAIN:
        name = name.replace(written, plain)
    return name


def pattern(units: tuple[str, ...]) -> str:
    """Return the regular expression for a number with a usual unit of the dimensions of `units`.

    Examples
    --------
    >>> import re
    >>> length = re.compile(pattern(("mm",)))
    >>> bool(length.search("120 um")), bool(length.search("120")), bool(length.search("120 mm^2"))
    (True, False, False)
    """
    usual = "|".join(name.replace("^2", SQUARE) for unit in units for name in UNITS[unit])
    names = re.sub(r"\bu(?=[mN])", "[uµμ]", usual)
    return rf"^[ \t]*{NUMBER}[ \t]*({names})[ \t]*$"
