"""`metafem demo` and `metafem design`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem._kernels import ahead
from metafem.cli.group import (
    NOT_ACHIEVED,
    Ended,
    Name,
    Quantity,
    force_option,
    json_option,
    main,
    model_option,
)
from metafem.cli.progress import progress
from metafem.cli.terminal import notes_data, print_notes, print_table, say, terminal
from metafem.errors import Infeasible, InvalidInput, refuse_if
from metafem.files.specification.models import DEMOS
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.files.part.plan import Part
    from metafem.inversion import Design
    from metafem.inversion.problem import Branch
    from metafem.notes import Note
    from metafem.prediction import BranchFit


@main.command(short_help="Write and design one of the paper's specifications.")
@click.argument("name", type=click.Choice(DEMOS))
@model_option("that of the specification")
@force_option
@json_option
def demo(name: str, model: str | None, contact: str | None, force: bool, as_json: bool) -> None:
    """Write NAME.toml, one of the paper's specifications, and design its surface into the folder NAME.

    The schema metafem.schema.json, which editors read, is written next to NAME.toml. An edited NAME.toml is
    never replaced.
    """
    path, folder, text = Path(f"{name}.toml"), Path(name), mf.files.demo_text(name)
    mf.files.refuse_existing(folder, force, folder=True)
    same = path.is_file() and path.read_bytes() == text.encode("utf-8")
    remedy = f"run it by `metafem design {path} -o FOLDER`, or rename it"
    refuse_if(path.exists() and not same, f"{path} exists and differs from the demo's; {remedy}")
    if not same:
        mf.files.write_text(path, text)
    if (remark := mf.files.place_schema(path.parent)) is not None:
        click.echo(f"note: {remark}", err=True)
    options: dict[str, Any] = {"model": model, "contact": contact, "force": force, "as_json": as_json}
    click.get_current_context().invoke(design, spec=path, output=folder, **options)


@main.command(short_help="Design a surface from a specification.")
@click.argument("spec", type=Name(), metavar="SPEC.toml")
@click.option("-o", "--output", type=Name(), required=True, help="Result folder to create.")
@model_option("that of the specification")
@click.option(
    "--chord-error",
    type=Quantity("mm", "1 um"),
    metavar="LENGTH",
    help='Largest depth of the triangles of the solids below the spheres, such as "1 um". Overrides '
    "part.chord_error in SPEC.toml. Default: 4e-4 of the smallest radius, or more if a solid would have "
    "over two million triangles.",
)
@force_option
@json_option
def design(
    spec: Path,
    output: Path,
    model: str | None,
    contact: str | None,
    chord_error: float | None,
    force: bool,
    as_json: bool,
) -> None:
    """Design a surface from the specification SPEC.toml and write the result folder.

    A specification has the sections target (of kind operating-points, linear, bilinear, sampled, power,
    multilinear or band), material, lattice and limits. The sections friction, sites, tools, block, cell,
    layout, model, cap, contact, part and checks are optional. `metafem spec` prints every key with
    an example; `metafem demo` writes example files.

    For a measured law, choose a target of kind sampled and name its table in the key file. The table has the
    format that `metafem compare` reads, and its error bars are used. If a target is refused, the nearest law
    is written next to the result folder DIR, as DIR-nearest.csv.
    """
    mf.files.refuse_existing(output, force, folder=True)
    ahead.start()  # the report needs them after everything else
    with progress(), doing("designing"):
        specification = mf.read_spec(spec)
        if chord_error is not None:
            specification = specification.with_chord_error(chord_error)
        chosen = mf.files.chosen_model(specification.model, model, contact)
        with mf.files.staged(output, force, folder=True) as fresh:
            try:
                result = specification.design(chosen)
            except Infeasible as error:
                raise _refusal(error, output, force) from None
            text = mf.report.page(result, specification.hardness)
            part = mf.files.write_all(result, fresh, specification, {"report.html": text})
    notes = mf.report.all_notes(result, specification.hardness) + mf.files.part_notes(part)
    if as_json:
        click.echo(json.dumps(_design_data(result, output, notes, part)))
    else:
        _print_design(result, output, notes)
    if result.status is mf.DesignStatus.MISSED:
        sys.exit(NOT_ACHIEVED)


def _refusal(error: Infeasible, folder: Path, force: bool) -> Ended:
    """Return the error for a refused target, after its nearest law is written next to the result folder."""
    if error.nearest is None:
        return Ended("Infeasible", str(error))
    words, nearest = str(error), {"target": error.nearest.title}
    law = error.nearest.law
    if law is not None:
        path = Path(f"{folder.absolute()}-nearest.csv")
        rows = zip(*(column.tolist() for column in law), strict=True)
        lines = [
            "# The nearest law that was found, by metafem.",
            "rescaled_load_mm2,rescaled_friction_mm2",
            *(f"{x!r},{y!r}" for x, y in rows),
        ]
        try:
            mf.files.write_text(path, "\n".join(lines) + "\n", force=force)
            words += f"; the nearest law is written to {path.name}; design it as a sampled target with "
            words += f'file = "{path.name}"'
            nearest["file"] = str(path)
        except InvalidInput as reason:
            words += f"; the nearest law is not written: {reason}"
        nearest |= {"rescaled_load": law[0].tolist(), "rescaled_friction": law[1].tolist()}
    return Ended("Infeasible", words, nearest=nearest)


def _design_data(result: Design, folder: Path, notes: tuple[Note, ...], part: Part | None) -> dict[str, Any]:
    return {
        "folder": str(folder),
        "target": result.target.title,
        "status": result.status.name.lower(),
        "misfit": result.misfit,
        "misfit_meaning": result.misfit_meaning,
        "asperities": result.surface.count,
        "model": mf.report.model_data(result.law.model),
        "model_error": mf.report.error_data(result.law.model_error),
        "parameters": mf.files.plain_data(result.parameters),
        "slopes": [_fit_data(result, branch, fit) for branch, fit in result.fits],
        "part": None if part is None else part.record(),
        "notes": notes_data(notes),
    }


def _print_design(result: Design, folder: Path, notes: tuple[Note, ...]) -> None:
    from rich.console import Console
    from rich.table import Table

    from metafem.inversion.result import empty_sites_words

    console = Console()
    console.print(result.target.title, style="bold", highlight=False, markup=False)
    say(console, result.status.value)
    table = Table(box=None, show_header=False)
    for name, value, unit in mf.report.parameter_rows(result):
        table.add_row(name, value, unit)
    table.add_row(*mf.report.misfit_words(result), "")
    sites = f"{result.surface.count} of {result.template.count} sites{empty_sites_words(result)}"
    table.add_row("asperities", sites, "")
    console.print(table, highlight=False)
    if result.fits:
        print_table(terminal(), *mf.report.fit_table(result))
    print_notes(console, notes)
    say(console, f"wrote {folder}/: open {folder / 'report.html'}")


def _fit_data(result: Design, branch: Branch, fit: BranchFit) -> dict[str, float | None]:
    """Return target and fitted slope of a branch, and friction coefficients if the surface has a Friction."""
    from metafem.inversion.wording import Wording

    data: dict[str, float | None] = {
        "target": branch.slope,
        "fitted": fit.slope,
        "intercept_mm2": fit.intercept,
    }
    if result.surface.friction is None:
        return data
    pair = Wording.of(result.surface.material, result.surface.friction)
    return {
        **data,
        "target_friction_coefficient": pair.coefficient(branch.slope),
        "fitted_friction_coefficient": fit.friction_coefficient,
        "intercept_N": fit.intercept_force,
    }
