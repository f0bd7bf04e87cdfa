"""Reading of friction laws, contact laws and profiles of caps from tables, and of the sites of a design."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput, refuse_if
from metafem.files.tables import Columns, Table, is_of_contacts, read_table
from metafem.inversion import SampledLaw
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from metafem.calibration import MeasuredLaw

LAW = Columns(
    "load_mN,friction_force_mN,area_mm2,load_sd_mN,friction_force_sd_mN,area_sd_mm2",
    ("load,friction_force", "load,area"),
    "measured point",
    "load_mN,friction_force_mN or load_mN,area_mm2 (or in other units), optionally with load_sd_mN, "
    "friction_force_sd_mN and area_sd_mm2",
)
TARGET = Columns(
    "load_N,friction_force_N,area_mm2,rescaled_load_mm2,rescaled_friction_mm2,weight,relative_error,load_sd_N,"
    "friction_force_sd_N,area_sd_mm2,rescaled_load_sd_mm2,rescaled_friction_sd_mm2",
    ("load,friction_force", "load,area", "rescaled_load,rescaled_friction"),
    "sample",
    "load_N,friction_force_N, or load_N,area_mm2, or rescaled_load_mm2,rescaled_friction_mm2 (or in other "
    "units), and optionally their errors such as friction_force_sd_mN, or weight",
)
PROFILE = Columns("rho_mm,f_um", ("rho,f",), "sample")
CONTACT = Columns("indentation_um,load_mN,area_mm2", ("indentation,load,area",), "sample")
SITES = Columns("site,x_mm,y_mm", ("x,y",), "site")

# Columns of the table that a section of a specification names, by the kind of the section.
COLUMNS = {"sampled": TARGET, "profile": PROFILE, "tabulated": CONTACT}

# Keys of a sampled target; if a table has several of them, the first one is read.
LOADS, FRICTIONS = ("rescaled_load", "load"), ("rescaled_friction", "friction_force", "area")

# The columns of a table, in the package's units, by the key of the specification.
Keys = dict[str, FloatArray]


def read_measured_law(
    source: str | Path | Table,
    material: Material,
    friction: Friction | None = None,
    *,
    sites: IntArray | None = None,
) -> MeasuredLaw:
    """Return the measured friction law in a table.

    Parameters
    ----------
    source : str, Path or Table
        Text file, or a table that `read_table` returned. One line names the columns as ``load_mN`` or
        ``Load [mN]``, in any order and unit. ``load`` is required, and ``friction_force`` or ``area``. The
        standard deviations ``load_sd``, ``friction_force_sd`` and ``area_sd`` are optional; default: those
        of the source paper. A table of
        ``metafem images`` is also accepted.
    material : Material
    friction : Friction, optional
        Needed if the table has friction forces but no areas.
    sites : ndarray of int, (n,), optional
        Site of each asperity of the design, ``Design.sites``, for a table of contacts. Default: the sites in
        the table are the numbers of the asperities.

    Returns
    -------
    MeasuredLaw

    Raises
    ------
    InvalidInput
        If a column is missing, or its unit is missing or of another dimension, if an entry is not a number,
        or if the points are not a friction law. The error states line and column.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "measured.csv")
    ...     _ = path.write_text("load_mN,area_mm2\\n50,0.21\\n100,0.43\\n")
    ...     read_measured_law(path, Material(1.36)).load
    array([0.05, 0.1 ])
    """
    from metafem.calibration import MeasuredLaw, measured_law
    from metafem.files.images import read_contacts

    table = read_table(source)
    if is_of_contacts(table):
        try:
            return measured_law(read_contacts(table), material, friction, sites)
        except InvalidInput as error:
            raise InvalidInput(f"{table.name}: {error}") from None
    entries = LAW.read(table)
    values: dict[str, Any] = {name: entries.numbers(name) for name in entries.columns}
    refuse_if(
        friction is None and "area" not in values,
        f"{table.name} holds friction forces, which can only be rescaled with a shear strength and an area "
        "ratio; state them in the section [friction] or by --shear-strength and --area-ratio, or add a "
        "column area_mm2",
    )
    with entries.located():
        return MeasuredLaw(**values, material=material, friction=friction)


def read_law(
    path: str | Path | Table, material: Material | None = None, friction: Friction | None = None
) -> SampledLaw:
    """Return the target law in a table of loads and friction.

    Parameters
    ----------
    path : str, Path or Table
        Text file with the columns ``rescaled_load,rescaled_friction``, ``load,area`` or
        ``load,friction_force``, each with its unit as in ``load_mN`` or ``Load [mN]``, and optionally
        ``weight``, ``relative_error`` or standard deviations such as ``friction_force_sd_mN``.
    material : Material, optional
        Needed for loads in N.
    friction : Friction, optional
        Needed for friction forces.

    Returns
    -------
    SampledLaw

    Raises
    ------
    InvalidInput
        If the table cannot be read, or if the material or the friction that it needs is not given.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "wanted.csv")
    ...     _ = path.write_text("load_mN,area_mm2\\n136,0.8\\n272,1.5\\n")
    ...     read_law(path, Material(1.36)).rescaled_load
    array([0.1, 0.2])
    """
    table = read_table(path)
    keys: dict[str, Any] = samples_of(table)
    more = {name: keys.pop(name) for name in TARGET.plain & keys.keys()}
    if "load" not in keys:
        return SampledLaw(**keys, **more)
    if material is None:
        words = f"{table.name} holds loads in N, which are rescaled by E*; give a material"
        raise InvalidInput(words, key="material")
    if "rescaled_friction" in keys:
        load = keys["load"] / material.composite_modulus
        return SampledLaw(load, keys["rescaled_friction"], **more)
    if friction is None:
        words = f"{table.name} holds friction forces, which are rescaled by sigma B; give a friction"
        raise InvalidInput(words, key="friction")
    return SampledLaw.from_forces(keys["load"], keys["friction_force"], material, friction, **more)


def columns_of(source: str | Path | Table, kind: str) -> Keys:
    """Return the columns of a table, (k,) each, by the key of the section of this kind."""
    if kind == "sampled":
        return samples_of(source)
    entries = COLUMNS[kind].read(source)
    found = {name: entries.numbers(name) for name in entries.columns}
    for name, values in found.items():
        entries.refuse(name, values < 0.0, "must not be negative")
        rises = np.append(True, np.diff(values) > 0.0)
        entries.refuse(name, ~rises, f"must exceed the {name} of the previous line")
        origin = (np.arange(len(values)) == 0) & (values != 0.0) & (kind == "profile")
        entries.refuse(name, origin, "must be 0; the first line of a profile is its origin")
    return found


def samples_of(source: str | Path | Table) -> Keys:
    """Return the keys of a sampled target from a table.

    The loads may be in any order, and samples at equal loads are averaged. Standard deviations of the loads
    and friction forces are combined into relative errors of the friction.
    """
    table = read_table(source)
    entries = TARGET.read(table)
    values = {name: entries.numbers(name) for name in entries.columns}
    for name in values.keys() - TARGET.plain:
        hint = "" if name.endswith("_sd") else "; omit the origin"
        entries.refuse(name, values[name] <= 0.0, f"must be greater than 0{hint}")
    load, friction = (next(key for key in keys if key in values) for keys in (LOADS, FRICTIONS))
    x, y = values[load], values[friction]
    stated = [key for key in (f"{load}_sd", f"{friction}_sd") if key in values]
    if stated:
        words = f"{table.name}: relative_error and {stated[0]} both give the errors; keep one"
        refuse_if("relative_error" in values, words)
        # the relative error of a load counts by the exponent of the power law that fits the samples
        exponent = float(np.polyfit(np.log(x), np.log(y), 1)[0]) if len(np.unique(x)) > 1 else 1.0
        by_load, by_friction = (values.get(f"{key}_sd", 0.0 * x) for key in (load, friction))
        error = values["relative_error"] = np.hypot(exponent * by_load / x, by_friction / y)
        words = f"the error of sample {error.argmax() + 1} is as large as its friction; leave the sample out"
        refuse_if(error.max() >= 1.0, f"{table.name}: {words}")
    names = [key for key in (load, friction, "weight", "relative_error") if key in values]
    loads, group, counts = np.unique(x, return_inverse=True, return_counts=True)
    if len(loads) < len(x) and len(names) == 2:
        names.append("weight")
        values["weight"] = np.ones(len(x))
    found = {name: np.bincount(group, values[name]) / counts for name in names}
    found[load] = loads  # exact: a computed mean would be rounded
    if "weight" in names:
        found["weight"] = np.bincount(group, values["weight"]).astype(np.float64)
    if "relative_error" in names:  # repeated samples have independent errors
        found["relative_error"] = np.sqrt(np.bincount(group, values["relative_error"] ** 2)) / counts
    return {"rescaled_friction" if key == "area" else key: column for key, column in found.items()}


def read_sites(path: str | Path | Table) -> tuple[FloatArray, IntArray]:
    """Return the positions [mm], (n, 2), and numbers, (n,), of the sites of a design, seen from above.

    The table has the columns x and y, with their units, and optionally the column site, from 1; the numbers
    are returned from 0. Without this column the sites are numbered by their lines. The table of a mould is
    refused because it is mirrored.
    """
    table = read_table(path)
    mould = any(title.startswith("depth_") for title in table.header)
    must = "describes a mould, which is mirrored; give heights.csv of the design"
    refuse_if(mould, f"{table.name} {must}")
    entries = SITES.read(table)
    position = np.column_stack([entries.numbers("x"), entries.numbers("y")])
    if "site" not in entries.columns:
        return position, np.arange(len(position))
    number = np.array(entries.whole("site", 1)) - 1
    twice = np.array([site in number[:row] for row, site in enumerate(number)])
    entries.refuse("site", twice, "is the number of another site too")
    return position, number
