"""Files and folders: read up to a largest size, written completely or not at all."""

from __future__ import annotations

import codecs
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from metafem.errors import InvalidInput, printable, refuse_if

# Largest size of each kind of file [bytes]. A specification with a thousand points has 30 kB. A summit takes
# 60 bytes in a table and a site 300 bytes in a record, so that a million summits fit.
SPECIFICATION, TABLE, RECORD = 2**18, 2**26, 2**29

# Names of the studies of a design, each of which is stored as NAME.nc: the last two are the comparison with
# measured laws, and the errors of the part that explain the difference.
STUDIES = ["interaction", "fidelity", "manufacturing", "misalignment", "uncertainty", "measured", "explained"]

# Names in a result folder that a table must not have.
RESERVED = {
    *("design.json", "heights.csv", "law.csv", "mould.csv", "mould.gcode", "surface.vtu", "spec.toml"),
    *("report.html", "block.stl", "mould.stl", *(f"{name}.nc" for name in STUDIES)),
}


@contextmanager
def staged(goal: str | Path, force: bool = False, *, folder: bool = False) -> Iterator[Path]:
    """Yield a path in a hidden folder beside `goal`; what the body writes there becomes `goal` at its end.

    With `folder`, the path is a new folder, otherwise a file that the body creates. If the body fails,
    nothing is left. Raise InvalidInput if `refuse_existing` refuses `goal`, or if it cannot be written.
    """
    refuse_existing(goal, force, folder=folder)
    target = Path(goal).resolve()
    with _reported(target), TemporaryDirectory(prefix=".metafem-", dir=target.parent) as work:
        fresh, earlier = Path(work, "new"), Path(work, "old")
        if folder:
            fresh.mkdir()
        yield fresh
        refuse_existing(goal, force, folder=folder)  # another program may have written there
        if folder and target.exists():
            target.rename(earlier)
        try:
            fresh.replace(target)
        except BaseException:
            if earlier.exists():
                earlier.rename(target)
            raise


def refuse_existing(goal: str | Path, force: bool = False, *, folder: bool = False) -> None:
    """Raise InvalidInput if `staged` would refuse a file or folder; call this function before a long run.

    Without `force`, everything that exists is refused but an empty folder. With `force`, a regular file is
    replaced by a file, and a result folder by a folder.
    """
    target = Path(goal).resolve()
    with _reported(target):
        refuse_if(not target.parent.is_dir(), f"{target.parent} is not a folder; create it first")
        if not target.exists() or (folder and target.is_dir() and not any(target.iterdir())):
            return
        usable = (target / "design.json" if folder else target).is_file()
        kind = "result folder" if folder else "regular file"
        refuse_if(not usable, f"{target} is no {kind} and is in the way; choose another name")
        words = f"{target} exists; choose another name, or replace it with force=True (--force)"
        refuse_if(not force, words)


@contextmanager
def _reported(target: Path) -> Iterator[None]:
    """Raise errors of the operating system as InvalidInput, which names the file or folder `target`."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        raise InvalidInput(f"{target} cannot be written: {reason}; choose another folder") from None


def write_text(path: str | Path, text: str, *, force: bool = False) -> None:
    """Write a text in UTF-8; see `staged`."""
    with staged(path, force) as fresh:
        fresh.write_bytes(text.encode("utf-8"))


def read_bytes(path: str | Path, most: int, missing: str = "no such file") -> bytes:
    """Return the content of a regular file of at most `most` bytes."""
    refuse_unreadable(path, missing)
    with open(path, "rb") as file:
        content = file.read(most + 1)
    words = f"is larger than {most / 2**20:g} MiB, the limit for its kind of file"
    refuse_if(len(content) > most, f"{file_label(path)}: {words}")
    return content


def refuse_unreadable(path: str | Path, missing: str = "no such file") -> None:
    """Raise InvalidInput unless the path is a regular file."""
    refuse_if(not os.path.exists(path), f"{file_label(path)}: {missing}")
    words = "cannot be read: it is a folder, a device or a pipe, not a file"
    refuse_if(not os.path.isfile(path), f"{file_label(path)}: {words}")


def file_label(path: object) -> str:
    """Return the name of a file as errors state it, on one line."""
    return printable(str(path), 300)


def text_of_table(path: str | Path, raw: bytes) -> str:
    """Return the text of a table, which spreadsheets write as UTF-8, UTF-16 or Windows-1252."""
    marked = raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = raw.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("cp1252", errors="replace")
    words = f"{file_label(path)} is not a text: it holds null characters; save the table as CSV"
    refuse_if("\0" in text, words)
    return text
