"""Writing and reading of contacts.csv, bit for bit; the table has one line for each image and contact."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from metafem.calibration.contact_table import COLUMNS as NAMES
from metafem.errors import InvalidInput, printable
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
        | {"contact": entries.whole("contact", 1), "site": pd.array(site, dtype="Int64")}
        | {name: entries.numbers(name, empty=True) for name in COLUMNS.units}
    )[list(NAMES)]
    of_image, of_contact = found.groupby(["test", "image"], sort=False), found.groupby("contact", sort=False)
    rules = [
        ("image", found["image"] == "", "is empty; write the name of the image"),
        ("contact", found.duplicated(["test", "image", "contact"]), "is twice in this image; keep one"),
        ("site", found.groupby("site")["contact"].transform("nunique") > 1, "belongs to another contact too"),
    ]
    rules += [(name, found[name].isna(), "is empty; write the contact's position") for name in ("x", "y")]
    for area, error in (("area", "area_error"), ("sheared_area", "sheared_area_error")):
        rules += [(name, found[name] < 0.0, "must not be negative") for name in (area, error)]
        alone = found[area].isna() != found[error].isna()
        rules.append((area, alone, f"must be empty if {entries.title(error)} is empty, and only then"))
    for names, group, of in (
        (("load", "friction_force"), of_image, "image"), (("site", "x", "y"), of_contact, "contact")
    ):  # fmt: skip
        for name in names:
            differs = group[name].transform("nunique", dropna=False) > 1
            rules.append((name, differs, f"differs from other lines of its {of}"))
    for rule in rules:
        entries.refuse(*rule)
    size = of_image["contact"].transform("size")
    for name in found["image"][size < of_contact.ngroups][:1]:
        words = f"image {printable(name, 60)} lacks contacts that others have; add them"
        raise InvalidInput(f"{table.name}: {words}, with the area 0 if they are open")
    return found.iloc[np.lexsort([of_contact.ngroup(), of_image.ngroup()])].reset_index(drop=True)
