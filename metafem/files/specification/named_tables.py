"""Tables named in a specification."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from metafem._given import printable, shown
from metafem.errors import InvalidInput
from metafem.files.reading import TABLE, file_label, read_bytes
from metafem.files.samples import COLUMNS, TARGET, columns_of, samples_of
from metafem.files.units import converted

# Files of a design in its result folder, which also holds a copy of the table.
RESULT_FILES = frozenset(
    {
        *("design.json", "heights.csv", "law.csv", "mould.csv", "surface.vtu", "spec.toml", "report.html"),
        *("block.stl", "block.3mf", "block.obj", "mould.stl", "mould.3mf", "mould.obj", "mould.svg"),
    }
)

# Studies of a design, each in its file NAME.nc of the folder.
STUDIES = (
    *("interaction", "fidelity", "manufacturing", "misalignment", "uncertainty", "combined"),
    "measured",  # the comparison with measured laws
    "explained",  # the errors of the part that explain the difference
)

# All files of a result folder.
RESERVED = RESULT_FILES | {f"{name}.nc" for name in STUDIES}


# Sections that may name a table.
PLACES = (("target",), ("contact",), ("contact", "cap"))

# The key of a file with its value, one of TOML's four kinds of strings.
FILE_KEY = re.compile(
    r"""(\bfile["']?[ \t]*=[ \t]*)(\"{3}.*?\"{3}|'{3}.*?'{3}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')""", re.DOTALL
)

# Separators of folders, and of drives and files, on any system.
SEPARATORS = re.compile(r"[/\\:]")

# A valid line.
EXAMPLE = 'file = "wanted.csv"'

# Longest name of a table [bytes]: file systems allow 255, and the name of its copy may begin with "wanted-".
LONGEST = 240


# Returns the content of the table named in a key, and its name in errors.
Source = Callable[[str, str], tuple[str, bytes]]


def in_folder(folder: Path) -> Source:
    """Return the source of tables that are files, with names relative to a folder."""
    return lambda _, name: (file_label(folder / name), read_bytes(folder / name, TABLE))


def among(tables: Mapping[str, bytes]) -> Source:
    """Return the source of tables that are given by their names."""

    def content(key: str, name: str) -> tuple[str, bytes]:
        if name not in tables:
            known = ", ".join(printable(other, 60) for other in tables) or "none"
            words = f"names a table that is not loaded (loaded: {known})"
            raise InvalidInput(words, key=key, value=shown(name))
        if len(tables[name]) > TABLE:
            raise InvalidInput(f"is larger than {TABLE / 2**20:g} MiB", key=key, value=shown(name))
        return file_label(name), tables[name]

    return content


def with_tables(text: str, table: dict[str, Any], source: Source) -> tuple[dict[str, Any], dict[str, bytes]]:
    """Return a specification with the columns of tables in place of keys `file`, and the files to store.

    The first line of a table names its columns as quantity_unit. The result folder contains the specification
    as spec.toml and the tables, so that the design can be repeated.
    """
    kept: dict[str, bytes] = {}
    for place in PLACES:
        section: Any = table
        for key in place:
            section = section.get(key) if isinstance(section, dict) else None
        if isinstance(section, dict) and section.get("kind") in tuple(COLUMNS) and "file" in section:
            filled, content = with_columns(".".join(place), section, source)
            table = _replaced(table, place, filled)
            copy = _copy_name(section["file"], kept)
            if copy != section["file"]:
                text = _naming_copy(text, place, section, copy)
            kept[copy] = content
    return table, {"spec.toml": text.encode("utf-8"), **kept}


def with_columns(label: str, section: dict[str, Any], source: Source) -> tuple[dict[str, Any], bytes]:
    """Return a section with the columns of its table in place of the key `file`, and the file's bytes."""
    key, name, columns = f"{label}.file", section["file"], COLUMNS[section["kind"]]
    if not isinstance(name, str):
        raise InvalidInput("must be a text", key=key, value=shown(name), example=EXAMPLE)
    _refuse_no_file(key, name)
    rest = {key: value for key, value in section.items() if key != "file"}
    twice = sorted(rest.keys() & {*columns.units, *columns.plain})
    if twice:
        words = f"and {label}.{twice[0]} both give the {columns.what}; keep one"
        raise InvalidInput(words, key=key)
    try:
        title, content = source(key, name)
        entries = samples_of(title, content) if columns is TARGET else columns_of(title, content, columns)
    except InvalidInput as error:
        raise (error if error.key == key else InvalidInput(f"cannot be used: {error}", key=key)) from None
    return {**rest, **entries}, content


def _refuse_no_file(key: str, name: str) -> None:
    """Refuse a name of a table that is not a valid name of a file on every system."""
    last = SEPARATORS.split(name)[-1]
    wrong = ""
    if last.strip(" .") == "":
        wrong = "does not name a file"
    elif not name.isprintable():
        wrong = "holds an unprintable character"
    elif len(last.encode("utf-8")) > LONGEST:
        wrong = f"has {len(last.encode('utf-8'))} bytes; at most {LONGEST} are allowed"
    if wrong:
        raise InvalidInput(wrong, key=key, value=f'"{printable(name, 60)}"', example=EXAMPLE)


def _replaced(table: dict[str, Any], place: tuple[str, ...], section: dict[str, Any]) -> dict[str, Any]:
    """Return a copy of a table with another section at a place."""
    inner = section if len(place) == 1 else _replaced(table[place[0]], place[1:], section)
    return {**table, place[0]: inner}


def _copy_name(name: str, taken: Collection[str]) -> str:
    """Return the name of the copy in a result folder: not hidden, and different from all other files."""
    copy, used = SEPARATORS.split(name)[-1], {each.casefold() for each in taken} | RESERVED
    while copy.casefold() in used or copy.startswith("."):
        copy = f"wanted-{copy.lstrip('.')}"
    return copy


def _naming_copy(text: str, place: tuple[str, ...], section: dict[str, Any], copy: str) -> str:
    """Return the text of a specification with the name of a table's copy, and a comment on it."""
    name = section["file"]
    wanted = _replaced(tomllib.loads(text.removeprefix("\ufeff")), place, {**section, "file": copy})
    newline = "\r\n" if "\r\n" in text else "\n"
    comment = f"# The design read {json.dumps(name, ensure_ascii=False)}; {copy} is a copy of it.{newline}"
    for found in FILE_KEY.finditer(text):
        line = text.rfind("\n", 0, found.start()) + 1
        value = json.dumps(copy, ensure_ascii=False)  # a text of JSON is valid in TOML
        new = f"{text[:line]}{comment}{text[line : found.start(2)]}{value}{text[found.end(2) :]}"
        with suppress(tomllib.TOMLDecodeError):  # it was in a text or a comment
            if tomllib.loads(new.removeprefix("\ufeff")) == wanted:
                return new
    words = f'cannot be renamed to its copy; write file = "{name}" on a line of its own'
    raise InvalidInput(words, key=f"{'.'.join(place)}.file", value=f'"{name}"')


def measured_pairs(path: str | Path) -> tuple[list[float], list[float]]:
    """Return the loads and friction forces [N] of a table with increasing loads."""
    samples = samples_of(file_label(path), read_bytes(path, TABLE))
    if "load" not in samples or "friction_force" not in samples:
        raise InvalidInput(f"{printable(str(path))} must hold forces; name its columns {TARGET.example}")
    load, force = ([converted(text, "N") for text in samples[name]] for name in ("load", "friction_force"))
    return load, force
