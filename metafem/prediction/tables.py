"""A friction law as a table: its quantities with their units, for CSV, pandas and xarray."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem._validate import FloatArray
from metafem.notes import to_lines

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset

    from metafem.prediction.law import FrictionLaw

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

# Quantities of laws whose surface has a Friction.
FORCES = ("friction_force", "friction_coefficient")

# Quantities that are not in the table of a result folder.
UNWRITTEN = ("friction_coefficient", "approach", "stiffness", "residual")


def quantities(law: FrictionLaw) -> dict[str, FloatArray]:
    """Return the arrays (k,) of a law by name."""
    names = [name for name in QUANTITIES if law.friction is not None or name not in FORCES]
    return {name: getattr(law, name) for name in names}


def columns(law: FrictionLaw, without: tuple[str, ...] = ()) -> dict[str, FloatArray]:
    """Return the arrays (k,) of a law by name and unit: ``load_N``, ``stiffness_N_per_mm``."""
    found = {}
    for name, values in quantities(law).items():
        unit = QUANTITIES[name][0].replace("/", "_per_")
        if name not in without:
            found[name if unit == "1" else f"{name}_{unit}"] = values
    return found


def dataframe(law: FrictionLaw) -> DataFrame:
    """Return the law as a table with a row for each load."""
    from pandas import DataFrame

    table = DataFrame({name: values.copy() for name, values in columns(law).items()})
    table.attrs.update(_about(law))
    return table


def dataset(law: FrictionLaw) -> Dataset:
    """Return the law over the dimension ``rescaled_load``."""
    from xarray import Dataset

    variables = {}
    for name, values in quantities(law).items():
        unit, words = QUANTITIES[name]
        variables[name] = ("rescaled_load", values.copy(), {"units": unit, "long_name": words})
    coordinate = {"rescaled_load": variables.pop("rescaled_load")}
    return Dataset(variables, coordinate, _about(law))


def _about(law: FrictionLaw) -> dict[str, str]:
    return {"model": repr(law.model), "status": law.status.value, "notes": to_lines(law.notes)}
