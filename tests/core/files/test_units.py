"""The factor of each unit, and numbers with units."""

import math
import re
from fractions import Fraction

import pytest

from metafem.errors import InvalidInput
from metafem.files import converted, quantity
from metafem.files.units import EXAMPLES, factor, pattern

PSI = Fraction("0.45359237") * Fraction("9.80665") / Fraction("0.0254") ** 2 / 10**6  # its definition

# Size of each usual unit in the package's unit.
SIZES = {
    "mm": {"nm": "1e-6", "um": "1e-3", "µm": "1e-3", "μm": "1e-3", "mm": "1", "cm": "10", "m": "1e3",
           "inch": "25.4"},
    "mm^2": {"um^2": "1e-6", "µm^2": "1e-6", "μm^2": "1e-6", "mm^2": "1", "cm^2": "100", "m^2": "1e6"},
    "N": {"uN": "1e-6", "µN": "1e-6", "μN": "1e-6", "mN": "1e-3", "N": "1", "kN": "1000"},
    "N/mm": {"mJ/m^2": "1e-6", "J/m^2": "1e-3", "uN/mm": "1e-6", "mN/m": "1e-6", "N/m": "1e-3", "N/mm": "1"},
    "MPa": {"Pa": "1e-6", "kPa": "1e-3", "MPa": "1", "GPa": "1e3", "N/mm^2": "1", "bar": "0.1", "psi": PSI},
    "rad": {"deg": math.pi / 180, "°": math.pi / 180, "mrad": "1e-3", "rad": "1"},
}  # fmt: skip


@pytest.mark.parametrize("unit", SIZES)
def test_each_unit_has_its_factor_and_no_other_dimension(unit):
    for name, size in SIZES[unit].items():
        assert math.isclose(factor(name, unit), Fraction(size), rel_tol=1e-15)
        for other in EXAMPLES.keys() - {unit}:
            with pytest.raises(InvalidInput, match=f'has the unit "{re.escape(name)}", '):
                factor(name, other)
    for unknown in ("Mm", "mM", "n", "um^3", "", "parsec", "m N", "m m", "k Pa", "in ch"):
        with pytest.raises(InvalidInput):
            factor(unknown, unit)


def test_each_unit_is_read_in_all_spellings_and_matched_by_its_pattern_alone():
    for unit, name, size in ((unit, *pair) for unit, sizes in SIZES.items() for pair in sizes.items()):
        for square in ("^2", "2", "**2", "²"):
            text = f"1.5 {name.replace('^2', square)}"
            assert math.isclose(converted(text, unit), 1.5 * float(Fraction(size)), rel_tol=1e-15)
            assert [other for other in SIZES if re.search(pattern((other,)), text)] == [unit]
        assert re.search(pattern((unit,)), EXAMPLES[unit])


def test_a_quantity_is_rounded_once():
    for text, unit, value in (
        ("526um", "mm", 0.526), (" 0.526 mm ", "mm", 0.526), ("5.26e-4 m", "mm", 0.526),
        ("120.1 um", "mm", 0.1201), ("-.5 mm", "mm", -0.5), ("+1. mm", "mm", 1.0),
        ("85 %", "%", 0.85), ("3%", "%", 0.03), ("0.85", "1", 0.85), ("180 deg", "rad", math.pi),
    ):  # fmt: skip
        assert quantity("key", text, unit) == value
