"""The CSV tables and the VTU file of a result folder, with rounded numbers; design.json has all digits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from metafem._validate import IntArray
from metafem.caps import SPHERE, Cap, Caps, Paraboloid, Power, Sphere
from metafem.errors import InvalidInput, refuse_if, shown
from metafem.files.tables import Columns, Table
from metafem.inversion import Design
from metafem.prediction import FrictionLaw, equilibrium
from metafem.surface import Block, Friction, Material, Surface

# Columns of a table of summits. metafem writes the site and standard deviations, but reading needs neither.
COLUMNS = Columns(
    "site,x_mm,y_mm,height_um,radius_um,cap,sd_position_mm,sd_height_mm,sd_radius_mm",
    ("x,y,height",),
    "summit",
    "x_mm,y_mm,height_um,radius_um (or in other units)",
)

# Columns of a law that are omitted from law.csv.
UNWRITTEN = ("friction_coefficient", "approach_mm", "stiffness_N_per_mm", "residual")

# Number of digits in a table; the rounding errors of sums, in the sixteenth digit, do not appear.
DIGITS = 13


def heights_table(surface: Surface, sites: IntArray) -> str:
    """Return the text of heights.csv: site in the template, from 1, position, height, radius and cap."""
    return csv({"site": sites + 1, **_columns(surface)})


def law_table(law: FrictionLaw) -> str:
    """Return the text of law.csv, which has friction forces only if the surface has a Friction."""
    return csv({name: column for name, column in law.columns().items() if name not in UNWRITTEN})


def read_surface(
    path: str | Path | Table,
    material: Material,
    radius: float | None = None,
    friction: Friction | None = None,
    block: Block | None = None,
) -> Surface:
    """Read a surface from a table of summits.

    Parameters
    ----------
    path : str, Path or Table
        Text file whose columns are named as ``x_mm,y_mm,height_um`` or ``x [mm]``. The columns are x, y,
        height and radius, in any order and in any unit of length, and cap: "sphere" (the default),
        "paraboloid" or "power 4 0.5", with exponent and coefficient. Other columns are not read, and
        `metafem.progress` reports them.
    material : Material
    radius : float, optional
        Radius of all summits [mm], for a table without a column radius.
    friction : Friction, optional
        Friction of all asperities.
    block : Block, optional

    Returns
    -------
    Surface

    Raises
    ------
    InvalidInput
        If the file cannot be read, is empty or lacks a column, if an entry is not a finite number, or if the
        surface is impossible. The error states line and column.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "heights.csv")
    ...     _ = path.write_text("x_mm,y_mm,height_um\\n0,0,120\\n1.5,0,94.3\\n")
    ...     read_surface(path, Material(1.36), radius=0.526).height
    array([0.12  , 0.0943])
    """
    entries = COLUMNS.read(path)
    if radius is None and "radius" not in entries.columns:
        hint = '; for one radius of all summits add --radius "526 um"'
        raise COLUMNS.lacking(entries, "radius", hint=hint)
    words = f"{entries.name} has a column radius, and --radius is given too; leave one out"
    refuse_if(radius is not None and "radius" in entries.columns, words)
    position = np.column_stack([entries.numbers("x"), entries.numbers("y")])
    with entries.located():
        radii = entries.numbers("radius") if radius is None else radius
        caps = entries.texts("cap") if "cap" in entries.columns else ["sphere"]
        cap = Caps.of(map(cap_named, caps))
        return Surface(position, entries.numbers("height"), radii, material, friction, block, cap)


def write_surface(design: Design, path: str | Path) -> None:
    """Write a VTU file whose points are the summits, with their contacts at the law's largest load.

    Each point has its site in the template, height and radius [mm], and, under the law's model, its load [N],
    area [mm^2] and contact_radius [mm]; if the caps differ, also the index of its cap.
    """
    import meshio

    surface, law = design.surface, design.law
    state = equilibrium(surface, law.model, load=float(law.load[-1]))
    mesh = meshio.Mesh(
        np.column_stack([surface.position, surface.height]),
        [("vertex", np.arange(surface.count)[:, None])],
        point_data={
            "site": design.sites + 1,
            "height": surface.height,
            "radius": surface.radius,
            **({"cap": surface.cap.index} if isinstance(surface.cap, Caps) else {}),
            "load": state.asperity_load,
            "area": state.asperity_area,
            "contact_radius": np.sqrt(state.asperity_area / np.pi),
        },
    )
    mesh.write(path, file_format="vtu")


def _columns(surface: Surface) -> dict[str, Iterable[object]]:
    x, y = surface.position.T
    found = {"x_mm": x, "y_mm": y, "height_mm": surface.height, "radius_mm": surface.radius}
    return {**found, **caps_column(surface)}


def csv(columns: Mapping[str, Iterable[object]]) -> str:
    """Return the CSV text of a table; its numbers have at most `DIGITS` digits."""
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(map(_entry, row)) for row in rows)]) + "\n"


def _entry(value: object) -> str:
    """Return the text of an entry; a number is written as short as possible, with at most `DIGITS` digits."""
    return str(float(f"{value:.{DIGITS}g}")) if isinstance(value, float) else str(value)


def cap_text(cap: Cap) -> str:
    """Return the text of a cap; that of a profile does not contain its depths.

    Examples
    --------
    >>> cap_text(Power(4))
    'power 4.0 0.5'
    """
    values = f" {cap.exponent!r} {cap.coefficient!r}" if isinstance(cap, Power) else ""
    return type(cap).__name__.lower() + values


def caps_column(surface: Surface) -> dict[str, list[str]]:
    """Return the column of the caps of a table, unless all are spheres."""
    if surface.cap == SPHERE:
        return {}
    return {"cap": [cap_text(surface.cap.one(i)) for i in range(surface.count)]}


def cap_named(text: str) -> Cap:
    """Return the cap of a text.

    Examples
    --------
    >>> cap_named("power 4")
    Power(exponent=4.0, coefficient=0.5)
    """
    kind, *values = text.split() or [""]
    known: dict[str, Callable[..., Cap]] = {"sphere": Sphere, "paraboloid": Paraboloid, "power": Power}
    try:
        return known[kind](*map(float, values))
    except InvalidInput:
        raise
    except (KeyError, TypeError, ValueError):
        words = "must be sphere, paraboloid or power EXPONENT COEFFICIENT; other profiles are in design.json"
        raise InvalidInput(words, key="cap", value=shown(text)) from None
