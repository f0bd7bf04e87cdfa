"""Reading of measured friction laws: tables of loads, friction forces or contact areas, and their errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from metafem._validate import IntArray
from metafem.calibration import MeasuredLaw, MeasurementErrors, measured_law
from metafem.errors import InvalidInput, named, refuse_if
from metafem.files.measurement.contacts import contacts_of, is_of_contacts
from metafem.files.tables import Columns, Table, read_table
from metafem.surface import Friction, Material

COLUMNS = Columns(
    "load_mN,friction_force_mN,area_mm2,load_sd_mN,friction_force_sd_mN,area_sd_mm2",
    ("load,friction_force", "load,area"),
    "measured point",
    "load_mN,friction_force_mN or load_mN,area_mm2 (or in other units), optionally with load_sd_mN, "
    "friction_force_sd_mN and area_sd_mm2",
)

# Standard deviations of the source paper's measurements.
PAPER = MeasurementErrors()


def read_measured_law(
    source: str | Path | Table,
    material: Material,
    friction: Friction | None = None,
    *,
    errors: MeasurementErrors = PAPER,
    label: str = "static",
    sites: IntArray | None = None,
) -> MeasuredLaw:
    """Return the measured friction law in a table.

    Parameters
    ----------
    source : str, Path or Table
        CSV file, or a table that was already read. The first line names the columns as quantity_unit, such as
        ``load_mN,friction_force_mN``, in any order and unit. ``load`` is required, and ``friction_force`` or
        ``area``. The standard deviations ``load_sd``, ``friction_force_sd`` and ``area_sd`` are optional.
        Other columns are not read, and `metafem.progress` reports them. Lines that begin with ``#`` are
        skipped. A table of ``metafem images`` is also accepted.
    material : Material
    friction : Friction, optional
        Needed if the table has friction forces but no areas.
    errors : MeasurementErrors
        Standard deviations for a table without such columns; default: those of the source paper.
    label : str
        Name of the law; default: "static".
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
    table = source if isinstance(source, Table) else read_table(source, COLUMNS.example)
    if is_of_contacts(table):
        contacts = contacts_of(table)
        try:
            return measured_law(contacts, material, friction, errors=errors, label=label, sites=sites)
        except InvalidInput as error:
            raise InvalidInput(f"{table.name}: {error}") from None
    entries = COLUMNS.of(table)
    values: dict[str, Any] = {name: entries.numbers(name) for name in entries.columns}
    refuse_if(
        friction is None and "area" not in values,
        f"{table.name} holds friction forces, which can only be rescaled with a shear strength and an area "
        "ratio; state them in the section [friction] or by --shear-strength and --area-ratio, or add a "
        "column area_mm2",
    )
    with named(entries.names()):
        return MeasuredLaw(**values, material=material, friction=friction, errors=errors, label=label)
