"""Texts with units, as patterns of a JSON schema."""

from __future__ import annotations

# The usual units by the package's unit. The parser reads every unit of the same dimension.
UNITS = {
    "mm": ("nm", "um", "µm", "μm", "mm", "cm", "m", "inch"),
    "mm^2": ("um^2", "µm^2", "μm^2", "mm^2", "cm^2", "m^2"),
    "N": ("uN", "µN", "μN", "mN", "N", "kN"),
    "N/mm": ("mJ/m^2", "J/m^2", "uN/mm", "mN/m", "N/m", "N/mm"),
    "MPa": ("Pa", "kPa", "MPa", "GPa", "N/mm^2", "bar", "psi"),
    "rad": ("deg", "°", "mrad", "rad"),
}

# Numbers that the parser reads, and that neither overflow nor vanish in any of the units.
EXPONENT = r"([eE][+-]?[0-9]{1,2})?"
NUMBER = rf"[+-]?([0-9]{{1,40}}\.?[0-9]{{0,40}}|\.[0-9]{{1,40}}){EXPONENT}"

# Among these, numbers above 0: somewhere stands a digit from 1 to 9.
ABOVE_ZERO = (
    r"[+]?([0-9]{0,19}[1-9][0-9]{0,20}\.?[0-9]{0,40}|[0-9]{0,40}\.[0-9]{0,19}[1-9][0-9]{0,20})" + EXPONENT
)

# The ways to write a square.
SQUARE = r"(\^2|2|\*\*2|²)"


def pattern(units: tuple[str, ...], positive: bool = False) -> str:
    """Return the pattern of a number with one of the usual units that measure in one of `units`.

    Examples
    --------
    >>> import re
    >>> length = re.compile(pattern(("mm",)))
    >>> bool(length.search("120 um")), bool(length.search("120")), bool(length.search("120 mm^2"))
    (True, False, False)
    """
    names = "|".join(name.replace("^2", SQUARE) for unit in units for name in UNITS[unit])
    return rf"^[ \t]*{ABOVE_ZERO if positive else NUMBER}[ \t]*({names})[ \t]*$"
