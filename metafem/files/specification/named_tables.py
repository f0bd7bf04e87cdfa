"""Tables that a specification names: reading, and copies in the result folder."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from metafem._given import printable, shown
from metafem.errors import InvalidInput, refuse_if
from metafem.files.laws import COLUMNS, columns_of
from metafem.files.reading import TABLE, file_label, read_bytes
from metafem.files.tables import table_of

# Names of the files of a design in its result folder, which also holds copies of the tables.
RESULT_FILES = frozenset(
    {
        *("design.json", "heights.csv", "law.csv", "mould.csv", "surface.vtu", "spec.toml", "report.html"),
        *("block.stl", "mould.stl"),
    }
)

# Names of the studies of a design; each is stored in the result folder as NAME.nc.
STUDIES = (
    *("interaction", "fidelity", "manufacturing", "misalignment", "uncertainty"),
    "measured",  # the comparison with measured laws
    "explained",  # the errors of the part that explain the difference
)

# Names in a result folder that a copy of a table must not have.
RESERVED = RESULT_FILES | {f"{name}.nc" for name in STUDIES}


# Sections whose key `file` may name a table.
PLACES = (("target",), ("cap",), ("contact",))

# The key `file` and its value, which is one of TOML's four kinds of strings.
FILE_KEY = re.compile(
    r"""(\bfile["']?[ \t]*=[ \t]*)(\"{3}.*?\"{3}|'{3}.*?'{3}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')""", re.DOTALL
)

# Separators in the path of a file on any operating system.
SEPARATORS = re.compile(r"[/\\:]")

# A valid line of a specification, for errors.
EXAMPLE = 'file = "wanted.csv"'

# Longest name of a table [bytes]. File systems allow 255, and the name of the copy may begin with "wanted-".
LONGEST = 240


# A function of a key and of the name of its table: it returns the table's name in errors, and its content.
Source = Callable[[str, str], tuple[str, bytes]]


def in_folder(folder: Path) -> Source:
    """Return a source that reads tables from files, with paths relative to a folder."""
    return lambda _, name: (file_label(folder / name), read_bytes(folder / name, TABLE))


def among(tables: Mapping[str, bytes]) -> Source:
    """Return a source that finds tables by name in a mapping."""

    def content(key: str, name: str) -> tuple[str, bytes]:
        known = ", ".join(printable(other, 60) for other in tables) or "none"
        words = f"names a table that is not loaded (loaded: {known})"
        refuse_if(name not in tables, words, key=key, value=shown(name))
        larger = f"is larger than {TABLE / 2**20:g} MiB"
        refuse_if(len(tables[name]) > TABLE, larger, key=key, value=shown(name))
        return file_label(name), tables[name]

    return content


def with_tables(text: str, table: dict[str, Any], source: Source) -> dict[str, bytes]:
    """Replace each key `file` in `table` by the columns of its table, and return the files to store.

    The files are the specification, spec.toml, and copies of the tables. They are stored in the result
    folder, so that the design can be repeated. The first line of a table names its columns as quantity_unit.
    """
    kept: dict[str, bytes] = {}
    for place in PLACES:
        section = _section(table, place)
        if section.get("kind") in tuple(COLUMNS) and "file" in section:
            name = section["file"]
            content = fill(".".join(place), section, source)
            copy = _copy_name(name, kept)
            if copy != name:
                text = _naming_copy(text, place, name, copy)
            kept[copy] = content
    return {"spec.toml": text.encode("utf-8"), **kept}


def fill(label: str, section: dict[str, Any], source: Source) -> bytes:
    """Replace the key `file` of a section by the columns of its table, and return the content of the file."""
    key, name, columns = f"{label}.file", section.pop("file"), COLUMNS[section["kind"]]
    if not isinstance(name, str):
        raise InvalidInput("must be a text", key=key, value=shown(name), example=EXAMPLE)
    last = SEPARATORS.split(name)[-1]
    wrong = not last.strip(" .") or not name.isprintable() or len(last.encode("utf-8")) > LONGEST
    words = f"must end with the printable name of a file, of at most {LONGEST} bytes"
    refuse_if(wrong, words, key=key, value=f'"{printable(name, 60)}"', example=EXAMPLE)
    twice = sorted(section.keys() & {*columns.units, *columns.plain})
    words = f"and {label}.{', '.join(twice)} both give the points; keep one"
    refuse_if(twice, words, key=key)
    try:
        title, content = source(key, name)
        found = columns_of(table_of(title, content), section["kind"])
        section |= {key: list(column) for key, column in found.items()}
    except InvalidInput as error:
        raise (error if error.key == key else InvalidInput(f"cannot be used: {error}", key=key)) from None
    return content


def _section(table: Any, place: tuple[str, ...]) -> dict[str, Any]:
    """Return the section with the keys `place`; it is empty if the specification has no such section."""
    for key in place:
        table = table.get(key) if isinstance(table, dict) else None
    return table if isinstance(table, dict) else {}


def _copy_name(name: str, taken: Collection[str]) -> str:
    """Return the name of a table's copy; it is not hidden and differs from all names in the result folder."""
    copy, used = SEPARATORS.split(name)[-1], {each.casefold() for each in taken} | RESERVED
    while copy.casefold() in used or copy.startswith("."):
        copy = f"wanted-{copy.lstrip('.')}"
    return copy


def _naming_copy(text: str, place: tuple[str, ...], name: str, copy: str) -> str:
    """Return the text of a specification that names the copy of a table, with a comment on the original."""
    wanted = tomllib.loads(text.removeprefix("\ufeff"))
    _section(wanted, place)["file"] = copy
    newline = "\r\n" if "\r\n" in text else "\n"
    comment = f"# The design read {json.dumps(name, ensure_ascii=False)}; {copy} is a copy of it.{newline}"
    for found in FILE_KEY.finditer(text):
        line = text.rfind("\n", 0, found.start()) + 1
        value = json.dumps(copy, ensure_ascii=False)  # a JSON string is valid in TOML
        new = f"{text[:line]}{comment}{text[line : found.start(2)]}{value}{text[found.end(2) :]}"
        with suppress(tomllib.TOMLDecodeError):  # a match within a text can make the result invalid
            if tomllib.loads(new.removeprefix("\ufeff")) == wanted:
                return new
    words = f'cannot be renamed to its copy; write file = "{name}" on a line of its own'
    raise InvalidInput(words, key=f"{'.'.join(place)}.file", value=f'"{name}"')
