"""Tables of measured friction laws: loads, friction forces or contact areas, and their errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from metafem._given import Names, printable
from metafem._validate import IntArray
from metafem.calibration import MeasuredLaw, MeasurementErrors
from metafem.errors import InvalidInput, named
from metafem.files.csv_rows import Table, read_table
from metafem.files.measurement.contacts import read_contacts
from metafem.files.measurement.quantity_columns import Column, numbers, quantity_columns
from metafem.surface import Friction, Material

# Quantities of a measured law with the package's units, and a usual unit in the name of a column.
UNITS = {"load": ("N", "mN"), "friction_force": ("N", "mN"), "area": ("mm^2", "mm2")}
UNITS |= {f"{name}_sd": units for name, units in UNITS.items()}

EXAMPLE = "load_mN,friction_force_mN"

WANTED = (
    f"{EXAMPLE} or load_mN,area_mm2 (or in other units), optionally with load_sd_mN, friction_force_sd_mN "
    "and area_sd_mm2"
)

# Columns by which a table of the contacts in images is recognised.
CONTACTS = {"image", "contact"}

# The paper's error bars.
PAPER = MeasurementErrors()


def read_measured_law(
    path: str | Path,
    material: Material,
    friction: Friction | None = None,
    *,
    errors: MeasurementErrors = PAPER,
    label: str = "static",
    sites: IntArray | None = None,
) -> MeasuredLaw:
    """Return the measured law of a table.

    Parameters
    ----------
    path : str or Path
        CSV whose first line names its columns as quantity_unit: ``load`` and ``friction_force`` or ``area``,
        and optionally their standard deviations ``load_sd``, ``friction_force_sd`` and ``area_sd``, in any
        order and unit, as ``load_mN,friction_force_mN``. Other columns are not read, which `metafem.progress`
        reports; lines that begin with ``#`` are skipped. Or a table of the contacts in images, as
        ``metafem images`` writes it.
    material : Material
    friction : Friction, optional
        Needed for friction forces without areas.
    errors : MeasurementErrors
        Standard deviations where the table has none; default: those of the paper.
    label : str
        Name of the law; default: "static".
    sites : ndarray of int, (n,), optional
        Sites of the asperities of the design, ``Design.sites``; default: asperities have the numbers of the
        sites in a table of contacts.

    Returns
    -------
    MeasuredLaw

    Raises
    ------
    InvalidInput
        For a missing column, a column without a unit or with one of another dimension, an entry that is not a
        number, and for points that are no friction law; names the line and the column.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "measured.csv")
    ...     _ = path.write_text("load_mN,area_mm2\\n50,0.21\\n100,0.43\\n")
    ...     read_measured_law(path, Material(1.36)).load
    array([0.05, 0.1 ])
    """
    table = read_table(path, EXAMPLE)
    if set(table.header) >= CONTACTS:
        contacts = read_contacts(path)
        try:
            return MeasuredLaw.from_contacts(
                contacts, material, friction, errors=errors, label=label, sites=sites
            )
        except InvalidInput as error:
            raise InvalidInput(f"{table.name}: {error}") from None
    columns = _columns(table)
    table.report_unread([table.header[column] for column, _ in columns.values()])
    entries = table.entries()
    if not entries:
        raise InvalidInput(f"{table.name} names columns but holds no measured point")
    values: dict[str, Any] = {name: numbers(table, column) for name, column in columns.items()}
    names = Names(
        places=[f"{table.name}, line {line}" for line, _ in entries],
        names={name: table.header[column] for name, (column, _) in columns.items()},
        units={name: ("", float(size)) for name, (_, size) in columns.items()},
    )
    if friction is None and "area" not in values:
        raise InvalidInput(
            f"{table.name} holds friction forces, which can only be rescaled with a shear strength and an "
            "area ratio; state them (--shear-strength, --area-ratio), or add a column area_mm2"
        )
    with named(names):
        return MeasuredLaw(**values, material=material, friction=friction, errors=errors, label=label)


def _columns(table: Table) -> dict[str, Column]:
    """Return the columns of the law."""
    found = quantity_columns(table, UNITS, lambda name: name if name in UNITS else None)
    if "load" not in found or not {"friction_force", "area"} & found.keys():
        titles = printable(", ".join(table.header), 120)
        raise InvalidInput(f"{table.name} has the columns {titles}; name its columns {WANTED}")
    for name in found:
        if name.endswith("_sd") and name.removesuffix("_sd") not in found:
            raise InvalidInput(
                f"{table.name} has the column {table.header[found[name][0]]} without "
                f"{name.removesuffix('_sd')}; add its column or leave this one out"
            )
    return found
