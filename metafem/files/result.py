"""Writing and reading of the result folder of a design, whose values become plain dicts for JSON."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem import fe, studies
from metafem.contact import TabulatedContact
from metafem.errors import InvalidInput, printable, refuse_if
from metafem.files.disk import RECORD, STUDIES, file_label, read_bytes, refuse_existing, staged, write_text
from metafem.files.part import (
    drilling_program,
    mould_table,
    planned,
    with_alignment,
    with_tolerance,
)
from metafem.files.specification.read import Specification
from metafem.files.specification.sections import PartSection
from metafem.files.summits import heights_table, law_table, write_surface
from metafem.inversion import Design
from metafem.models.curve import ModelError
from metafem.notes import from_lines
from metafem.progress import doing

if TYPE_CHECKING:
    from xarray import Dataset

# Value of the first member of design.json: the kind of file and its version.
FORMAT = "metafem design 2"

# Classes whose values may occur in a record: the dataclasses and enums of these modules.
MODULES = (
    *("surface", "caps", "contact", "substrate", "models", "prediction", "notes"),
    *("inversion", "inversion.problem", "inversion.density", "inversion.wording"),
)
TYPES: Mapping[str, Any] = {
    name: kind
    for module in MODULES
    for name, kind in vars(import_module(f"metafem.{module}")).items()
    if isinstance(kind, type) and (is_dataclass(kind) or issubclass(kind, Enum))
} | {"ModelError": ModelError}
# A class whose module is imported only when a record contains it.
LATE = "Block3D"
# Functions that build a value from its members if its constructor takes other arguments.
MAKERS: Mapping[str, Callable[..., Any]] = {
    "TabulatedContact": lambda table, material: TabulatedContact(*table, material=material),
    "ModelError": lambda value, **rest: ModelError(math.nan if value is None else value, **rest),
}
ARRAYS = ("float64", "int64")

# Errors of a constructor that gets members of wrong types or values.
WRONG = (ValueError, KeyError, TypeError, AttributeError, ArithmeticError)


def save(
    design: Design,
    folder: str | Path,
    *,
    specification: Specification | None = None,
    pages: Mapping[str, str] | None = None,
    force: bool = False,
) -> None:
    """Write a design and the files to make the part into a new folder.

    The files are ``design.json`` (all data that `load` reads, and versions of libraries), ``heights.csv``,
    ``law.csv``, ``mould.csv`` and ``surface.vtu``. A specification adds ``spec.toml`` and the tables that it
    names. A block adds the solids ``block.stl`` and ``mould.stl`` and, for spheres of one radius, the
    drilling program ``mould.gcode``. The folder appears when all files are
    written.

    Parameters
    ----------
    design : Design
    folder : str or Path
        A new or empty folder; its parent folder must exist.
    specification : Specification, optional
        The specification of the design, with the options of the files of the part; default: None.
    pages : mapping of str to str, optional
        Names and texts of further files, for example ``{"report.html": metafem.report.page(design)}``;
        default: none.
    force : bool
        Whether to replace an existing result folder with all its files; default: False.

    Raises
    ------
    InvalidInput
        If the folder exists or cannot be written. Also if the part cannot be made, because a summit is
        outside ``0 < h <= R``, or because caps overlap or leave the block. No unfinished file is left.

    Examples
    --------
    >>> import tempfile
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> with tempfile.TemporaryDirectory() as parent:
    ...     save(design, Path(parent, "result"))
    ...     again = load(Path(parent, "result"))
    >>> bool((again.surface.height == design.surface.height).all())
    True
    """
    check.instance("design", design, Design, "a metafem.Design")
    options, hardness, files = PartSection(), None, dict[str, bytes]()
    if specification is not None:
        options, hardness, files = specification.part, specification.hardness, {**specification.files}
    with doing("writing the files"), staged(folder, force, folder=True) as fresh:
        part = planned(design.surface, design.template, options)
        record = {"format": FORMAT, "versions": versions(), "hardness": hardness, "design": design}
        texts = {"design.json": written(record), **result_tables(design, options), **(pages or {})}
        if part is not None:
            part.write(fresh)
            texts |= drilling_program(design, part.surface, options)
        files |= {name: text.encode("utf-8") for name, text in texts.items()}
        for name, content in files.items():
            (fresh / name).write_bytes(content)
        write_surface(design, fresh / "surface.vtu")


def result_tables(design: Design, part: PartSection) -> dict[str, str]:
    """Return the texts of a design's tables by file name: its summits, its law and the holes of its mould."""
    whole = with_alignment(design.surface, design.template, part.alignment_height)
    return {
        "heights.csv": heights_table(design.surface, design.sites),
        "law.csv": law_table(design.law),
        "mould.csv": mould_table(design, whole),
    }


@doing("reading the design")
def load(folder: str | Path) -> Design:
    """Return the design in a result folder; it equals the saved design bit for bit.

    Only ``design.json`` is read.

    Parameters
    ----------
    folder : str or Path

    Returns
    -------
    Design

    Raises
    ------
    InvalidInput
        If the folder has no ``design.json``, or if the file is damaged or of another version.

    Examples
    --------
    >>> import tempfile
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> with tempfile.TemporaryDirectory() as parent:
    ...     save(design, Path(parent, "result"))
    ...     load(Path(parent, "result")) == design
    True
    """
    record = read_result(folder)
    with damaged(Path(folder) / "design.json"):
        design: Design = from_record(record.get("design"))
        check.instance("design", design, Design, "a design")
    return design


