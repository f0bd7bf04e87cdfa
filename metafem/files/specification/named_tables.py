"""Tables that a specification names."""

from __future__ import annotations

import json
import re
import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

from metafem._given import printable, shown
from metafem.errors import InvalidInput
from metafem.files.csv_rows import Table, read_table
from metafem.files.units import converted, factor

# Columns of a target law, which are also keys of a specification, and their units.
COLUMNS = {"rescaled_load": "mm^2", "rescaled_friction": "mm^2", "load": "N", "friction_force": "N"}

# Pairs of columns that define a law.
PAIRS = ({"rescaled_load", "rescaled_friction"}, {"load", "friction_force"})

EXAMPLE = "load_N,friction_force_N"

# Files of a design in its result folder, which also holds a copy of the table.
RESULT_FILES = frozenset(
    {
        *("design.json", "heights.csv", "law.csv", "mould.csv", "surface.vtu", "spec.toml", "report.html"),
        *("block.stl", "block.3mf", "block.obj", "mould.stl", "mould.3mf", "mould.obj", "mould.svg"),
    }
)

# Studies of a design, each in its file NAME.nc of the folder.
STUDIES = ("interaction", "fidelity", "manufacturing", "misalignment", "uncertainty", "combined")

# All files of a result folder.
RESERVED = RESULT_FILES | {f"{name}.nc" for name in STUDIES}


# The key of a file with its value, one of TOML's four kinds of strings.
FILE_KEY = re.compile(
    r"""(\bfile["']?[ \t]*=[ \t]*)(\"{3}.*?\"{3}|'{3}.*?'{3}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')""", re.DOTALL
)


def with_samples(text: str, table: dict[str, Any], folder: Path) -> tuple[dict[str, Any], dict[str, bytes]]:
    """Return a specification with ``target.file`` replaced by its samples, and the files to keep of it.

    The first line of the file names its columns as quantity_unit: rescaled_load_mm2 and
    rescaled_friction_mm2, or load_N and friction_force_N (or in other units), and optionally
    weight. The result folder keeps the specification as spec.toml and the table, so that the design can be
    repeated from them.
    """
    target = table.get("target")
    if not isinstance(target, dict) or target.get("kind") != "sampled" or "file" not in target:
        return table, {"spec.toml": text.encode("utf-8")}
    name = target["file"]
    if not isinstance(name, str):
        raise InvalidInput(f'target.file = {shown(name)} must be a text, for example file = "wanted.csv"')
    rest = {key: value for key, value in target.items() if key != "file"}
    twice = sorted(set(rest) & {*COLUMNS, "weight"})
    if twice:
        raise InvalidInput(f"target.file and target.{twice[0]} both give the law; keep one")
    samples, content = _samples(folder / name)
    copy = _copy_name(name)
    if copy != name:
        text = _naming_copy(text, table, copy)
    kept = {"spec.toml": text.encode("utf-8"), copy: content}
    return {**table, "target": {**rest, **samples}}, kept


def _copy_name(name: str) -> str:
    """Return the name of the copy in a result folder: not hidden, and different from all result files."""
    copy = Path(name).name
    while copy.casefold() in RESERVED or copy.startswith("."):
        copy = f"wanted-{copy.lstrip('.')}"
    return copy


def _naming_copy(text: str, table: dict[str, Any], copy: str) -> str:
    """Return the text of a specification whose ``target.file`` is the copy, with a comment that says so."""
    name = table["target"]["file"]
    wanted = {**table, "target": {**table["target"], "file": copy}}
    newline = "\r\n" if "\r\n" in text else "\n"
    comment = f"# The design read {json.dumps(name, ensure_ascii=False)}; {copy} is a copy of it.{newline}"
    for found in FILE_KEY.finditer(text):
        line = text.rfind("\n", 0, found.start()) + 1
        value = json.dumps(copy, ensure_ascii=False)  # a text in JSON is one in TOML
        new = f"{text[:line]}{comment}{text[line : found.start(2)]}{value}{text[found.end(2) :]}"
        with suppress(tomllib.TOMLDecodeError):  # it stood in a text or a comment
            if tomllib.loads(new.removeprefix("\ufeff")) == wanted:
                return new
    raise InvalidInput(
        f'target.file = "{name}" cannot be renamed to its copy; write file = "{name}" on a line of its own'
    )


def _samples(path: Path) -> tuple[dict[str, list[Any]], bytes]:
    """Return the samples of a table by key, as a specification would hold them, and the file's bytes."""
    table = read_table(path, EXAMPLE)
    columns = _columns(table)
    table.report_unread([table.header[i] for i, _ in columns.values()])
    if not table.rows:
        raise InvalidInput(f"{table.name} has no samples below its column names ({EXAMPLE})")
    found: dict[str, list[Any]] = {name: [] for name in columns}
    before: dict[str, float] = {}
    for line, row in table.entries():
        for name, (column, unit) in columns.items():
            value = table.plain(row[column])
            number = float(table.number(line, column, row[column]))
            if name == "weight":
                found[name].append(number)
                continue
            key = f"{table.name}, line {line}: {table.header[column]}"
            # checked here, where the line is known; read again with the specification
            if number <= 0.0:
                raise InvalidInput(f"{key} = {value} must be greater than 0; omit the origin")
            if name in ("load", "rescaled_load"):
                if number <= before.get(name, 0.0):
                    raise InvalidInput(f"{key} = {value} must exceed the load of the previous line")
                before[name] = number
            found[name].append(f"{value} {unit}")
    return found, table.content


def measured_pairs(path: str | Path) -> tuple[list[float], list[float]]:
    """Return the loads and friction forces [N] of a table, whose loads increase."""
    samples, _ = _samples(Path(path))
    if "load" not in samples:
        raise InvalidInput(f"{printable(str(path))} must hold forces; name its columns {EXAMPLE}")
    load, force = ([converted(text, "N") for text in samples[name]] for name in ("load", "friction_force"))
    return load, force


def _columns(table: Table) -> dict[str, tuple[int, str]]:
    """Return index and unit of each column that is read."""
    wanted = f"name its columns {EXAMPLE}, or rescaled_load_mm2,rescaled_friction_mm2"
    found: dict[str, tuple[int, str]] = {}
    for column, title in enumerate(table.header):
        name, _, unit = ("weight", "", "") if title == "weight" else title.rpartition("_")
        if name not in COLUMNS and name != "weight":
            continue
        if name in found:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        if name != "weight":
            try:
                factor(unit, COLUMNS[name])
            except InvalidInput as error:
                raise InvalidInput(f"{table.name}: column {printable(title, 40)} {error}") from None
        found[name] = (column, unit)
    if set(found) - {"weight"} not in PAIRS:
        titles = printable(", ".join(table.header), 120)
        raise InvalidInput(
            f"{table.name} has the columns {titles}; {wanted} (or in other units), and optionally weight"
        )
    return found
