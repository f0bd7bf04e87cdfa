"""`metafem predict`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._given import printable
from metafem.cli.group import Name, force_option, json_option, main, model_option
from metafem.cli.progress import printing_messages, progress
from metafem.cli.terminal import loaded, notes_data, print_json, print_notes, print_table, say, terminal
from metafem.errors import InvalidInput, named
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.prediction import FrictionLaw
    from metafem.surface import Surface

# Dimensions of a block, as options and as arguments.
BLOCK = ("width", "length", "thickness")


@main.command(short_help="Predict the friction law of a folder or a table of heights.")
@click.argument("source", type=Name())
@click.option(
    "--load",
    metavar="FORCE",
    multiple=True,
    help='Load, such as "0.2 N"; may be repeated. Default: a grid of loads.',
)
@click.option("--composite-modulus", metavar="MODULUS", help='E* for a table of heights, such as "1.36 MPa".')
@click.option(
    "--young-modulus", metavar="MODULUS", help='E for a table of heights, instead of E*, such as "1.02 MPa".'
)
@click.option("--poisson-ratio", type=float, help="ν for a table of heights; default: 0.5.")
@click.option(
    "--shear-strength",
    metavar="STRESS",
    help='σ for a table of heights, such as "0.404 MPa", for friction forces.',
)
@click.option(
    "--area-ratio", type=float, help="B: sheared area over initial area, with --shear-strength; default: 1."
)
@click.option(
    "--radius", metavar="LENGTH", help='Radius of all summits, such as "526 um", for a table without radii.'
)
@click.option(
    "--thickness", metavar="LENGTH", help='Thickness of the block of a table of heights, such as "7.2 mm".'
)
@click.option(
    "--width", metavar="LENGTH", help='Width of that block along x, such as "20 mm"; for --model block.'
)
@click.option(
    "--length", metavar="LENGTH", help='Length of that block along y, such as "20 mm"; for --model block.'
)
@model_option("that of the folder; independent for a table", multiple=True)
@click.option("-o", "--output", type=Name(), help="Also write the law to this CSV file.")
@force_option
@json_option
def predict(
    source: Path,
    load: tuple[str, ...],
    model: tuple[str, ...],
    contact: tuple[str, ...],
    output: Path | None,
    force: bool,
    as_json: bool,
    **scene: str | float | None,
) -> None:
    """Predict the friction law of a result folder or of a table of heights.

    SOURCE is a result folder of `metafem design`, or a CSV file with the columns x_mm, y_mm, height_um and
    radius_um (or in other units). A table needs --composite-modulus or --young-modulus. For --model layer it
    also needs --thickness, for --model block --thickness, --width and --length. With --shear-strength the
    friction forces are printed too. Several models or contact laws are compared at the same loads: all models
    with all contact laws.
    """
    given = {name: value for name, value in scene.items() if value is not None}
    if source.is_dir():
        if given:
            options = ", ".join(f"--{name.replace('_', '-')}" for name in given)
            raise InvalidInput(
                f"{options}: only for tables of heights; the folder {printable(str(source))} holds its "
                "own material, friction, radii and block"
            )
        with progress():
            stored = loaded(source)
        surface, used = stored.surface, stored.law.model
    else:
        if not source.exists():
            raise InvalidInput(f"{printable(str(source))}: no such file or folder")
        if source.suffix.lower() == ".toml":
            name = printable(str(source))
            raise InvalidInput(
                f"{name} is a specification; run metafem design {name} -o FOLDER, then metafem predict FOLDER"
            )
        with printing_messages():
            surface, used = _surface(source, given, model), mf.Independent()
    pairs = [(kind, words) for kind in model or (None,) for words in contact or (None,)]
    if output is not None:
        if len(pairs) > 1:
            raise InvalidInput(f"--output holds one law, and {len(pairs)} are compared; choose one of them")
        mf.files.refuse_existing(output, force, "law")
    newtons = [mf.files.quantity("--load", text, "N") for text in load]
    models = []
    for kind, words in pairs:
        chosen = mf.files.chosen_model(used, kind, words)
        if kind == "layer" and "thickness" in given and surface.block is None:
            thickness = mf.files.quantity("--thickness", given["thickness"], "mm")
            layer = mf.Interacting(substrate=mf.BondedLayer(thickness))
            chosen = mf.files.chosen_model(layer, None, words)
        remedy = "the folder's design has no block; design it again with a section [block]"
        mf.files.refuse_missing_block(chosen, surface, remedy)
        models.append(chosen)
    laws: list[FrictionLaw] = []
    with progress(), doing("predicting the law"):
        for each in models:
            loads = laws[0].load if laws else newtons or None
            laws.append(mf.friction_law(surface, each, load=loads))
    if output is not None:
        mf.files.write_text(output, mf.files.law_table(laws[0]), force=force, kind="law")
    data = [_law_data(law) for law in laws] if as_json else []
    if as_json:
        print_json(data[0] if len(data) == 1 else {"laws": data})
    elif len(laws) == 1:
        _print_law(laws[0], whole=bool(load))
    else:
        _print_laws(laws, whole=bool(load))


def _surface(source: Path, given: Mapping[str, str | float], models: tuple[str, ...]) -> Surface:
    """Return the surface of a table of heights, with material, friction and block from the options."""
    if ("composite_modulus" in given) == ("young_modulus" in given):
        raise InvalidInput(
            f"a table of heights such as {source} needs either --composite-modulus or --young-modulus, "
            'for example --composite-modulus "1.36 MPa"'
        )
    if "area_ratio" in given and "shear_strength" not in given:
        raise InvalidInput(
            "--area-ratio needs --shear-strength: the friction force depends on both; add for example "
            '--shear-strength "0.404 MPa"'
        )
    units = {"radius": "mm", "thickness": "mm", "width": "mm", "length": "mm"}
    units |= dict.fromkeys(("composite_modulus", "young_modulus", "shear_strength"), "MPa")
    number = {
        name: mf.files.quantity(f"--{name.replace('_', '-')}", value, units[name])
        if name in units
        else float(value)
        for name, value in given.items()
    }
    with named(mf.files.option_names({name: str(value) for name, value in given.items()})):
        ratio = number.get("poisson_ratio", 0.5)
        if "young_modulus" in number:
            material = mf.Material.from_young(number["young_modulus"], ratio)
        else:
            material = mf.Material(number["composite_modulus"], ratio)
        friction = (
            mf.Friction(number["shear_strength"], number.get("area_ratio", 1.0))
            if "shear_strength" in number
            else None
        )
        block = _block({name: number[name] for name in BLOCK if name in number}, models)
    return mf.files.read_surface(source, material, number.get("radius"), friction, block)


def _block(given: dict[str, float], models: tuple[str, ...]) -> mf.Block | None:
    """Return the block of a table from its given dimensions; a layer needs only the thickness."""
    bounded = [
        name for name in ("block", "layer") if name in models
    ]  # the first option needs all dimensions of the others
    needed = {"layer": BLOCK[2:], "block": BLOCK}.get("".join(bounded[:1]), BLOCK if given else ())
    missing = [f'--{name} "{7.2 if name == "thickness" else 20} mm"' for name in needed if name not in given]
    if missing:
        what = f"--model {bounded[0]}" if bounded else "a block"
        alone = "" if models else "; for --model layer the thickness alone is enough"
        raise InvalidInput(
            f"{what} needs the block's dimensions, which a table does not hold; "
            f"add {' '.join(missing)}{alone}"
        )
    return mf.Block(*(given[name] for name in BLOCK)) if set(BLOCK) <= set(given) else None


def _print_law(law: FrictionLaw, whole: bool) -> None:
    columns = ["load [N]", "area [mm²]", "separation [mm]", "stiffness [N/mm]"]
    if law.friction is not None:
        columns += ["friction [N]", "F/P"]
    rows = []
    for i in _rows(law, whole):
        numbers = [law.load[i], law.area[i], law.separation[i], law.stiffness[i]]
        if law.friction is not None:
            numbers += [law.friction_force[i], law.friction_coefficient[i]]
        rows.append(tuple(f"{number:.6g}" for number in numbers))
    console = terminal()
    print_table(console, columns, rows)
    say(console, f"model {law.model.name}, {law.status.value}")
    print_notes(console, law.notes)


def _print_laws(laws: list[FrictionLaw], whole: bool) -> None:
    """Print the areas of laws at the same loads, with their change against the first."""
    first = laws[0]
    columns = ["load [N]", "1: area [mm²]"]
    for number in range(2, len(laws) + 1):
        columns += [f"{number}: area [mm²]", f"{number}: change"]
    rows = []
    for i in _rows(first, whole):
        numbers = [f"{first.load[i]:.6g}", f"{first.area[i]:.6g}"]
        for law in laws[1:]:
            change = 100.0 * (law.area[i] / first.area[i] - 1.0) if first.area[i] > 0.0 else math.nan
            numbers += [f"{law.area[i]:.6g}", f"{change:+.2g} %" if math.isfinite(change) else "-"]
        rows.append(tuple(numbers))
    console = terminal()
    print_table(console, columns, rows)
    for number, law in enumerate(laws, 1):
        say(console, f"{number}: model {law.model.name}, {law.status.value}")
        print_notes(console, law.notes)


def _rows(law: FrictionLaw, whole: bool) -> range:
    """Return ten loads of a default grid, or every load that the user gave."""
    step = 1 if whole else max(1, len(law.load) // 10)
    return range(step - 1, len(law.load), step)


def _law_data(law: FrictionLaw) -> dict[str, Any]:

    data = {
        "model": mf.report.model_data(law.model),
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
        # JSON has no infinity: there is no coefficient at zero load
        data["friction_coefficient"] = [
            value if math.isfinite(value) else None for value in law.friction_coefficient.tolist()
        ]
    return data
