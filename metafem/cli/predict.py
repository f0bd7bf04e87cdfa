"""`metafem predict`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

import metafem as mf
from metafem._given import printable
from metafem.cli.options import (
    Name,
    Quantity,
    column_option,
    columns_of,
    command,
    force_option,
    json_option,
    model_options,
    option_name,
    quantities,
    refuse_files,
)
from metafem.cli.output import in_columns, notes_data, show
from metafem.cli.progress import loaded, progress
from metafem.errors import refuse_if
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.surface import Surface

# Dimensions of a block, which are options and arguments of `Block`.
SIDES = ("width", "length", "thickness")

# Columns of a law that are printed.
SHOWN = (
    *("load_N", "area_mm2", "separation_mm", "stiffness_N_per_mm", "friction_force_N"),
    "friction_coefficient",
)

# Options for a table of heights: unit, example and help text.
SCENE = {
    "composite_modulus": ("MPa", "1.36 MPa", "E* for a table of heights, such as {}."),
    "young_modulus": ("MPa", "1.02 MPa", "E for a table of heights, instead of E*, such as {}."),
    "poisson_ratio": ("1", "0.5", "ν for a table of heights; default: 0.5."),
    "shear_strength": ("MPa", "0.404 MPa", "σ for a table of heights, such as {}, for friction forces."),
    "area_ratio": ("1", "0.85", "B: sheared area over initial area, with --shear-strength; default: 1."),
    "radius": ("mm", "526 um", "Radius of all summits, such as {}, for a table without radii."),
    "thickness": ("mm", "7.2 mm", "Thickness of the block of a table of heights, such as {}."),
    "width": ("mm", "20 mm", "Width of that block along x, such as {}; for --model block."),
    "length": ("mm", "20 mm", "Length of that block along y, such as {}; for --model block."),
}


@command(
    click.argument("source", type=Name()),
    click.option(
        "--load",
        type=Quantity("N"),
        metavar="FORCE",
        multiple=True,
        help='Load, such as "0.2 N"; may be repeated. Default: a grid of loads.',
    ),
    *quantities(SCENE),
    column_option,
    *model_options("that of the folder; independent for a table"),
    click.option("-o", "--output", type=Name(), help="Also write the law to this CSV file."),
    force_option,
    json_option,
    short_help="Predict the friction law of a folder or a table of heights.",
)
def predict(
    source: Path,
    load: tuple[float, ...],
    model: str | None,
    contact: str | None,
    column: tuple[str, ...],
    output: Path | None,
    force: bool,
    as_json: bool,
    **scene: float | None,
) -> None:
    """Predict the friction law of the surface in a result folder or in a table of heights.

    SOURCE is a result folder of `metafem design`, or a CSV file with the columns x_mm, y_mm, height_um and
    radius_um (or in other units). A table needs --composite-modulus or --young-modulus. With the model layer
    it also needs --thickness, and with the model block --thickness, --width and --length. With
    --shear-strength, friction forces are also printed. `metafem study fidelity` compares all models.
    """
    given = {name: value for name, value in scene.items() if value is not None}
    refuse_files(force, output)
    with progress(), doing("predicting the law"):
        if source.is_dir():
            options = ", ".join(map(option_name, [*given, *(["column"] if column else [])]))
            own = f"the folder {printable(str(source))} holds its own material, friction, radii and block"
            refuse_if(options, f"{options}: only for tables of heights; {own}")
            stored = loaded(source)
            surface, used = stored.surface, stored.law.model
            remedy = "the folder's design has no block; design it again with a section [block]"
        else:
            advice = f"{source} is a specification; run metafem design {source} -o DIR, then predict DIR"
            refuse_if(source.suffix.lower() == ".toml", advice)
            surface, used = _surface(source, given, columns_of(column)), mf.Independent()
            remedy = "a table holds none; add --thickness, and --width and --length for the model block"
        if model == "layer" and surface.block is None and "thickness" in given:
            used, model = mf.Interacting(substrate=mf.BondedLayer(given["thickness"])), None
        chosen = mf.files.chosen_model(used, model, contact, surface.block)
        mf.files.refuse_missing_block(chosen, surface, remedy)
        law = mf.friction_law(surface, chosen, load=load or None)
    # all loads that the user states, otherwise about ten
    step = 1 if load else max(1, len(law.load) // 10)
    columns = {name: values.tolist() for name, values in law.columns().items() if name in SHOWN}
    if output is not None:
        mf.files.write_text(output, mf.files.law_table(law), force=force)
    show(
        as_json,
        {
            "model": mf.report.model_data(law.model),
            "status": law.status.name.lower(),
            "model_error": mf.report.error_data(law.model_error),
            **mf.files.plain_data(law.columns()),
            "notes": notes_data(law.notes),
        },
        tables=[in_columns(columns, range(step - 1, len(law.load), step))],
        lines=[f"model {law.model.name}, {law.status.value}", mf.report.error_words(law.model_error)],
        notes=law.notes,
        files=[output],
    )


def _surface(source: Path, given: Mapping[str, float], columns: Mapping[str, str]) -> Surface:
    """Return the surface in a table of heights; the options state its material, friction and block."""
    table = mf.files.read_table(source, columns)
    refuse_if(
        ("composite_modulus" in given) == ("young_modulus" in given),
        f"a table of heights such as {source} needs either --composite-modulus or --young-modulus, "
        'for example --composite-modulus "1.36 MPa"',
    )
    refuse_if(
        "area_ratio" in given and "shear_strength" not in given,
        "--area-ratio needs --shear-strength: the friction force depends on both; add for example "
        '--shear-strength "0.404 MPa"',
    )
    sides = {name: given[name] for name in SIDES if name in given}
    refuse_if(
        sides and len(sides) < len(SIDES) and list(sides) != ["thickness"],
        "a block needs all of --width, --length and --thickness; the model layer needs the thickness alone",
    )
    ratio, strength = given.get("poisson_ratio", 0.5), given.get("shear_strength")
    if "young_modulus" in given:
        material = mf.Material.from_young(given["young_modulus"], ratio)
    else:
        material = mf.Material(given["composite_modulus"], ratio)
    friction = None if strength is None else mf.Friction(strength, given.get("area_ratio", 1.0))
    block = mf.Block(**sides) if len(sides) == len(SIDES) else None
    return mf.files.read_surface(table, material, given.get("radius"), friction, block)
