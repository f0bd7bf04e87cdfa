"""List of the files that metafem wrote into a result folder; no others are ever replaced."""

from __future__ import annotations

import hashlib
import os
import re
import stat
from collections.abc import Mapping
from pathlib import Path

from metafem.errors import InvalidInput
from metafem.files.reading import read_record

# A hidden file of a result folder: lines of "sha256  name" for every file that metafem wrote there.
MANIFEST = ".metafem-files"

# First member of a design.json; a folder with such a file is a result folder.
FORMAT = "metafem design 1"

# Hashes under which metafem wrote each name; a name written twice has two.
Hashes = Mapping[str, frozenset[str]]


def digest(path: Path) -> str:
    """Return the sha256 of a file, in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def unchanged(path: Path, hashes: frozenset[str]) -> bool:
    """Whether this is a regular file, not a link, with one of these hashes."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode) and bool(hashes) and digest(path) in hashes
    except FileNotFoundError:
        return False


def manifest_text(hashes: Hashes) -> str:
    """Return the text of a manifest."""
    return "".join(f"{each}  {name}\n" for name in sorted(hashes) for each in sorted(hashes[name]))


def written(folder: Path) -> Hashes:
    """Return the files of a folder by its manifest; without one, only a design.json is known."""
    try:
        text = (folder / MANIFEST).read_text(encoding="utf-8", errors="replace")
    except FileNotFoundError:
        return (
            {"design.json": frozenset({digest(folder / "design.json")})} if is_result_folder(folder) else {}
        )
    found: dict[str, frozenset[str]] = {}
    for each, name in re.findall(r"([0-9a-f]{64})  (.+)", text):
        found[name] = found.get(name, frozenset()) | {each}
    return found


def is_result_folder(folder: Path) -> bool:
    """Whether the folder holds a design.json of metafem."""
    try:
        record = read_record(folder / "design.json")
    except InvalidInput:
        return False
    return isinstance(record, dict) and record.get("format") == FORMAT
