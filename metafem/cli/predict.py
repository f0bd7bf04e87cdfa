"""`metafem predict`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli import options
from metafem.cli.output import in_columns, notes_data, progress, show
from metafem.errors import printable, refuse_if
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.surface import Surface

# Columns of a law that are printed.
SHOWN = (
    *("load_N", "area_mm2", "separation_mm", "stiffness_N_per_mm", "friction_force_N"),
    "friction_coefficient",
)

# Options for a table of heights, which are keys of a specification: their types and help texts, by section.
SCENE: Mapping[str, Mapping[str, tuple[Any, str]]] = {
    "material": {
        "composite_modulus": (str, 'E*, such as "1.36 MPa".'),
        "young_modulus": (str, 'E, instead of E*, such as "1.02 MPa".'),
        "poisson_ratio": (float, "ν; default: 0.5."),
    },
    "friction": {
        "shear_strength": (str, 'σ, such as "0.404 MPa", for friction forces.'),
        "area_ratio": (float, "B: sheared area over initial area; default: 1."),
    },
    "block": {
        "width": (str, 'Width of the block along x, such as "20 mm".'),
        "length": (str, 'Length of the block along y, such as "20 mm".'),
        "thickness": (str, 'Thickness of the block, such as "7.2 mm".'),
    },
    "lattice": {"radius": (options.Quantity("mm"), 'Radius of all summits, such as "526 um".')},
}
SURFACE_OPTIONS = [
    click.option(options.option_name(name), type=kind, help=f"For a table of heights: {words}")
    for keys in SCENE.values()
    for name, (kind, words) in keys.items()
]


@options.command(
    click.argument("source", type=options.Name()),
    click.option(
        "--load",
        type=options.Quantity("N"),
        metavar="FORCE",
        multiple=True,
        help='Load, such as "0.2 N"; may be repeated. Default: a grid of loads.',
    ),
    *SURFACE_OPTIONS,
    options.column_option,
    *options.model_options("that of the folder; independent for a table"),
    click.option("-o", "--output", type=options.Name(), help="Also write the law to this CSV file."),
    options.force_option,
    options.json_option,
    short_help="Predict the friction law of a folder or a table of heights.",
)
def predict(source: Path, load: tuple[float, ...], force: bool, as_json: bool, **stated: Any) -> None:
    """Predict the friction law of the surface in a result folder or in a table of heights.

    SOURCE is a result folder of `metafem design`, or a CSV file with the columns x_mm, y_mm, height_um and
    radius_um (or in other units). A table needs --composite-modulus or --young-modulus. With the models layer
    and block it also needs --width, --length and --thickness. With --shear-strength, friction forces are also
    printed. `metafem study fidelity` compares all models.
    """
    column, output = options.columns_of(stated["column"]), stated["output"]
    model, contact = stated["model"], stated["contact"]
    given = {name: stated[name] for keys in SCENE.values() for name in keys if stated[name] is not None}
    options.refuse_files(force, output)
    with progress(), doing("predicting the law"):
        if source.is_dir():
            names = ", ".join(map(options.option_name, [*given, *(["column"] if column else [])]))
            own = f"the folder {printable(str(source))} holds its own material, friction, radii and block"
            refuse_if(names, f"{names}: only for tables of heights; {own}")
            stored = mf.load(source)
            surface, used = stored.surface, stored.law.model
        else:
            advice = f"{source} is a specification; run metafem design {source} -o DIR, then predict DIR"
            refuse_if(source.suffix.lower() == ".toml", advice)
            surface, used = _surface(source, given, column), mf.Independent()
        chosen = mf.files.chosen_model(used, model, contact, surface)
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


def _surface(source: Path, given: Mapping[str, Any], columns: Mapping[str, str]) -> Surface:
    """Return the surface in a table of heights; the options state its material, friction and block."""
    table = mf.files.read_table(source, columns)
    sections = {name: {key: given[key] for key in keys if key in given} for name, keys in SCENE.items()}
    material = mf.files.section_value("material", sections["material"])
    friction, block = (
        mf.files.section_value(name, sections[name]) if sections[name] else None
        for name in ("friction", "block")
    )
    return mf.files.read_surface(table, material, given.get("radius"), friction, block)
