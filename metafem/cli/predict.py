"""`metafem predict`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from metafem.cli.group import force_option, json_option, main, model_option
from metafem.cli.progress import progress
from metafem.cli.terminal import notes_data, tell_notes, tell_table, terminal
from metafem.errors import InvalidInput
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.law import FrictionLaw
    from metafem.surface import Block


@main.command()
@click.argument("source", type=click.Path(path_type=Path))
@click.option("--load", multiple=True, help='A load, such as "0.2 N"; may be repeated.')
@click.option("--composite-modulus", help='E* for a table of heights, such as "1.36 MPa".')
@click.option("--radius", help='Radius of all summits where the table has none, such as "526 um".')
@click.option("--thickness", help='Of the block under a table of heights, such as "7.2 mm".')
@click.option("--width", help='Of that block along x, such as "20 mm"; for --model block.')
@click.option("--length", help='Of that block along y, such as "20 mm"; for --model block.')
@model_option
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Write the law as CSV, too.")
@force_option
@json_option
def predict(
    source: Path,
    load: tuple[str, ...],
    composite_modulus: str | None,
    radius: str | None,
    thickness: str | None,
    width: str | None,
    length: str | None,
    model: str | None,
    output: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Predict the friction law of a result folder or of a table of heights.

    SOURCE is a folder that `metafem design` made, or a CSV file with the columns x_mm, y_mm, height_um
    and radius_um (or in other units). A table needs --composite-modulus, and a block for --model layer
    (--thickness) or block (--thickness, --width and --length).
    """
    import metafem as mf
    from metafem._given import printable, speaking
    from metafem.files import (
        is_law_table,
        law_table,
        model_named,
        option_words,
        quantity,
        read_surface,
        refuse_existing,
        refuse_missing_block,
        write_text,
    )

    sizes = {"thickness": thickness, "width": width, "length": length}
    given = {name: quantity(f"--{name}", text, "mm") for name, text in sizes.items() if text is not None}
    if source.is_dir():
        if composite_modulus is not None or radius is not None or given:
            raise InvalidInput(
                "--composite-modulus, --radius and the sizes of a block are for tables of heights; "
                "a folder states its own"
            )
        stored = mf.load(source)
        surface, used = stored.surface, stored.law.model
    else:
        if not source.exists():
            raise InvalidInput(f"{printable(str(source))}: no such file or folder")
        if composite_modulus is None:
            raise InvalidInput(
                f'a table of heights such as {source} needs --composite-modulus, for example "1.36 MPa"'
            )
        modulus = quantity("--composite-modulus", composite_modulus, "MPa")
        common = None if radius is None else quantity("--radius", radius, "mm")
        options = {**sizes, "composite_modulus": composite_modulus, "radius": radius}
        with speaking(option_words(options)):
            material, block = mf.Material(modulus), _block(given, model)
        surface = read_surface(source, material, common, block=block)
        used = mf.Independent()
    if output is not None:
        refuse_existing(output, force, is_law_table)
    newtons = [quantity("--load", text, "N") for text in load]
    chosen = model_named(model) if model else used
    if model == "layer" and "thickness" in given and surface.block is None:
        chosen = mf.Interacting(substrate=mf.BondedLayer(given["thickness"]))
    remedy = "a folder without one has none to offer; design it anew with a section [block]"
    refuse_missing_block(chosen, surface, remedy)
    with progress(), doing("predicting the law"):
        law = mf.friction_law(surface, chosen, load=newtons or None)
    if output is not None:
        write_text(output, law_table(law), force=force, ours=is_law_table)
    if as_json:
        click.echo(json.dumps(_law_data(law)))
    else:
        _tell_law(law, whole=bool(load))


def _block(given: dict[str, float], model: str | None) -> Block | None:
    """Return the block of a table whose sizes are given; a layer needs its thickness alone."""
    from metafem.surface import Block

    names = ("width", "length", "thickness")
    needed = {"layer": names[2:], "block": names}.get(model or "", names if given else ())
    missing = [f'--{name} "{7.2 if name == "thickness" else 20} mm"' for name in needed if name not in given]
    if missing:
        what = f"--model {model}" if model in ("layer", "block") else "a block"
        raise InvalidInput(
            f"{what} needs the block's sizes, which a table does not hold: add {' '.join(missing)}"
        )
    return Block(*(given[name] for name in names)) if set(names) <= set(given) else None


def _tell_law(law: FrictionLaw, whole: bool) -> None:
    from metafem.report import model_name

    columns = ["load [N]", "area [mm²]", "separation [mm]", "stiffness [N/mm]"]
    if law.friction is not None:
        columns.append("friction [N]")
    # Ten lines tell the shape of a curve; loads that were asked for are all shown.
    step = 1 if whole else max(1, len(law.load) // 10)
    rows = []
    for i in range(step - 1, len(law.load), step):
        numbers = [law.load[i], law.area[i], law.separation[i], law.stiffness[i]]
        if law.friction is not None:
            numbers.append(law.friction_force[i])
        rows.append(tuple(f"{number:.6g}" for number in numbers))
    console = terminal()
    tell_table(console, columns, rows)
    console.print(f"{model_name(law.model)}: {law.status.value}", highlight=False, markup=False)
    tell_notes(console, law.notes)


def _law_data(law: FrictionLaw) -> dict[str, Any]:
    from metafem.report import model_name

    data = {
        "model": model_name(law.model),
        "status": law.status.name.lower(),
        "load_N": law.load.tolist(),
        "area_mm2": law.area.tolist(),
        "separation_mm": law.separation.tolist(),
        "rescaled_load_mm2": law.rescaled_load.tolist(),
        "stiffness_N_per_mm": law.stiffness.tolist(),
        "residual": law.residual.tolist(),
        "notes": notes_data(law.notes),
    }
    if law.friction is not None:
        data["friction_force_N"] = law.friction_force.tolist()
    return data
