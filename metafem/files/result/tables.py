"""Tables of a result folder as CSV; design.json holds the same numbers to the bit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import chain, repeat
from pathlib import Path

import numpy as np

from metafem._given import Names, printable
from metafem.errors import InvalidInput, named
from metafem.files.csv_rows import Table, read_table
from metafem.files.part.mirror import mirrored
from metafem.files.units import factor
from metafem.inversion import Design
from metafem.prediction import FrictionLaw, tables
from metafem.surface import Block, Friction, Material, Surface

COLUMNS = ("x", "y", "height", "radius")

# Columns of a table of metafem that are not needed to read it: the site, and those of standard deviations.
SITE, DEVIATION = "site", "sd_"

# Digits of a number in a table: without the rounding of sums in the sixteenth.
DIGITS = 13


def heights_table(design: Design) -> str:
    """Return the table of the summits: site in the template, position, height and radius."""
    surface = design.surface
    rows = zip(design.sites.tolist(), *_columns(surface), strict=True)
    return csv((SITE, "x_mm", "y_mm", "height_mm", "radius_mm"), rows)


def law_table(law: FrictionLaw) -> str:
    """Return the friction law, with friction forces where the surface has a Friction."""
    columns = tables.columns(law.quantities(), without=tables.UNWRITTEN)
    return csv(tuple(columns), zip(*(column.tolist() for column in columns.values()), strict=True))


def is_law_table(content: bytes) -> bool:
    """Whether a file is a table of `law_table`, by its first line."""
    return content.startswith(b"load_N,area_mm2,separation_mm,rescaled_load_mm2,rescaled_friction_mm2")


def mould_table(design: Design, part: Surface | None = None) -> str:
    """Return the table of the holes of the mould, one for each summit, of kind asperity or alignment.

    Holes are numbered as in ``mould.svg``, sites as in ``heights.csv``. The depth of a hole below the face of
    the mould is the height of its summit, the radius of the tool that of the summit. The mould is seen from
    its open face, as on the milling machine: x is mirrored.

    `part` holds the asperities of the design and, after them, those of the alignment; default: none of these.
    """
    holes = part or design.surface
    holes = holes.replaced(position=mirrored(holes.position))
    sites = chain(design.sites.tolist(), repeat(""))
    rows = (
        (number, "alignment" if site == "" else "asperity", site, *hole)
        for number, (site, hole) in enumerate(zip(sites, zip(*_columns(holes), strict=True), strict=False), 1)
    )
    return csv(("number", "kind", "site", "x_mm", "y_mm", "depth_mm", "tool_radius_mm"), rows)


def read_surface(
    path: str | Path,
    material: Material,
    radius: float | None = None,
    friction: Friction | None = None,
    block: Block | None = None,
) -> Surface:
    """Read a surface from a table of summits.

    Parameters
    ----------
    path : str or Path
        CSV whose first line names its columns as quantity_unit: x, y, height and radius in any order
        and any unit of length, as ``x_mm,y_mm,height_um``. Other columns are not read, which
        `metafem.progress` reports; lines that begin with ``#`` are skipped. In a table separated by
        semicolons or tabulators commas are decimals.
    material : Material
    radius : float, optional
        Radius [mm] of all summits, for a table without such a column.
    friction : Friction, optional
    block : Block, optional

    Returns
    -------
    Surface

    Raises
    ------
    InvalidInput
        If the file cannot be read, is empty or lacks a column, for an entry that is not a finite number, and
        for a surface that cannot be; names the line and the column.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "heights.csv")
    ...     _ = path.write_text("x_mm,y_mm,height_um\\n0,0,120\\n1.5,0,94.3\\n")
    ...     read_surface(path, Material(1.36), radius=0.526).height
    array([0.12  , 0.0943])
    """
    table = read_table(path, "x_mm,y_mm,height_um")
    columns = _quantities(table)
    if "radius" in columns and radius is not None:
        title = table.header[columns["radius"][0]]
        raise InvalidInput(f"{table.name} has the column {title}, and --radius is given too; leave one out")
    missing = [name for name in COLUMNS if name not in columns and (name != "radius" or radius is None)]
    if missing:
        needed = ", ".join(f"{name}_um" if name in ("height", "radius") else f"{name}_mm" for name in missing)
        instead = '; for one radius of all summits add --radius "526 um"' if missing == ["radius"] else ""
        raise InvalidInput(
            f"{table.name} lacks the columns {needed} (or in another unit); it has "
            f"{printable(', '.join(table.header))}{instead}"
        )
    known = {SITE, *(title for title in table.header if title.startswith(DEVIATION))}
    table.report_unread(known | {table.header[i] for i, _ in columns.values()})
    entries = table.entries()
    if not entries:
        raise InvalidInput(f"{table.name} names columns but holds no summit")
    values = {
        name: np.array([float(table.number(line, i, row[i]) * size) for line, row in entries])
        for name, (i, size) in columns.items()
    }
    titles = {name: table.header[i] for name, (i, _) in columns.items()}
    names = Names(
        places=[f"{table.name}, line {line}" for line, _ in entries],
        names={"radius": "--radius", **titles, "position": f"{titles['x']}, {titles['y']}"},
        units={name: ("", float(size)) for name, (_, size) in columns.items()},
    )
    with named(names):
        position = np.column_stack([values["x"], values["y"]])
        radii = values.get("radius", radius or 0.0)
        return Surface(position, values["height"], radii, material, friction, block)


def _quantities(table: Table) -> dict[str, tuple[int, Fraction]]:
    """Return column number and millimetres per unit of each known quantity."""
    columns: dict[str, tuple[int, Fraction]] = {}
    for column, title in enumerate(table.header):
        name, _, unit = title.partition("_")
        if name not in COLUMNS:
            continue
        if not unit:
            raise InvalidInput(
                f"{table.name}: column {title} needs a unit in its name; write {title}_mm or {title}_um"
            )
        if name in columns:
            raise InvalidInput(f"{table.name}: {name} is in two columns; keep one")
        try:
            columns[name] = (column, factor(unit, "mm"))
        except InvalidInput as error:
            raise InvalidInput(
                f"{table.name}: column {printable(title, 40)} {error}; write {name}_mm or {name}_um"
            ) from None
    return columns


def _columns(surface: Surface) -> list[list[float]]:
    x, y = surface.position.T
    return [column.tolist() for column in (x, y, surface.height, surface.radius)]


def csv(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table as text, whose numbers have at most `DIGITS` digits."""
    lines = [",".join(header), *(",".join(_entry(value) for value in row) for row in rows)]
    return "\n".join(lines) + "\n"


def _entry(value: object) -> str:
    """Return an entry: a number has the shortest text with at most `DIGITS` digits."""
    return str(float(f"{value:.{DIGITS}g}")) if isinstance(value, float) else str(value)
