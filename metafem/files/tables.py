"""Tables of a result folder as CSV; design.json holds the same numbers to the bit."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.files.units import decimal, factor
from metafem.inversion import Design
from metafem.law import FrictionLaw
from metafem.surface import Surface

__all__ = ["heights_table", "law_table", "mould_table", "read_heights"]

COLUMNS = ("x", "y", "height", "radius")

# Digits of a number in a table: all that is meant, and not the rounding of sums in the sixteenth.
DIGITS = 13


def heights_table(design: Design) -> str:
    """Return the summits: site in the template, place, height and radius."""
    surface = design.surface
    rows = zip(design.sites.tolist(), *_columns(surface), strict=True)
    return _csv(("site", "x_mm", "y_mm", "height_mm", "radius_mm"), rows)


def law_table(law: FrictionLaw) -> str:
    """Return the friction law, with friction forces where the surface has a Friction."""
    columns = {
        "load_N": law.load,
        "area_mm2": law.area,
        "separation_mm": law.separation,
        "rescaled_load_mm2": law.rescaled_load,
        "rescaled_friction_mm2": law.rescaled_friction,
    }
    if law.friction is not None:
        columns["friction_force_N"] = law.friction_force
    return _csv(tuple(columns), zip(*(column.tolist() for column in columns.values()), strict=True))


def mould_table(surface: Surface, alignment: Surface | None = None) -> str:
    """Return the holes of the negative mould, one a summit, of kind asperity or alignment.

    The depth of a hole below the mould's face is the height of its summit above the base plane, the
    tool's radius that of the summit. The mould is seen from its open face, as on the milling machine:
    the part lies face down on it, so that x is mirrored, x -> -x.
    """
    rows: list[tuple[str, float, float, float, float]] = []
    for kind, part in (("asperity", surface), ("alignment", alignment)):
        if part is not None:
            # 0.0 - x, as -x would write a summit on the axis as -0.0
            rows += ((kind, 0.0 - x, y, h, r) for x, y, h, r in zip(*_columns(part), strict=True))
    return _csv(("kind", "x_mm", "y_mm", "depth_mm", "tool_radius_mm"), rows)


def read_heights(path: str | Path, radius: float | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Read places, heights and radii of summits from a table.

    Parameters
    ----------
    path : str or Path
        CSV whose first line names its columns as quantity_unit: x, y, height and radius in any order
        and any unit of length, as ``x_mm,y_mm,height_um``; other columns are left aside.
    radius : float, optional
        Radius [mm] of all summits where the table has no such column.

    Returns
    -------
    position, height, radius : ndarray, (n, 2), (n,), (n,)
        [mm]

    Raises
    ------
    InvalidInput
        If the file cannot be read, is empty or lacks a column, or for an entry that is not a finite
        number; names the row.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "heights.csv")
    ...     _ = path.write_text("x_mm,y_mm,height_um\\n0,0,120\\n1.5,0,94.3\\n")
    ...     position, height, radius = read_heights(path, radius=0.526)
    >>> height
    array([0.12  , 0.0943])
    """
    rows = read_rows(Path(path))
    if not rows:
        raise InvalidInput(f"{path} is empty; its first line must name columns, as x_mm,y_mm,height_um")
    header = [name.strip() for name in rows[0][1]]
    if len(header) == 1:
        raise InvalidInput(f"{path} has one column, {header[0]:.60}; separate its columns by commas")
    found = _found(path, header)
    missing = [
        name for name in COLUMNS if name not in found and not (name == "radius" and radius is not None)
    ]
    if missing:
        wanted = ", ".join(f"{name}_um" if name in ("height", "radius") else f"{name}_mm" for name in missing)
        instead = '; for one radius of all summits add --radius "526 um"' if missing == ["radius"] else ""
        raise InvalidInput(
            f"{path} lacks the columns {wanted} (or in another unit); it has {', '.join(header)}{instead}"
        )
    if len(rows) == 1:
        raise InvalidInput(f"{path} names columns but holds no summit")
    values: dict[str, list[float]] = {name: [] for name in found}
    for line, row in rows[1:]:
        if len(row) != len(header):
            raise InvalidInput(
                f"{path}, line {line} has {len(row)} entries; the first line names {len(header)}"
            )
        for name, (column, per_unit) in found.items():
            try:
                values[name].append(float(decimal(row[column].strip()) * per_unit))
            except (ValueError, OverflowError):
                raise InvalidInput(
                    f"{path}, line {line}: {header[column]} = {row[column]!r:.40} is not a finite number"
                ) from None
    if "radius" not in found:
        values["radius"] = [float(radius or 0.0)] * len(values["height"])
    return (
        np.column_stack([values["x"], values["y"]]),
        np.array(values["height"]),
        np.array(values["radius"]),
    )


def read_rows(path: Path) -> list[tuple[int, list[str]]]:
    """Return the lines of a CSV file that hold something, each with its number."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InvalidInput(f"{path}: no such file") from None
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise InvalidInput(f"{path} is not a text in UTF-8") from None
    reader = csv.reader(io.StringIO(text))
    try:
        return [(reader.line_num, row) for row in reader if any(entry.strip() for entry in row)]
    except csv.Error as error:
        raise InvalidInput(f"{path}, line {reader.line_num}: {error}") from None


def _found(path: str | Path, header: list[str]) -> dict[str, tuple[int, Fraction]]:
    """Return column number and millimetres per unit of each known quantity."""
    found: dict[str, tuple[int, Fraction]] = {}
    for column, title in enumerate(header):
        name, _, unit = title.partition("_")
        if name not in COLUMNS:
            continue
        if not unit:
            raise InvalidInput(
                f"{path}: column {title} needs a unit in its name; write {title}_mm or {title}_um"
            )
        if name in found:
            raise InvalidInput(f"{path}: {name} stands in two columns; keep one")
        try:
            found[name] = (column, factor(unit, "mm"))
        except InvalidInput as error:
            raise InvalidInput(f"{path}: column {title} {error}; write {name}_mm or {name}_um") from None
    return found


def _columns(surface: Surface) -> list[list[float]]:
    x, y = surface.position.T
    return [column.tolist() for column in (x, y, surface.height, surface.radius)]


def _csv(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    lines = [",".join(header), *(",".join(_entry(value) for value in row) for row in rows)]
    return "\n".join(lines) + "\n"


def _entry(value: object) -> str:
    """Return the shortest text of a number of `DIGITS` digits, or what else stands in a table."""
    return str(float(f"{value:.{DIGITS}g}")) if isinstance(value, float) else str(value)
