"""Image files of contacts, their forces and the table of the contacts.

contacts.csv has one line for each image and contact, and is read bit for bit.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem.calibration.contact_table import COLUMNS, listed
from metafem.errors import InvalidInput, printable, refuse_if, refuse_missing
from metafem.files.disk import file_label
from metafem.files.tables import Columns, Table
from metafem.notes import Note

if TYPE_CHECKING:
    from pandas import DataFrame

# Extensions of the image files that are read, and errors of files that cannot be read.
FORMATS, UNREADABLE = (".tif", ".tiff", ".png"), (OSError, ValueError, SyntaxError, EOFError)

# Weights of red, green and blue in the luminance, from Recommendation ITU-R BT.709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

FORCES = Columns(
    "image,load_mN,friction_force_mN,sheared_image,test",
    ("image,load",),
    "image",
    "image,load_mN (or in another unit), optionally with friction_force_mN, sheared_image and test",
)


HEADER = (
    "image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2,"
    "sheared_area_mm2,sheared_area_error_mm2"
)

CONTACTS = Columns(HEADER, ("image,load,contact,x,y,area,area_error",), "contact")


def find_images(sources: Iterable[str | Path]) -> dict[str, Callable[[], NDArray[Any]]]:
    """Return a function that reads each image in files and folders, by its name, in natural order.

    Every page of a file is one image, with the name ``stack.tif:3``. A file that cannot be opened is one
    image, whose reading fails. Raise InvalidInput for a name that does not exist, a file of another format, a
    folder without an image, or two images of one name.
    """
    refuse_missing("imageio", "images", "reading images")
    from imageio.v3 import improps

    everything: Any = ...
    found: dict[str, Callable[[], NDArray[Any]]] = {}
    for source in map(Path, sources):
        refuse_if(not source.exists(), f"{file_label(source)}: no such file or folder")
        files = sorted(source.iterdir(), key=lambda path: natural(path.name)) if source.is_dir() else [source]
        paths = [path for path in files if path.suffix.lower() in FORMATS and not path.name.startswith(".")]
        refuse_if(not paths, f"{file_label(source)} is or holds no image that is read; save TIFF or PNG")
        for path in paths:
            try:
                count = improps(path, index=everything, plugin="pillow").n_images or 1
            except UNREADABLE:
                count = 1
            for page in range(count):
                name = f"{path.name}:{page + 1}" if count > 1 else path.name
                refuse_if(name in found, f"two images have the name {printable(name)}; rename one of them")
                found[name] = partial(_read, path, page, name)
    return found


def natural(name: str) -> list[tuple[int, str]]:
    """Return a key that sorts names with numbers in natural order: a2 before a10."""
    parts = re.split(r"(\d+)", name.casefold())
    return [(int(part), "") if i % 2 else (-1, part) for i, part in enumerate(parts)]


def _read(path: Path, page: int, name: str) -> NDArray[Any]:
    """Return the grey values, (rows, columns) with row 0 at the top; the luminance of an image in colour."""
    from imageio.v3 import imread

    try:
        values = imread(path, index=page, plugin="pillow")
    except UNREADABLE as error:
        reason = printable(" ".join(str(error).split()), 200) or "it is damaged"
        raise InvalidInput(f"{printable(name)} cannot be read: {reason}") from None
    if values.ndim == 2:
        return values.astype(values.dtype.newbyteorder("="), copy=False)
    colours = values[..., :3] if values.shape[2] > 2 else values[..., [0, 0, 0]]
    # integers remain integers, because saturated pixels are recognised by the ends of the integer scale
    grey = colours @ LUMINANCE
    return np.asarray(np.rint(grey) if values.dtype.kind in "ui" else grey).astype(values.dtype)


def read_forces(names: Sequence[str], source: str | Path | Table | None) -> tuple[DataFrame, list[Note]]:
    """Return the forces of images, one row for each image before shear, and notes on what is left out.

    `names` are the names of all images. `source` is a table with the columns ``image``, ``load`` with its
    unit, such as ``load_mN``, and optionally ``friction_force`` with its unit, ``sheared_image`` and
    ``test``. Raise InvalidInput, with line and column, if an entry cannot be read, or if the table names none
    of the images.
    """
    import pandas as pd

    every = pd.DataFrame({"image": [*names]})
    if source is None:
        return every.assign(test="", sheared_image="", load=np.nan, friction_force=np.nan), []
    entries = FORCES.read(source)
    found = pd.DataFrame(
        {name: entries.texts(name) for name in ("image", "test", "sheared_image")}
        | {name: entries.numbers(name, empty=True) for name in ("load", "friction_force")}
    )
    shown = pd.concat([found["image"], found["sheared_image"]])
    twice = shown[shown.duplicated() & (shown != "")]
    for column, wrong, must in (
        ("image", found["image"] == "", "is empty; write the name of the image"),
        ("load", found["load"].isna(), "is empty; write the load of the image"),
        ("image", found["image"].isin(twice), f"{listed(twice)} is named twice; name each image once"),
        ("sheared_image", found["sheared_image"].isin(twice), f"{listed(twice)} is named twice"),
    ):
        entries.refuse(column, wrong, must)
    absent = [name for name in shown if name not in ("", *names)]
    listing = f"{listed(absent)} is not among the images {listed(names)}; a page is named a.tif:1"
    words = f"{entries.name}: {listing}"
    refuse_if(not found["image"].isin(names).any(), words)
    found["sheared_image"] = found["sheared_image"].where(found["sheared_image"].isin(names), "")
    rows = every[~every["image"].isin(found["sheared_image"])].merge(found, how="left", on="image")
    without = rows.loc[rows["load"].isna(), "image"]
    text = f"{listed(without)}: not in the table of forces, so that the load is empty"
    notes = [Note(words)] * bool(absent) + [Note(text)] * (not without.empty)
    return rows.fillna({"test": "", "sheared_image": ""}), notes


def contacts_table(table: DataFrame) -> str:
    """Return the CSV text of a table of contacts; numbers that were not measured are empty."""
    for image in table["image"][table.duplicated(["test", "image", "contact"])][:1]:
        raise InvalidInput(f"image {printable(image)} is in one test twice; give it two names")
    # texts are quoted, because a line that begins with # would be a comment
    lines = table.assign(site=table["site"] + 1).to_csv(
        index=False, header=False, quoting=csv.QUOTE_NONNUMERIC, lineterminator="\n"
    )
    return f"{HEADER}\n{lines}"


def read_contacts(source: str | Path | Table) -> DataFrame:
    """Return the table of contacts in a file that `contacts_table` wrote, or one with the same columns.

    All images must have the same contacts. The columns of tests, friction forces, sites and sheared areas
    may be absent. Lengths, areas and forces may be in other units.
    """
    import pandas as pd

    entries = CONTACTS.read(source)
    matched = any(entries.texts("site"))
    site = [number - 1 for number in entries.whole("site", 1)] if matched else [pd.NA] * len(entries.rows)
    found = pd.DataFrame(
        {name: entries.texts(name) for name in ("image", "test")}
        | {"contact": entries.whole("contact", 1), "site": pd.array(site, dtype="Int64")}
        | {name: entries.numbers(name, empty=True) for name in CONTACTS.units}
    )[list(COLUMNS)]
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
        raise InvalidInput(f"{entries.name}: {words}, with the area 0 if they are open")
    return found.iloc[np.lexsort([of_contact.ngroup(), of_image.ngroup()])].reset_index(drop=True)
