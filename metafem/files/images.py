"""Image files of contacts, the forces at which they were taken, and height maps of microscopes."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._extras import refuse_missing
from metafem._given import printable
from metafem.calibration.contact_table import listed
from metafem.errors import InvalidInput, refuse_if
from metafem.files.disk import file_label, refuse_unreadable
from metafem.files.tables import Columns, Table
from metafem.files.units import factor, quantity
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

    every = pd.DataFrame({"image": [*names], "test": "", "sheared_image": "", "load": np.nan})
    every["friction_force"] = np.nan
    if source is None:
        return every, []
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
        for row in np.flatnonzero(wrong)[:1].tolist():
            raise InvalidInput(f"{entries.cell(row, column)} {must}")
    absent = [name for name in shown if name not in ("", *names)]
    words = (
        f"{entries.table.name}: {listed(absent)} is not among the images {listed(names)}; a page is named "
        "a.tif:1"
    )
    kept, without = found[found["image"].isin(names)], every[~every["image"].isin(shown)]
    refuse_if(kept.empty, words)
    kept = kept.assign(sheared_image=kept["sheared_image"].where(kept["sheared_image"].isin(names), ""))
    result = pd.concat([kept, without]).sort_values("image", key=lambda image: image.map([*names].index))
    notes = [Note(words)] * bool(absent)
    text = f"{listed(without['image'])}: not in the table of forces, so that the load is empty"
    return result.reset_index(drop=True), notes + [Note(text)] * (not without.empty)


def read_height_map(
    path: str | Path, pixel: str | None = None, height_unit: str | None = None
) -> tuple[NDArray[np.float32], tuple[float, float]]:
    """Return the heights in a file, relative to their median, and the sides of a pixel along x and y [mm].

    Parameters
    ----------
    path : str or Path
        File in the format .npy (rows as in an image), or in a format that SurfaceTopography reads: .x3p,
        .sur, .plux and others.
    pixel : str, optional
        Distance between neighbouring pixels, such as ``"2 um"``, for a file that does not state it.
    height_unit : str, optional
        Unit of the heights, such as ``"um"``, for a file that does not state it.

    Raises
    ------
    InvalidInput
        If the file cannot be read or holds no map, if the pixel or the unit is stated nowhere, or if an
        argument states what the file already states.
    """
    name = file_label(path)
    refuse_unreadable(path)
    try:
        if Path(path).suffix.lower() == ".npy":
            heights, sides, unit = np.load(path, allow_pickle=False).astype(float), None, None
        else:
            heights, sides, unit = _instrument(path, name)
    except (InvalidInput, MemoryError):
        raise
    except Exception as error:  # the readers raise exceptions of all types for damaged files
        raise InvalidInput(
            f"{name} cannot be read as a height map: {type(error).__name__}: {printable(str(error), 200)}"
        ) from None
    for option, example, what, stated, given in (
        ("--pixel", "2 um", "the size of its pixels", sides, pixel),
        ("--height-unit", "um", "the unit of its heights", unit, height_unit),
    ):
        refuse_if(stated and given, f"{name} states {what}; leave {option} out")
        lacks = f'{name} does not state {what}; add for example {option} "{example}"'
        refuse_if(not stated and not given, lacks)
    try:
        size = float(factor(unit or height_unit or "", "mm"))
    except InvalidInput as error:
        raise InvalidInput(f'--height-unit {error}; write for example "um"') from None
    if pixel is None:
        width, height = (size * side for side in sides or ())
    else:
        width = height = check.number("--pixel", quantity("--pixel", pixel, "mm"), above=0.0)
    return ((heights - np.nanmedian(heights)) * size).astype(np.float32), (width, height)


def _instrument(path: str | Path, name: str) -> tuple[NDArray[Any], Any, str | None]:
    """Return the heights in a file of an instrument, the sides of a pixel, and their unit, if stated."""
    refuse_missing("SurfaceTopography", "metrology", f"reading {name}")
    with warnings.catch_warnings():  # its import warns of a missing mpi4py
        warnings.simplefilter("ignore", ImportWarning)
        from SurfaceTopography import IO
    with IO.open_topography(str(path)) as reader:
        maps = [each for each in reader.channels if each.dim == 2 and each.is_height_channel]
        refuse_if(not maps, f"{name} holds no map of heights")
        channel, sizes, points = maps[0], maps[0].physical_sizes, maps[0].nb_grid_pts
        heights = channel.topography(**({} if sizes else {"physical_sizes": points})).heights()
    unit = channel.unit if isinstance(channel.unit, str) and channel.unit else None
    sides = (sizes[0] / points[0], sizes[1] / points[1]) if sizes and unit else None
    # in SurfaceTopography the first index runs along x, and the second upwards along y
    return np.ma.filled(np.ma.asarray(heights).astype(np.float64), np.nan).T[::-1], sides, unit
