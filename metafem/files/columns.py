"""Columns of quantities in tables: target laws and profiles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.csv_rows import Table, table_of
from metafem.files.units import factor


@dataclass(frozen=True)
class Columns:
    """The columns of a kind of table, which are also keys of a specification."""

    what: str  # the content of the table, in words
    units: Mapping[str, str]  # the package's unit of each column
    sets: tuple[frozenset[str], ...]  # those that are given together
    rising: frozenset[str]  # those whose entries increase
    example: str  # a valid first line
    wanted: str  # what the first line must be
    from_zero: bool | None = False  # whether the first entries are 0; None: they may be; others are above 0
    plain: frozenset[str] = frozenset()  # optional columns of numbers without a unit
    errors: frozenset[str] = frozenset()  # optional columns of standard deviations


# Quantities of a measured law, as `metafem compare` reads them, and their standard deviations.
LAW = {"load": "N", "friction_force": "N", "area": "mm^2"}
LAW |= {"rescaled_load": "mm^2", "rescaled_friction": "mm^2"}
ERRORS = {f"{name}_sd": unit for name, unit in LAW.items()}

TARGET = Columns(
    "law",
    LAW | ERRORS,
    (
        frozenset({"rescaled_load", "rescaled_friction"}),
        *(
            frozenset({"load", *others})
            for others in (["friction_force"], ["area"], ["friction_force", "area"])
        ),
    ),
    frozenset(),
    "load_N,friction_force_N",
    "load_N,friction_force_N, or load_N,area_mm2, or rescaled_load_mm2,rescaled_friction_mm2 (or in other "
    "units), and optionally their errors such as friction_force_sd_mN, or weight",
    plain=frozenset({"weight", "relative_error"}),
    errors=frozenset(ERRORS),
)

PROFILE = Columns(
    "profile",
    {"rho": "mm", "f": "mm"},
    (frozenset({"rho", "f"}),),
    frozenset({"rho", "f"}),
    "rho_mm,f_um",
    "rho_mm,f_um (or in other units)",
    from_zero=True,
)

MEASURED = Columns(
    "law",
    {"indentation": "mm", "load": "N", "area": "mm^2"},
    (frozenset({"indentation", "load", "area"}),),
    frozenset({"indentation", "load", "area"}),
    "indentation_um,load_mN,area_mm2",
    "indentation_um,load_mN,area_mm2 (or in other units)",
    from_zero=None,
)

# The columns of the tables that a specification names, by the kind of its section.
COLUMNS = {"sampled": TARGET, "profile": PROFILE, "tabulated": MEASURED}


def columns_of(name: str, content: bytes, columns: Columns) -> dict[str, list[Any]]:
    """Return the entries of a table by key, as a specification would hold them."""
    table = table_of(name, content, columns.example)
    found = _found(table, columns)
    table.report_unread([table.header[i] for i, _ in found.values()])
    if not table.rows:
        raise InvalidInput(f"{table.name} has no samples below its column names ({columns.example})")
    entries: dict[str, list[Any]] = {name: [] for name in found}
    before: dict[str, float] = {}
    for line, row in table.entries():
        for name, (column, unit) in found.items():
            value = table.plain(row[column])
            number = float(table.number(line, column, row[column]))
            if name in columns.plain:
                entries[name].append(number)
                continue
            # checked here, where the line is known; read again with the specification
            key = f"{table.name}, line {line}: {table.header[column]} = {value}"
            first = not entries[name]
            origin = first and columns.from_zero is not False
            if columns.from_zero and first and number != 0.0:
                raise InvalidInput(f"{key} must be 0; the first line of a {columns.what} is its origin")
            if number < 0.0 or (number == 0.0 and not origin):
                of_law = columns.from_zero is False and name not in columns.errors
                remedy = "; omit the origin" if of_law else ""
                raise InvalidInput(f"{key} must be greater than 0{remedy}")
            if name in columns.rising and not first and number <= before[name]:
                words = "load" if name == "rescaled_load" else name
                raise InvalidInput(f"{key} must exceed the {words} of the previous line")
            before[name] = number
            entries[name].append(f"{value} {unit}")
    return entries


def _found(table: Table, columns: Columns) -> dict[str, tuple[int, str]]:
    """Return index and unit of each column that is read."""
    found: dict[str, tuple[int, str]] = {}
    for column, title in enumerate(table.header):
        name, _, unit = (title, "", "") if title in columns.plain else title.rpartition("_")
        if name not in columns.units and name not in columns.plain:
            continue
        if name in found:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        if name in columns.units:
            try:
                factor(unit, columns.units[name])
            except InvalidInput as error:
                raise InvalidInput(f"{table.name}: column {printable(title, 40)} {error}") from None
        found[name] = (column, unit)
    if frozenset(found) - columns.plain - columns.errors not in columns.sets:
        titles = printable(", ".join(table.header), 120)
        raise InvalidInput(f"{table.name} has the columns {titles}; name its columns {columns.wanted}")
    for name in columns.errors & found.keys():
        if name.removesuffix("_sd") not in found:
            raise InvalidInput(
                f"{table.name} has the column {table.header[found[name][0]]} without "
                f"{name.removesuffix('_sd')}; add its column or leave this one out"
            )
    return found
