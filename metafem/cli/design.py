"""The commands demo, design, spec, report and explore."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

import metafem as mf
from metafem.cli import NOT_ACHIEVED
from metafem.cli.options import Name, command, file_option, force_option, json_option, model_options
from metafem.cli.output import notes_data, progress, show
from metafem.errors import Infeasible, refuse_if
from metafem.files.specification import DEMOS
from metafem.progress import doing

if TYPE_CHECKING:
    from metafem.inversion import Design

# Name of the schema's file, to which the specifications of the demonstrations refer.
SCHEMA_FILE = "metafem.schema.json"


@command(
    click.argument("name", type=click.Choice(DEMOS)),
    *model_options("that of the specification"),
    force_option,
    json_option,
    short_help="Write and design one of the paper's specifications.",
)
def demo(name: str, **options: Any) -> None:
    """Write NAME.toml, one of the paper's specifications, and design its surface into the folder NAME.

    The schema metafem.schema.json, which editors read, is written next to NAME.toml. An edited NAME.toml is
    never replaced.
    """
    path, folder, text = Path(f"{name}.toml"), Path(name), mf.files.demo_text(name)
    mf.files.refuse_existing(folder, options["force"], folder=True)
    other = path.exists() and path.read_bytes() != text.encode("utf-8")
    remedy = f"run it by `metafem design {path} -o FOLDER`, or rename it"
    refuse_if(other, f"{path} exists and differs from the demo's; {remedy}")
    for file, content in ((path, text), (Path(SCHEMA_FILE), mf.files.schema_text())):
        if not file.exists():
            mf.files.write_text(file, content)
    click.get_current_context().invoke(design, spec=path, output=folder, **options)


@command(
    click.argument("spec", type=Name(), metavar="SPEC.toml"),
    file_option("-o --output", "DIR", "Result folder to create.", required=True),
    *model_options("that of the specification"),
    force_option,
    json_option,
    short_help="Design a surface from a specification.",
)
def design(
    spec: Path, output: Path, model: str | None, contact: str | None, force: bool, as_json: bool
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
    with progress(), doing("designing"):
        specification = mf.read_spec(spec)
        hardness, template = specification.hardness, specification.template
        chosen = mf.files.chosen_model(specification.model, model, contact, template)
        try:
            result = specification.design(chosen)
        except Infeasible as error:
            raise Infeasible(f"{error}{_nearest(error.nearest, output, force)}") from None
        pages = {"report.html": mf.report.page(result, hardness)}
        mf.save(result, output, specification=specification, pages=pages, force=force)
    part = mf.files.planned(result.surface, result.template, specification.part)
    notes = mf.report.all_notes(result, hardness) + mf.files.part_notes(part)
    data = {"folder": str(output), **_data(result), "notes": notes_data(notes)}
    data["chord_error_mm"] = part and part.chord_error
    rows = [
        *mf.report.parameter_rows(result),
        (*mf.report.misfit_words(result), ""),
        ("asperities", f"{result.surface.count} of {result.template.count} sites", ""),
        ("model", result.law.model.name, ""),
    ]
    fits = [(*mf.report.fit_table(result), None)] if result.fits else []
    show(
        as_json,
        data,
        lines=[result.target.title, result.verdict],
        tables=[(("", "", ""), rows, None), *fits],
        notes=notes,
        files=[output / "report.html"],
    )
    if result.status is mf.DesignStatus.MISSED:
        sys.exit(NOT_ACHIEVED)


def _nearest(nearest: Any, folder: Path, force: bool) -> str:
    """Return where the nearest law to a refused target is, after it is written next to the result folder."""
    if nearest is None or nearest.law is None:
        return ""
    path = Path(f"{folder.absolute()}-nearest.csv")
    if path.exists() and not force:
        return f"; the nearest law is not written, because {path.name} exists (--force replaces it)"
    rows = "".join(f"{x!r},{y!r}\n" for x, y in zip(*(each.tolist() for each in nearest.law), strict=True))
    head = "# The nearest law that was found, by metafem.\nrescaled_load_mm2,rescaled_friction_mm2\n"
    mf.files.write_text(path, head + rows, force=force)
    return f'; the nearest law is in {path.name}, for a sampled target with file = "{path.name}"'


def _data(result: Design) -> dict[str, Any]:
    """Return the numbers of a design, for JSON."""
    return {
        "target": result.target.title,
        "status": result.status.name.lower(),
        "misfit": result.misfit,
        "misfit_meaning": result.misfit_meaning,
        "asperities": result.surface.count,
        "model": mf.report.model_data(result.law.model),
        "model_error": mf.report.error_data(result.law.model_error),
        "parameters": mf.files.plain_data(result.parameters),
        "slopes": [
            {
                "target": branch.slope,
                "fitted": fit.slope,
                "intercept_mm2": fit.intercept,
                "friction_coefficient": fit.friction_coefficient,
                "intercept_N": fit.intercept_force,
            }
            for branch, fit in result.fits
        ],
    }


@command(
    click.option(
        "--schema",
        "--json",
        "as_schema",
        is_flag=True,
        help="Print the JSON schema instead, by which editors complete keys and mark errors. A specification "
        "names it in a comment before the first section: `#:schema ./metafem.schema.json`.",
    ),
    short_help="Print every key of a specification, with examples.",
)
def spec(as_schema: bool) -> None:
    """Print every section and key of a specification with its meaning and an example."""
    click.echo(mf.files.schema_text() if as_schema else mf.files.manual(), nl=False)


@command(click.argument("folder", type=Name()), json_option)
def report(folder: Path, as_json: bool) -> None:
    """Write or replace report.html in a result folder, with the results of the studies in the folder."""
    path = folder / "report.html"
    with progress():
        studies = mf.files.stored_studies(folder)
        text = mf.report.page(mf.load(folder), mf.files.stored_hardness(folder), studies=studies)
        mf.files.write_text(path, text, force=True)
    show(as_json, {"report": str(path)}, files=[path])


@command(
    click.argument("path", type=Name(), required=False, metavar="[SPEC.toml | DIR]"),
    click.option("--port", type=int, help="Port of the loopback address. Default: a free one."),
    click.option("--no-browser", is_flag=True, help="Print the address only."),
    short_help="Draw a law and see the surface, in the browser.",
)
def explore(path: Path | None, port: int | None, no_browser: bool) -> None:
    """Open a page on which you draw a target law and see its surface; Ctrl-C ends the command.

    The page begins with the specification SPEC.toml, with the specification of the result folder DIR, or by
    default with the demo operating-points. Only this machine can open the page. The command needs the extra
    explorer.
    """
    from metafem.explorer import explore as start

    with suppress(KeyboardInterrupt):
        start(path, port=port, show=not no_browser)
    click.echo("The explorer has ended. An open page keeps what it shows.")
