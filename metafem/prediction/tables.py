"""Quantities of a friction law with their units, for tables in CSV, pandas and xarray."""

from __future__ import annotations

from collections.abc import Mapping

from metafem._validate import FloatArray

# Unit and meaning of each quantity of a law, in the order of the columns.
QUANTITIES = {
    "load": ("N", "normal load P"),
    "area": ("mm2", "real contact area A0"),
    "separation": ("mm", "plane to undeformed base plane"),
    "rescaled_load": ("mm2", "load over composite modulus, P/E*"),
    "rescaled_friction": ("mm2", "friction over shear strength and area ratio, F/(sigma B)"),
    "friction_force": ("N", "friction force F"),
    "friction_coefficient": ("1", "friction force over load, F/P"),
    "nominal_pressure": ("MPa", "load per area of the periodic cell, P/A"),
    "nominal_shear_stress": ("MPa", "friction force per area of the periodic cell, F/A"),
    "approach": ("mm", "tallest summit minus separation"),
    "stiffness": ("N/mm", "normal contact stiffness"),
    "residual": ("1", "relative error of the equations"),
}

# Quantities that are omitted from the table in a result folder.
UNWRITTEN = ("friction_coefficient", "approach", "stiffness", "residual")

# Suffix that marks the name of a standard deviation.
DEVIATION = "_sd"


def described(name: str) -> tuple[str, str]:
    """Return unit and meaning of a quantity, or of its standard deviation."""
    unit, words = QUANTITIES[name.removesuffix(DEVIATION)]
    return unit, f"{words}, standard deviation" if name.endswith(DEVIATION) else words


def columns(quantities: Mapping[str, FloatArray], without: tuple[str, ...] = ()) -> dict[str, FloatArray]:
    """Return arrays (k,) by column name, which includes the unit: ``load_N``, ``stiffness_N_per_mm``."""
    found = {}
    for name, values in quantities.items():
        unit = described(name)[0].replace("/", "_per_")
        if name not in without:
            found[name if unit == "1" else f"{name}_{unit}"] = values
    return found
