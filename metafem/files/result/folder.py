"""Writing and reading of the result folder of a design."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import MappingProxyType
from typing import Any

from metafem import _validate as check
from metafem.contact.by_profile import cap_of
from metafem.errors import InvalidInput, refuse_if
from metafem.files.atomic import digest, earlier_result, staged
from metafem.files.part.caps import with_alignment
from metafem.files.part.plan import Part, PartOptions, part_notes, planned
from metafem.files.reading import damaged, file_label, read_record
from metafem.files.result.changes import FolderNote, compared
from metafem.files.result.records import from_record, to_record
from metafem.files.result.tables import heights_table, law_table, mould_table, write_surface
from metafem.files.specification.read import Specification
from metafem.inversion import Design
from metafem.models.model import contact_of
from metafem.notes import Note
from metafem.progress import doing

# Value of the first member of design.json: the kind of file and its version.
FORMAT = "metafem design 1"

NO_PAGES: Mapping[str, str] = MappingProxyType({})


def save(
    design: Design,
    folder: str | Path,
    *,
    specification: Specification | None = None,
    part: PartOptions | None = None,
    pages: Mapping[str, str] = NO_PAGES,
    force: bool = False,
) -> None:
    """Write a design and the files to make the part into a new folder.

    The files are ``design.json`` (all data that `load` reads, and versions of libraries), ``heights.csv``,
    ``law.csv``, ``mould.csv`` and ``surface.vtu``. A specification adds ``spec.toml`` and the tables that it
    names. A block adds the solids ``block.stl`` and ``mould.stl``. The folder
    appears when all files are written. Its hidden file ``.metafem-files`` lists the files with their SHA-256
    hashes, so that `force` can recognise changed files.

    Parameters
    ----------
    design : Design
    folder : str or Path
        A new or empty folder; its parent folder must exist.
    specification : Specification, optional
        The specification of the design; default: None.
    part : PartOptions, optional
        Options of the files of the part. Default: the options in the specification.
    pages : mapping of str to str, optional
        Names and texts of further files, for example ``{"report.html": metafem.report.page(design)}``;
        default: none.
    force : bool
        Whether to replace an existing result folder. A folder is refused if it contains changed files, or
        files that metafem did not write. Default: False.

    Raises
    ------
    InvalidInput
        If the folder is refused, if another run is writing it, or if it cannot be written. Also if the part
        cannot be made, because a summit is outside ``0 < h <= R``, or because caps overlap or leave the
        block. No unfinished file is left.

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
    with result_folder(folder, specification, force=force) as fresh:
        write_all(design, fresh, specification, pages, part)


def result_folder(
    folder: str | Path, specification: Specification | None = None, *, force: bool = False
) -> AbstractContextManager[Path]:
    """Return the context manager `staged` for the folder of a design, with its specification."""
    return staged(folder, force, {} if specification is None else specification.files)


@doing("writing the files")
def write_all(
    design: Design,
    folder: Path,
    specification: Specification | None = None,
    pages: Mapping[str, str] = NO_PAGES,
    part: PartOptions | None = None,
) -> Part | None:
    """Write all files of a design into an existing folder; return the part, or None without a block."""
    surface = design.surface
    options = part or (PartOptions() if specification is None else specification.part)
    made = planned(surface, design.template, options)
    texts = {
        "design.json": json.dumps(_record(design, specification, made, options), indent=1, allow_nan=False)
        + "\n",
        **result_tables(design, options),
        **pages,
    }
    contents = {name: text.encode("utf-8") for name, text in texts.items()}
    if specification is not None:
        contents |= specification.files
    try:
        for name, content in contents.items():
            (folder / name).write_bytes(content)
        if made is not None:
            made.write(folder)
        write_surface(design, folder / "surface.vtu")
    except OSError as error:
        raise InvalidInput(f"{folder} cannot be written: {error.strerror}") from None
    return made


