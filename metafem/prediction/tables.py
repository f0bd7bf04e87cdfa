"""A friction law as a table: its quantities with their units, for CSV, pandas and xarray."""

from __future__ import annotations

from collections.abc import Mapping

from metafem._validate import FloatArray

# Quantities of a law, in the order of their columns, with unit and meaning.
QUANTITIES = {
    "load": ("N", "normal load P"),
    "area": ("mm2", "real contact area A0"),
    "separation": ("mm", "plane to undeformed base plane"),
    "rescaled_load": ("mm2", "load over composite modulus, P/E*"),
    "rescaled_friction": ("mm2", "friction over shear strength and area ratio, F/(sigma B)"),
    "friction_force": ("N", "friction force F"),
    "friction_coefficient": ("1", "friction force over load, F/P"),
    "approach": ("mm", "tallest summit minus separation"),
    "stiffness": ("N/mm", "normal contact stiffness"),
    "residual": ("1", "relative error of the equations"),
}

# Quantities that are not in the table of a result folder.
UNWRITTEN = ("friction_coefficient", "approach", "stiffness", "residual")

# Suffix of the names of standard deviations.
DEVIATION = "_sd"


def described(name: str) -> tuple[str, str]:
    """Return unit and meaning of a quantity, or of its standard deviation."""
    unit, words = QUANTITIES[name.removesuffix(DEVIATION)]
    return unit, f"{words}, standard deviation" if name.endswith(DEVIATION) else words


def columns(quantities: Mapping[str, FloatArray], without: tuple[str, ...] = ()) -> dict[str, FloatArray]:
    """Return arrays (k,) by name and unit: ``load_N``, ``stiffness_N_per_mm``."""
    found = {}
    for name, values in quantities.items():
        unit = described(name)[0].replace("/", "_per_")
        if name not in without:
            found[name if unit == "1" else f"{name}_{unit}"] = values
    return found
