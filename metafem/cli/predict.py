"""`metafem predict`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

import metafem as mf
from metafem._given import printable
from metafem.cli.group import (
    Name,
    Quantity,
    force_option,
    json_option,
    main,
    model_option,
    option_names,
)
from metafem.cli.progress import printing_messages, progress
from metafem.cli.study.options import option_name, with_options
from metafem.cli.terminal import loaded, notes_data, print_json, print_notes, print_table, say, terminal
from metafem.errors import named, refuse_if
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem._validate import FloatArray
    from metafem.prediction import FrictionLaw, Onset
    from metafem.surface import Surface

# Dimensions of a block, with an example of each; they are options and arguments of `Block`.
BLOCK = {"width": "20 mm", "length": "20 mm", "thickness": "7.2 mm"}

# Unit and help text of the options for a table of heights.
SCENE = {
    "composite_modulus": ("MPa", 'E* for a table of heights, such as "1.36 MPa".'),
    "young_modulus": ("MPa", 'E for a table of heights, instead of E*, such as "1.02 MPa".'),
    "poisson_ratio": (None, "ν for a table of heights; default: 0.5."),
    "shear_strength": ("MPa", 'σ for a table of heights, such as "0.404 MPa", for friction forces.'),
    "area_ratio": (None, "B: sheared area over initial area, with --shear-strength; default: 1."),
    "radius": ("mm", 'Radius of all summits, such as "526 um", for a table without radii.'),
    "thickness": ("mm", 'Thickness of the block of a table of heights, such as "7.2 mm".'),
    "width": ("mm", 'Width of that block along x, such as "20 mm"; for --model block.'),
    "length": ("mm", 'Length of that block along y, such as "20 mm"; for --model block.'),
}

scene_options = with_options(
    *(
        click.option(
            option_name(name),
            type=Quantity(unit) if unit else float,
            metavar={"MPa": "STRESS", "mm": "LENGTH"}.get(unit or ""),
            help=text,
        )
        for name, (unit, text) in SCENE.items()
    )
)


@main.command(short_help="Predict the friction law of a folder or a table of heights.")
@click.argument("source", type=Name())
@click.option(
    "--load",
    type=Quantity("N"),
    metavar="FORCE",
    multiple=True,
    help='Load, such as "0.2 N"; may be repeated. Default: a grid of loads.',
)
@click.option(
    "--onset",
    type=Quantity("N"),
    metavar="FORCE",
    help="Also print the onset of sliding at this load: friction force over tangential displacement.",
)
@scene_options
@model_option("that of the folder; independent for a table", multiple=True)
@click.option("-o", "--output", type=Name(), help="Also write the law to this CSV file.")
@force_option
@json_option
def predict(
    source: Path,
    load: tuple[float, ...],
    onset: float | None,
    model: tuple[str, ...],
    contact: tuple[str, ...],
    output: Path | None,
    force: bool,
    as_json: bool,
    **scene: float | None,
) -> None:
    """Predict the friction law of the surface in a result folder or in a table of heights.

    SOURCE is a result folder of `metafem design`, or a CSV file with the columns x_mm, y_mm, height_um and
    radius_um (or in other units). A table needs --composite-modulus or --young-modulus. With the model layer
    it also needs --thickness, and with the model block --thickness, --width and --length. With
    --shear-strength, friction forces are also printed. If --model or --contact is repeated, all combinations
    of models and contact laws are compared at the same loads. With --onset, one contact after the other
    starts to slide at that load; this needs a friction.
    """
    given = {name: value for name, value in scene.items() if value is not None}
    name = printable(str(source))
    if source.is_dir():
        options = ", ".join(map(option_name, given))
        own = f"the folder {name} holds its own material, friction, radii and block"
        refuse_if(given, f"{options}: only for tables of heights; {own}")
        with progress():
            stored = loaded(source)
        surface, used = stored.surface, stored.law.model
    else:
        refuse_if(not source.exists(), f"{name}: no such file or folder")
        remedy = f"run metafem design {name} -o FOLDER, then metafem predict FOLDER"
        refuse_if(source.suffix.lower() == ".toml", f"{name} is a specification; {remedy}")
        with printing_messages(), named(option_names()):
            surface, used = _surface(source, given, model), mf.Independent()
    pairs = [(kind, words) for kind in model or (None,) for words in contact or (None,)]
    if output is not None:
        several = f"--output holds one law, and {len(pairs)} are compared; choose one of them"
        refuse_if(len(pairs) > 1, several)
        mf.files.refuse_existing(output, force)
    models = []
    for kind, words in pairs:
        chosen = mf.files.chosen_model(used, kind, words)
        if kind == "layer" and "thickness" in given and surface.block is None:
            layer = mf.Interacting(substrate=mf.BondedLayer(given["thickness"]))
            chosen = mf.files.chosen_model(layer, None, words)
        remedy = "the folder's design has no block; design it again with a section [block]"
        mf.files.refuse_missing_block(chosen, surface, remedy)
        models.append(chosen)
    laws: list[FrictionLaw] = []
    with progress(), doing("predicting the law"):
        for each in models:
            loads = laws[0].load if laws else load or None
            laws.append(mf.friction_law(surface, each, load=loads))
        slides = [None if onset is None else mf.onset(surface, each, load=onset) for each in models]
    if output is not None:
        mf.files.write_text(output, mf.files.law_table(laws[0]), force=force)
    if as_json:
        data = [_law_data(law) for law in laws]
        for part, sliding in zip(data, slides, strict=True):
            if sliding is not None:
                part["onset"] = mf.report.onset_data(sliding)
        print_json(data[0] if len(data) == 1 else {"laws": data})
    else:
        _print_laws(laws, whole=bool(load))
        for number, sliding in enumerate(slides, 1):
            if sliding is not None:
                _print_onset(sliding, f"{number}: " if len(slides) > 1 else "")


def _surface(source: Path, given: Mapping[str, float], models: tuple[str, ...]) -> Surface:
    """Return the surface in a table of heights; the options state its material, friction and block."""
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
    ratio = given.get("poisson_ratio", 0.5)
    if "young_modulus" in given:
        material = mf.Material.from_young(given["young_modulus"], ratio)
    else:
        material = mf.Material(given["composite_modulus"], ratio)
    strength = given.get("shear_strength")
    friction = None if strength is None else mf.Friction(strength, given.get("area_ratio", 1.0))
    block = _block({name: given[name] for name in BLOCK if name in given}, models)
    return mf.files.read_surface(source, material, given.get("radius"), friction, block)


def _block(given: dict[str, float], models: tuple[str, ...]) -> mf.Block | None:
    """Return the block that the options state, or None if they do not state all of its dimensions.

    Raise InvalidInput if a model lacks a dimension: a layer needs only the thickness.
    """
    needed = BLOCK if given or "block" in models else {}
    if "layer" in models and "block" not in models:
        needed = {"thickness": BLOCK["thickness"]}
    missing = [f'--{name} "{example}"' for name, example in needed.items() if name not in given]
    refuse_if(
        missing,
        f"a block needs dimensions, which a table does not hold; add {' '.join(missing)}; for --model layer "
        "the thickness alone is enough",
    )
    return mf.Block(**given) if given.keys() == BLOCK.keys() else None


def _print_laws(laws: list[FrictionLaw], whole: bool) -> None:
    """Print one law, or the areas of several laws with their relative difference from the first law.

    All loads are printed if `whole` is true, which means that the user stated them; otherwise about ten.
    """
    first, console = laws[0], terminal()
    step = 1 if whole else max(1, len(first.load) // 10)
    shown = _quantities(first) if len(laws) == 1 else _compared(laws)
    rows = [
        [_printed(title, float(values[i])) for title, values in shown.items()]
        for i in range(step - 1, len(first.load), step)
    ]
    print_table(console, list(shown), rows)
    for number, law in enumerate(laws, 1):
        label = f"{number}: " if len(laws) > 1 else ""
        say(console, f"{label}model {law.model.name}, {law.status.value}")
        say(console, f"{label}{mf.report.error_words(law.model_error)}")
        print_notes(console, law.notes)


def _print_onset(sliding: Onset, label: str) -> None:
    """Print friction forces of the onset of sliding at up to ten displacements, and its summary."""
    console = terminal()
    # of contacts that start together, the last
    ends = np.flatnonzero(np.append(np.diff(sliding.displacement) > 0.0, True))
    shown = ends[:: -max(1, len(ends) // 10)][::-1].tolist()
    rows = [[f"{sliding.displacement[i]:.6g}", f"{sliding.friction_force[i]:.6g}", str(i + 1)] for i in shown]
    print_table(console, ["displacement [mm]", "friction [N]", "contacts that slide"], rows)
    say(console, f"{label}{mf.report.onset_words(sliding)}")


def _quantities(law: FrictionLaw) -> dict[str, FloatArray]:
    shown = {"load [N]": law.load, "area [mm²]": law.area, "separation [mm]": law.separation}
    shown["stiffness [N/mm]"] = law.stiffness
    if law.friction is not None:
        shown |= {"friction [N]": law.friction_force, "F/P": law.friction_coefficient}
    return shown


def _compared(laws: list[FrictionLaw]) -> dict[str, FloatArray]:
    first, *others = laws
    shown = {"load [N]": first.load, "1: area [mm²]": first.area}
    for number, law in enumerate(others, 2):
        zero = np.full(len(first.area), np.nan)  # an area of 0 has no relative change
        ratio = np.divide(law.area, first.area, out=zero, where=first.area > 0.0)
        shown |= {f"{number}: area [mm²]": law.area, f"{number}: change": 100.0 * (ratio - 1.0)}
    return shown


def _printed(title: str, value: float) -> str:
    if not title.endswith("change"):
        return f"{value:.6g}"
    return f"{value:+.2g} %" if math.isfinite(value) else "-"


def _law_data(law: FrictionLaw) -> dict[str, Any]:
    about = {"model": mf.report.model_data(law.model), "status": law.status.name.lower()}
    # the friction coefficient at zero load is not finite, and JSON has no such number
    numbers = mf.files.plain_data(law.columns())
    error = mf.report.error_data(law.model_error)
    return {**about, "model_error": error, **numbers, "notes": notes_data(law.notes)}
