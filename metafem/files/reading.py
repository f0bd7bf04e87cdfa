"""Reading of files that users name; the type and size of a file are checked first."""

from __future__ import annotations

import codecs
import json
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from metafem._given import printable, shown
from metafem.errors import InvalidInput, refuse_if

# Largest size of each kind of file [bytes]. A specification with a thousand points has 30 kB. A summit takes
# 60 bytes in a table and a site 300 bytes in a record, so that a million summits fit.
SPECIFICATION, TABLE, RECORD = 2**18, 2**26, 2**29


def read_bytes(path: str | Path, most: int, missing: str = "no such file") -> bytes:
    """Return the content of a regular file of at most `most` bytes, or raise InvalidInput."""
    name = file_label(path)
    content = _beginning(path, most + 1, missing)
    larger = f"{name}: is larger than {most / 2**20:g} MiB, the limit for its kind of file"
    refuse_if(len(content) > most, larger)
    return content


def refuse_unreadable(path: str | Path) -> None:
    """Raise InvalidInput unless the path is a regular file that can be opened."""
    _beginning(path, 1, "no such file")


def _beginning(path: str | Path, most: int, missing: str) -> bytes:
    """Return the first bytes of a regular file, at most `most`."""
    name = file_label(path)
    try:
        _refuse_other_kinds(path, name)
        with open(path, "rb") as file:
            return file.read(most)
    except FileNotFoundError:
        raise InvalidInput(f"{name}: {missing}") from None
    except OSError as error:
        raise InvalidInput(f"{name}: cannot be read: {error.strerror}") from None


def _refuse_other_kinds(path: str | Path, name: str) -> None:
    """Raise InvalidInput for a folder, a device or a pipe."""
    try:
        kind = os.stat(path).st_mode
    except (TypeError, ValueError):  # the path has a null character or another invalid character
        raise InvalidInput(f"{shown(path)} is not the name of a file") from None
    what = "a folder" if stat.S_ISDIR(kind) else "a device or a pipe"
    refuse_if(not stat.S_ISREG(kind), f"{name}: cannot be read: it is {what}, not a file")


def file_label(path: object) -> str:
    """Return the name of a file as errors state it, on one line."""
    return printable(str(path), 300)


def decoded(path: str | Path, raw: bytes) -> str:
    """Return the text of a UTF-8 file, without the byte-order mark that it may have."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InvalidInput(
            f"{file_label(path)}: line {line} is not UTF-8; save the file with that encoding"
        ) from None


def text_of_table(path: str | Path, raw: bytes) -> str:
    """Return the text of a table, which spreadsheets write as UTF-8, UTF-16 or Windows-1252."""
    name = file_label(path)
    try:
        if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            text = raw.decode("utf-16")
        else:
            try:
                text = raw.decode("utf-8-sig")
            except UnicodeDecodeError:
                text = raw.decode("cp1252")
    except UnicodeDecodeError:
        raise InvalidInput(f"{name} is not a text; save the table as CSV in UTF-8") from None
    refuse_if("\0" in text, f"{name} is not a text: it holds null characters; save the table as CSV")
    return text


@contextmanager
def damaged(path: str | Path) -> Iterator[None]:
    """Raise InvalidInput, which calls the file damaged, if the body cannot use the content of the file."""
    try:
        yield
    except RecursionError:
        raise InvalidInput(f"{file_label(path)} is damaged: it nests its values too deeply") from None
    except (OSError, ValueError, KeyError, AttributeError) as error:
        raise InvalidInput(f"{file_label(path)} is damaged: {printable(str(error))}") from None


def read_record(path: str | Path, missing: str = "no such file") -> Any:
    """Return the content of a JSON file; raise InvalidInput for any other file."""
    text = decoded(path, read_bytes(path, RECORD, missing))
    with damaged(path):
        return json.loads(text, parse_constant=_refused)


def _refused(constant: str) -> float:
    raise ValueError(f"it holds {constant}, which is not a number")
