"""`metafem predict`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

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
from metafem.cli.output import Printed, notes_data, show
from metafem.cli.progress import loaded, progress
from metafem.errors import refuse_if
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem._validate import FloatArray
    from metafem.prediction import FrictionLaw, Onset
    from metafem.surface import Surface

# Dimensions of a block, with an example of each; they are options and arguments of `Block`.
BLOCK = {"width": "20 mm", "length": "20 mm", "thickness": "7.2 mm"}

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
    click.option(
        "--onset",
        type=Quantity("N"),
        metavar="FORCE",
        help="Also print the onset of sliding at this load: friction force over tangential displacement.",
    ),
    *quantities(SCENE),
    column_option,
    *model_options("that of the folder; independent for a table", multiple=True),
    click.option("-o", "--output", type=Name(), help="Also write the law to this CSV file."),
    force_option,
    json_option,
    short_help="Predict the friction law of a folder or a table of heights.",
)
def predict(
    source: Path,
    load: tuple[float, ...],
    onset: float | None,
    model: tuple[str, ...],
    contact: tuple[str, ...],
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
    --shear-strength, friction forces are also printed. If --model or --contact is repeated, all combinations
    of models and contact laws are compared at the same loads. With --onset, one contact after the other
    starts to slide at that load; this needs a friction.
    """
    given = {name: value for name, value in scene.items() if value is not None}
    name = printable(str(source))
    with progress():
        if source.is_dir():
            options = ", ".join(map(option_name, [*given, *(["column"] if column else [])]))
            own = f"the folder {name} holds its own material, friction, radii and block"
            refuse_if(options, f"{options}: only for tables of heights; {own}")
            stored = loaded(source)
            surface, used = stored.surface, stored.law.model
        else:
            refuse_if(not source.exists(), f"{name}: no such file or folder")
            remedy = f"run metafem design {name} -o FOLDER, then metafem predict FOLDER"
            refuse_if(source.suffix.lower() == ".toml", f"{name} is a specification; {remedy}")
            surface, used = _surface(source, given, model, columns_of(column)), mf.Independent()
    pairs = [(kind, words) for kind in model or (None,) for words in contact or (None,)]
    several = f"--output holds one law, and {len(pairs)} are compared; choose one of them"
    refuse_if(output is not None and len(pairs) > 1, several)
    refuse_files(force, output)
    models = []
    for kind, words in pairs:
        chosen = mf.files.chosen_model(used, kind, words, surface.block)
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
        slides = [] if onset is None else [mf.onset(surface, each, load=onset) for each in models]
    if output is not None:
        mf.files.write_text(output, mf.files.law_table(laws[0]), force=force)
    data = [_law_data(law) for law in laws]
    for part, sliding in zip(data, slides, strict=False):
        part["onset"] = mf.report.onset_data(sliding)
    labels = [f"{number}: " if len(laws) > 1 else "" for number in range(1, len(laws) + 1)]
    lines = [
        line
        for label, law in zip(labels, laws, strict=True)
        for line in (
            f"{label}model {law.model.name}, {law.status.value}",
            f"{label}{mf.report.error_words(law.model_error)}",
        )
    ]
    show(
        as_json,
        data[0] if len(data) == 1 else {"laws": data},
        tables=[_table(laws, whole=bool(load)), *map(_onset_table, slides)],
        lines=[
            *lines,
            *(f"{a}{mf.report.onset_words(slide)}" for a, slide in zip(labels, slides, strict=False)),
        ],
        notes=() if as_json else [note for law in laws for note in law.notes],
        files=[output],
    )


def _surface(
    source: Path, given: Mapping[str, float], models: tuple[str, ...], columns: Mapping[str, str]
) -> Surface:
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
    table = mf.files.read_table(source, columns)
    return mf.files.read_surface(table, material, given.get("radius"), friction, block)


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


def _table(laws: list[FrictionLaw], whole: bool) -> Printed:
    """Return one law, or the areas of several laws with their relative difference from the first law.

    It has all loads if `whole` is true, which means that the user stated them; otherwise about ten.
    """
    first = laws[0]
    step = 1 if whole else max(1, len(first.load) // 10)
    shown = _quantities(first) if len(laws) == 1 else _compared(laws)
    rows = [
        [_printed(title, float(values[i])) for title, values in shown.items()]
        for i in range(step - 1, len(first.load), step)
    ]
    return list(shown), rows, None


def _onset_table(sliding: Onset) -> Printed:
    """Return friction forces of the onset of sliding at up to ten displacements."""
    import numpy as np

    # of contacts that start together, the last
    ends = np.flatnonzero(np.append(np.diff(sliding.displacement) > 0.0, True))
    shown = ends[:: -max(1, len(ends) // 10)][::-1].tolist()
    rows = [[f"{sliding.displacement[i]:.6g}", f"{sliding.friction_force[i]:.6g}", str(i + 1)] for i in shown]
    return ["displacement [mm]", "friction [N]", "contacts that slide"], rows, None


def _quantities(law: FrictionLaw) -> dict[str, FloatArray]:
    shown = {"load [N]": law.load, "area [mm²]": law.area, "separation [mm]": law.separation}
    shown["stiffness [N/mm]"] = law.stiffness
    if law.friction is not None:
        shown |= {"friction [N]": law.friction_force, "F/P": law.friction_coefficient}
    return shown


def _compared(laws: list[FrictionLaw]) -> dict[str, FloatArray]:
    import numpy as np

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