def stored_hardness(folder: str | Path) -> float | None:
    """Return the hardness [MPa] that the specification of a result folder states, or None."""
    hardness = read_result(folder).get("hardness")
    with damaged(Path(folder) / "design.json"):
        return None if hardness is None else check.number("hardness", hardness, above=0.0)


def read_result(folder: str | Path) -> dict[str, Any]:
    """Return the content of design.json in a result folder."""
    path = Path(folder) / "design.json"
    refuse_if(os.path.isfile(folder), f"{file_label(folder)} is a file; name a result folder of metafem")
    content = read_bytes(path, RECORD, "no such file; name a result folder of metafem")
    with damaged(path):
        record = json.loads(content)
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        remedy = "design it again from its spec.toml"
        raise InvalidInput(f"{file_label(path)} is not of the format that is read, {FORMAT!r}; {remedy}")
    return record


@contextmanager
def damaged(path: Path) -> Iterator[None]:
    """Raise InvalidInput, which calls the file damaged, if the body cannot use the content of the file."""
    try:
        yield
    except (OSError, RecursionError, *WRONG) as error:
        raise InvalidInput(f"{file_label(path)} is damaged: {printable(str(error))}") from None


def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that affect the numbers of a design."""
    names = ("metafem", "numpy", "scipy", "numba", "meshio")
    return {"python": platform.python_version(), **{name: version(name) for name in names}}


def written(record: Any) -> str:
    """Return the JSON text of a record.

    A dataclass becomes ``{"type": its name, field: ...}``, an array ``{"float64": [...]}`` or
    ``{"int64": [...]}``, an enum ``{"type": ..., "name": ..., "message": ...}``, and a tuple becomes a list.
    """
    return json.dumps(record, default=_members, indent=1, allow_nan=False) + "\n"


def _members(value: Any) -> Any:
    """Return the members of a value for which JSON has no type."""
    title = type(value).__name__
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, np.ndarray) and value.dtype.name in ARRAYS:
        return {value.dtype.name: value.tolist()}
    unknown = title not in (*TYPES, LATE)
    refuse_if(unknown, f"{value!r:.80} cannot be written to a record; give a function as a table")
    if isinstance(value, Enum):
        return {"type": title, "name": value.name, "message": value.value}
    members = {field.name: getattr(value, field.name) for field in fields(value)}
    for name, error in members.items():
        if isinstance(error, ModelError):  # which is a number for JSON
            number = None if math.isnan(error) else float(error)
            members[name] = {"type": "ModelError", "value": number, **vars(error)}
    return {"type": title, **members}


def from_record(record: Any) -> Any:
    """Return the value of a record that `written` wrote; the constructor of a class checks its members."""
    if isinstance(record, list):
        return tuple(map(from_record, record))
    if not isinstance(record, dict):
        return record
    for dtype in ARRAYS:
        if [*record] == [dtype]:
            array = np.array(record[dtype], dtype)
            array.flags.writeable = False
            return array
    title = record.get("type")
    if title is None:
        return {int(key) if key.isdecimal() else key: from_record(each) for key, each in record.items()}
    members = {key: from_record(each) for key, each in record.items() if key != "type"}
    try:
        kind: Any = fe.Block3D if title == LATE else TYPES[title]
        return kind[members["name"]] if issubclass(kind, Enum) else MAKERS.get(title, kind)(**members)
    except WRONG as error:
        raise InvalidInput(
            f"its {printable(str(title), 40)} cannot be made: {printable(str(error))}"
        ) from None


def study_path(folder: str | Path, name: str, force: bool) -> Path:
    """Return the path of a study in a result folder; raise InvalidInput if `write_study` would refuse it."""
    read_result(folder)  # raises an error if this is not a result folder
    path = Path(folder) / f"{name}.nc"
    refuse_existing(path, force)
    return path


def write_study(study: Dataset, path: Path, *, force: bool = False) -> None:
    """Write a study as NetCDF 4 with h5netcdf; an existing file is refused unless `force` is true.

    The answer of a study of manufacturing is also written into the files for the workshop beside it.
    """
    with staged(path, force) as fresh:
        study.to_netcdf(fresh, engine="h5netcdf")
    if study.attrs.get("study") == "manufacturing":
        for file in filter(Path.exists, (path.with_name("mould.csv"), path.with_name("mould.gcode"))):
            text = with_tolerance(file.read_text("utf-8"), studies.summary(study).answer)
            write_text(file, text, force=True)


@doing("reading the studies")
def stored_studies(folder: str | Path) -> dict[str, Dataset]:
    """Return the studies in a result folder by name; raise InvalidInput for a damaged file."""
    import xarray as xr

    found = {}
    for path in (Path(folder, f"{name}.nc") for name in STUDIES):
        if path.exists():
            with damaged(path):
                found[path.stem] = xr.load_dataset(path, engine="h5netcdf")
            other = found[path.stem].attrs.get("study") != path.stem
            refuse_if(other, f"{file_label(path)} is not a study {path.stem!r} of metafem")
            old = "placement" in found[path.stem].dims
            refuse_if(old, f"{file_label(path)} is of an earlier version; run the study again")
    return found


def study_data(study: Dataset) -> dict[str, Any]:
    """Return a study as `xarray.Dataset.to_dict` does; nan and infinite numbers become None."""
    found: dict[str, Any] = plain_data(study.to_dict())
    notes = [note.to_json() for note in from_lines(str(study.attrs["notes"]))]
    return {**found.pop("attrs"), "notes": notes, **found}


def plain_data(value: Any) -> Any:
    """Return a value in which arrays become lists, and nan and infinite numbers become None."""
    if isinstance(value, Mapping):
        return {name: plain_data(member) for name, member in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain_data(member) for member in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