def result_tables(design: Design, part: PartOptions) -> dict[str, str]:
    """Return the texts of a design's tables by file name: its summits, its law and the holes of its mould."""
    whole = with_alignment(design.surface, design.template, part.alignment_height)
    return {
        "heights.csv": heights_table(design.surface, design.sites),
        "law.csv": law_table(design.law),
        "mould.csv": mould_table(design, whole),
    }


def load(folder: str | Path) -> Design:
    """Return the design in a result folder; it equals the saved design bit for bit.

    Only ``design.json`` is read. If this file was changed, law, misfit and status are recomputed from its
    heights. The notes of the design name the files that were changed.

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
    return load_compared(folder)[0]


def load_compared(folder: str | Path) -> tuple[Design, tuple[Note, ...]]:
    """Return the design in a result folder, and notes on changes in the folder since it was written."""
    path, record = read_result(folder)
    with damaged(path):
        design = from_record(record.get("design"), "design")
        refuse_if(not isinstance(design, Design), "it holds no design")
        if "cap" not in record["design"]["surface"]:  # of an earlier version: the contact law had the cap
            cap = cap_of(contact_of(design.law.model))
            parts = {name: getattr(design, name).replaced(cap=cap) for name in ("surface", "template")}
            design = replace(design, **parts)
    return compared(design, Path(folder))


def stored_hardness(folder: str | Path) -> float | None:
    """Return the hardness [MPa] that the specification of a result folder states, or None."""
    path, record = read_result(folder)
    with damaged(path):
        specification = record["specification"] or {}
        hardness = specification.get("hardness")
        return None if hardness is None else check.number("specification.hardness", hardness, above=0.0)


def same_design(folder: str | Path) -> Callable[[], None]:
    """Return a function that raises InvalidInput if the design in the folder has been replaced meanwhile."""
    path = Path(folder).absolute() / "design.json"

    def current() -> str:
        return digest(path) if path.is_file() else ""

    before = current()

    def still() -> None:
        refuse_if(current() != before, f"{path} was replaced in the meantime; run the command again")

    return still


def read_result(folder: str | Path) -> tuple[Path, dict[str, Any]]:
    """Return the path and the content of design.json in a result folder."""
    if os.path.isfile(folder):
        instead = f", here {file_label(Path(folder).parent)}" if Path(folder).name == "design.json" else ""
        raise InvalidInput(f"{file_label(folder)} is a file; name a result folder of metafem{instead}")
    path = Path(folder) / "design.json"
    remedy = "name a result folder of metafem"
    if earlier := earlier_result(Path(folder).absolute()):
        remedy = (
            f"a run was stopped while it replaced the folder, which is complete as {earlier}; rename that"
        )
    record = read_record(path, f"no such file; {remedy}")
    if not isinstance(record, dict) or record.get("format") != FORMAT:
        raise InvalidInput(f"{file_label(path)} is not a design of this version of metafem ({FORMAT})")
    return path, record


def _record(
    design: Design, specification: Specification | None, part: Part | None, options: PartOptions
) -> dict[str, Any]:
    kept = tuple(note for note in design.notes if not isinstance(note, FolderNote))
    return {
        "format": FORMAT,
        "versions": versions(),
        "specification": None
        if specification is None
        else {
            "sha256": specification.sha256,
            "seed": specification.seed,
            "alignment_height": specification.part.alignment_height,
            "hardness": specification.hardness,
            "model": to_record(specification.model),
            "text": specification.text,
        },
        "part": None if part is None else part.record(),
        "notes": [note.text for note in part_notes(part)],
        "design": to_record(replace(design, notes=kept)),
    }


def versions() -> dict[str, str]:
    """Return the versions of Python and of the libraries that affect the numbers of a design."""
    found = {"python": platform.python_version()}
    for name in ("metafem", "numpy", "scipy", "numba", "meshio"):
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # metafem itself, if it runs from its sources
            found[name] = "not installed"
    return found
