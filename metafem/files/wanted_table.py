"""A wanted law from a table beside the specification."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from metafem.errors import InvalidInput
from metafem.files.tables import read_rows
from metafem.files.units import quantity

# Columns of a wanted law, their units, and the keys that they become.
COLUMNS = {"rescaled_load": "mm^2", "rescaled_friction": "mm^2", "load": "N", "friction_force": "N"}

EXAMPLE = "load_N,friction_force_N"


def with_samples(table: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return a specification with ``target.file`` replaced by the samples that the file holds.

    The first line of the file names its columns as quantity_unit: rescaled_load_mm2 and
    rescaled_friction_mm2, or load_N and friction_force_N (or in other units), and weight if wanted.
    """
    target = table.get("target")
    if not isinstance(target, dict) or target.get("kind") != "sampled" or "file" not in target:
        return table
    name = target["file"]
    if not isinstance(name, str):
        raise InvalidInput(f'target.file = {name!r:.60} must be a text, for example file = "wanted.csv"')
    rest = {key: value for key, value in target.items() if key != "file"}
    twice = sorted(set(rest) & {*COLUMNS, "weight"})
    if twice:
        raise InvalidInput(f"target.file and target.{twice[0]} both give the law; keep one")
    return {**table, "target": {**rest, **_samples(folder / name)}}


def _samples(path: Path) -> dict[str, list[Any]]:
    rows = read_rows(path)
    if len(rows) < 2:
        raise InvalidInput(f"{path} holds no samples; its first line must name columns, as {EXAMPLE}")
    header = [title.strip() for title in rows[0][1]]
    found: dict[str, list[Any]] = {}
    for column, title in enumerate(header):
        name, _, unit = title.rpartition("_")
        if name not in COLUMNS and title != "weight":
            continue
        for line, row in rows[1:]:
            if len(row) != len(header):
                raise InvalidInput(
                    f"{path}, line {line} has {len(row)} entries; the first names {len(header)}"
                )
            value, key = row[column].strip(), f"{path}, line {line}: {title}"
            if title == "weight":
                found.setdefault(title, []).append(quantity(key, value, "1"))
            else:  # checked here, where the line is known; read again with the specification
                quantity(key, f"{value} {unit}", COLUMNS[name])
                found.setdefault(name, []).append(f"{value} {unit}")
    return found
