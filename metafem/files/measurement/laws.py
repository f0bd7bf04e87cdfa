"""Tables of measured friction laws: loads, friction forces or contact areas, and their errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from metafem._validate import IntArray
from metafem.calibration import MeasuredLaw, MeasurementErrors
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

# The paper's error bars.
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
    """Return the measured law of a table.

    Parameters
    ----------
    source : str, Path or Table
        CSV file, or its content. Its first line names its columns as quantity_unit: ``load`` and
        ``friction_force`` or ``area``, and optionally their standard deviations ``load_sd``,
        ``friction_force_sd`` and ``area_sd``, in any order and unit, as ``load_mN,friction_force_mN``.
        Other columns are not read, which `metafem.progress` reports; lines that begin with ``#`` are skipped.
        Or a table of the contacts in images, as
        ``metafem images`` writes it.
    material : Material
    friction : Friction, optional
        Needed for friction forces without areas.
    errors : MeasurementErrors
        Standard deviations if the table has none; default: those of the paper.
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
        number, and for points that are not a friction law; the error states line and column.

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
            return MeasuredLaw.from_contacts(
                contacts, material, friction, errors=errors, label=label, sites=sites
            )
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
