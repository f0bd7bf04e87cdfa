"""Writing and reading of contacts.csv, bit for bit; the table has one line for each image and contact."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from metafem._given import printable, shown
from metafem.calibration.contact_table import COLUMNS as NAMES
from metafem.errors import InvalidInput
from metafem.files.tables import Columns, Table, read_table

if TYPE_CHECKING:
    from pandas import DataFrame

HEADER = (
    "image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2,"
    "sheared_area_mm2,sheared_area_error_mm2"
)

COLUMNS = Columns(HEADER, ("image,load,contact,x,y,area,area_error",), "contact")


def contacts_table(table: DataFrame) -> str:
    """Return the CSV text of a table of contacts; numbers that were not measured are empty."""
    for image in table["image"][table.duplicated(["test", "image", "contact"])][:1]:
        raise InvalidInput(f"image {printable(image)} is in one test twice; give it two names")
    # texts are quoted, because a line that begins with # would be a comment
    lines = table.assign(site=table["site"] + 1).to_csv(
        index=False, header=False, quoting=csv.QUOTE_NONNUMERIC, lineterminator="\n"
    )
    return f"{HEADER}\n{lines}"


def read_contacts(path: str | Path) -> DataFrame:
    """Return the table of contacts in a file that `contacts_table` wrote, or one with the same columns.

    All images must have the same contacts. The columns of tests, friction forces, sites and sheared areas
    may be absent. Lengths, areas and forces may be in other units.
    """
    return contacts_of(read_table(path))


def contacts_of(table: Table) -> DataFrame:
    """Return the contacts in a table with the columns that `read_contacts` reads."""
    import pandas as pd

    entries = COLUMNS.read(table)
    matched = any(entries.texts("site"))
    site = [number - 1 for number in entries.whole("site", 1)] if matched else [pd.NA] * len(table.rows)
    found = pd.DataFrame(
        {name: entries.texts(name) for name in ("image", "test")}
        | {"contact": entries.whole("contact", 1)}
        | {"site": pd.array(site, dtype="Int64")}
        | {name: entries.numbers(name, empty=True) for name in COLUMNS.units}
    )[list(NAMES)]
    of_image, of_contact = found.groupby(["test", "image"], sort=False), found.groupby("contact", sort=False)
    alike = [(name, of_image, "image") for name in ("load", "friction_force")]
    alike += [(name, of_contact, "contact") for name in ("site", "x", "y")]
    areas = [name for name in NAMES if "area" in name]
    rules = [
        ("image", found["image"] == "", "is empty; write the name of the image"),
        ("contact", found.duplicated(["test", "image", "contact"]), "is twice in this image; keep one"),
        *((name, found[name].isna(), "is empty; write the contact's position") for name in ("x", "y")),
        *((name, found[name] < 0.0, "must not be negative") for name in areas),
        *(
            (one, found[one].isna() & found[other].notna(), f"is empty, and {entries.title(other)} is not")
            for name in areas[::2]
            for one, other in ((name, f"{name}_error"), (f"{name}_error", name))
        ),
        *(
            (
                name,
                group[name].transform("nunique", dropna=False) > 1,
                f"differs from other lines of its {of}",
            )
            for name, group, of in alike
        ),
        ("site", found.groupby("site")["contact"].transform("nunique") > 1, "belongs to another contact too"),
    ]
    for name, wrong, must in rules:
        for row in np.flatnonzero(wrong)[:1].tolist():
            text = shown(entries.texts(name)[row], 40)
            raise InvalidInput(f"{entries.cell(row, name)} = {text} {must}")
    size = of_image["contact"].transform("size")
    for name in found["image"][size < of_contact.ngroups][:1]:
        words = f"image {printable(name, 60)} lacks contacts that others have; add them"
        raise InvalidInput(f"{table.name}: {words}, with the area 0 if they are open")
    return found.iloc[np.lexsort([of_contact.ngroup(), of_image.ngroup()])].reset_index(drop=True)
