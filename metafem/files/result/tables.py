"""Tables of a result folder as CSV; design.json holds the same numbers to the bit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import repeat
from pathlib import Path

import numpy as np

from metafem._given import ErrorNames, error_names, printable
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.files.csv_rows import Table, read_table
from metafem.files.units import factor
from metafem.inversion import Design
from metafem.prediction import FrictionLaw, tables
from metafem.surface import Block, Friction, Material, Surface

__all__ = ["heights_table", "is_law_table", "law_table", "mould_table", "read_heights", "read_surface"]

COLUMNS = ("x", "y", "height", "radius")

# That of a table of metafem which says nothing about a summit.
SITE = "site"

# Digits of a number in a table: all that is meant, and not the rounding of sums in the sixteenth.
DIGITS = 13


def heights_table(design: Design) -> str:
    """Return the summits: site in the template, place, height and radius."""
    surface = design.surface
    rows = zip(design.sites.tolist(), *_columns(surface), strict=True)
    return _csv((SITE, "x_mm", "y_mm", "height_mm", "radius_mm"), rows)


def law_table(law: FrictionLaw) -> str:
    """Return the friction law, with friction forces where the surface has a Friction."""
    columns = tables.columns(law, without=tables.UNWRITTEN)
    return _csv(tuple(columns), zip(*(column.tolist() for column in columns.values()), strict=True))


def is_law_table(content: bytes) -> bool:
    """Whether a file is a table of `law_table`, by its first line."""
    return content.startswith(b"load_N,area_mm2,separation_mm,rescaled_load_mm2,rescaled_friction_mm2")


def mould_table(design: Design, alignment: Surface | None = None) -> str:
    """Return the holes of the negative mould, one a summit, of kind asperity or alignment.

    The number of a hole is that in ``mould.svg``, the site that of the asperity in ``heights.csv``.
    The depth of a hole below the mould's face is the height of its summit above the base plane, the
    tool's radius that of the summit. The mould is seen from its open face, as on the milling machine:
    the part lies face down on it, so that x is mirrored, x -> -x.
    """
    rows: list[tuple[object, ...]] = []
    for kind, part, sites in (
        ("asperity", design.surface, design.sites.tolist()),
        ("alignment", alignment, repeat("")),
    ):
        if part is not None:
            # 0.0 - x, as -x would write a summit on the axis as -0.0
            rows += (
                (kind, site, 0.0 - x, y, h, r)
                for site, x, y, h, r in zip(sites, *_columns(part), strict=False)
            )
    numbered = ((number, *row) for number, row in enumerate(rows, 1))
    return _csv(("number", "kind", "site", "x_mm", "y_mm", "depth_mm", "tool_radius_mm"), numbered)


def read_heights(path: str | Path, radius: float | None = None) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Read places, heights and radii of summits from a table.

    Parameters
    ----------
    path : str or Path
        CSV whose first line names its columns as quantity_unit: x, y, height and radius in any order
        and any unit of length, as ``x_mm,y_mm,height_um``. Other columns are not read, which
        `metafem.progress` reports; lines that begin with ``#`` are skipped. In a table separated by
        semicolons or tabulators commas are decimals.
    radius : float, optional
        Radius [mm] of all summits; for a table without such a column.

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
    found = _read(path, radius)
    fixed = np.full(len(found.lines), radius or 0.0)
    return found.position, found.values["height"], found.values.get("radius", fixed)


def read_surface(
    path: str | Path,
    material: Material,
    radius: float | None = None,
    friction: Friction | None = None,
    block: Block | None = None,
) -> Surface:
    """Read a surface from a table as `read_heights` does; errors name lines and columns of the file."""
    found = _read(path, radius)
    with error_names(found.words):
        radii = found.values.get("radius", radius or 0.0)
        return Surface(found.position, found.values["height"], radii, material, friction, block)


@dataclass(frozen=True)
class _Summits:
    """What a table of heights holds, and how errors call it."""

    values: dict[str, FloatArray]
    lines: tuple[int, ...]
    words: ErrorNames

    @property
    def position(self) -> FloatArray:
        return np.column_stack([self.values["x"], self.values["y"]])


def _read(path: str | Path, radius: float | None) -> _Summits:
    table = read_table(path, "x_mm,y_mm,height_um")
    found = _found(table)
    if "radius" in found and radius is not None:
        title = table.header[found["radius"][0]]
        raise InvalidInput(f"{table.name} has the column {title}, and --radius is given too; leave one out")
    missing = [name for name in COLUMNS if name not in found and (name != "radius" or radius is None)]
    if missing:
        wanted = ", ".join(f"{name}_um" if name in ("height", "radius") else f"{name}_mm" for name in missing)
        instead = '; for one radius of all summits add --radius "526 um"' if missing == ["radius"] else ""
        has = printable(", ".join(table.header))
        raise InvalidInput(
            f"{table.name} lacks the columns {wanted} (or in another unit); it has {has}{instead}"
        )
    table.report_unread({SITE, *(table.header[i] for i, _ in found.values())})
    entries = table.entries()
    if not entries:
        raise InvalidInput(f"{table.name} names columns but holds no summit")
    values = {
        name: np.array([float(table.number(line, i, row[i]) * size) for line, row in entries])
        for name, (i, size) in found.items()
    }
    titles = {name: table.header[i] for name, (i, _) in found.items()}
    words = ErrorNames(
        file=table.name,
        lines=tuple(line for line, _ in entries),
        names={"radius": "--radius", **titles, "position": f"{titles['x']}, {titles['y']}"},
        units={name: ("", float(size)) for name, (_, size) in found.items()},
    )
    return _Summits(values, words.lines, words)


def _found(table: Table) -> dict[str, tuple[int, Fraction]]:
    """Return column number and millimetres per unit of each known quantity."""
    found: dict[str, tuple[int, Fraction]] = {}
    for column, title in enumerate(table.header):
        name, _, unit = title.partition("_")
        if name not in COLUMNS:
            continue
        if not unit:
            raise InvalidInput(
                f"{table.name}: column {title} needs a unit in its name; write {title}_mm or {title}_um"
            )
        if name in found:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        try:
            found[name] = (column, factor(unit, "mm"))
        except InvalidInput as error:
            called = printable(title, 40)
            raise InvalidInput(
                f"{table.name}: column {called} {error}; write {name}_mm or {name}_um"
            ) from None
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
