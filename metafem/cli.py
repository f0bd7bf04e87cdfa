"""The metafem command: parse, call, print."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from metafem.errors import InvalidInput, MetafemError
from metafem.terminal import tell_table, terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from metafem.files import Specification
    from metafem.inversion import Design
    from metafem.law import FrictionLaw
    from metafem.surface import Block

DEMOS = ("operating-points", "linear", "bilinear")

# The kinds that `metafem.files` knows, listed here so that --help needs no import.
MODELS = ("independent", "mean-field", "half-space", "layer", "block", "resolved", "automatic")

STUDIES = ("interaction", "fidelity")

# Exit codes: a target that cannot be reached, and input that cannot be used.
NOT_ACHIEVED, BAD_INPUT = 1, 2


class BadInput(click.ClickException):
    """Input that cannot be used, on its way to the terminal."""

    exit_code = BAD_INPUT


class NotAchieved(click.ClickException):
    """A target that cannot be reached, on its way to the terminal."""

    exit_code = NOT_ACHIEVED


class Commands(click.Group):
    """A group whose commands end in a message and an exit code instead of a traceback."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command."""
        try:
            return super().invoke(ctx)
        except InvalidInput as error:
            # errors name the argument of Python's functions
            raise BadInput(str(error).replace("force=True", "--force")) from None
        except MetafemError as error:
            raise NotAchieved(str(error)) from None


def model_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add --model to a command."""
    choice = click.Choice(MODELS)
    return click.option("--model", type=choice, help="Model of the predicted law; the file's unless told.")(
        command
    )


json_option = click.option("--json", "as_json", is_flag=True, help="Print data alone, as JSON.")
force_option = click.option("--force", is_flag=True, help="Overwrite what is there.")


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="metafem")
def main() -> None:
    """Design surfaces with a friction law of your choice.

    Lengths are in mm, forces in N, moduli in MPa; files say their units.
    """


@main.command()
@click.argument("name", type=click.Choice(DEMOS))
@model_option
@force_option
@json_option
def demo(name: str, model: str | None, force: bool, as_json: bool) -> None:
    """Write the paper's specification NAME.toml into this folder and run it into NAME/."""
    from metafem.files import check_free, demo_text, write_text

    path, folder = Path(f"{name}.toml"), Path(name)
    check_free(folder, force)
    if path.exists() and not force:
        raise InvalidInput(
            f"{path} exists; run it by `metafem design {path} -o FOLDER`, or replace it with --force"
        )
    write_text(path, demo_text(name), force=force)
    _run(path, folder, model, force, as_json)


@main.command()
@click.argument("spec", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Result folder to make.")
@model_option
@force_option
@json_option
def design(spec: Path, output: Path, model: str | None, force: bool, as_json: bool) -> None:
    """Design a surface from the specification SPEC.toml and write all its files.

    A specification has the sections target (of kind operating-points, linear, bilinear, sampled, power or
    multilinear), material, lattice and limits and, where wanted, friction, radii, block, layout, model,
    part and checks. `metafem spec` prints every key with an example; `metafem demo` writes whole files.
    """
    _run(spec, output, model, force, as_json)


def _run(spec: Path, folder: Path, model: str | None, force: bool, as_json: bool) -> None:
    import metafem as mf
    from metafem.files import check_free, model_named
    from metafem.inversion import DesignStatus
    from metafem.report import cautions, page

    check_free(folder, force)
    with _progress("reading the specification") as say:
        specification = mf.read_spec(spec)
        chosen = model_named(model) if model else specification.model
        say("inverting the law")
        result = specification.design(chosen)
        say("drawing the report")
        text = page(result, specification.hardness)
        say("writing the files")
        mf.save(result, folder, specification=specification, force=force, pages={"report.html": text})
    _tell_design(result, specification, folder, cautions(result, specification.hardness), as_json)
    if result.status is DesignStatus.MISSED:
        sys.exit(NOT_ACHIEVED)


@main.command("spec")
@json_option
def explain(as_json: bool) -> None:
    """Print every section and key of a specification, each with its meaning and an example."""
    from metafem.files import all_keys, manual

    if as_json:
        click.echo(json.dumps([asdict(key) for key in all_keys()]))
    else:
        click.echo(manual(), nl=False)


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
    from metafem.files import law_table, model_named, quantity, read_heights, write_text

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
            raise InvalidInput(f"{source}: no such file or folder")
        if composite_modulus is None:
            raise InvalidInput(
                f'a table of heights such as {source} needs --composite-modulus, for example "1.36 MPa"'
            )
        modulus = quantity("--composite-modulus", composite_modulus, "MPa")
        position, height, radii = read_heights(
            source, None if radius is None else quantity("--radius", radius, "mm")
        )
        surface = mf.Surface(position, height, radii, mf.Material(modulus), block=_block(given, model))
        used = mf.Independent()
    newtons = [quantity("--load", text, "N") for text in load]
    chosen = model_named(model) if model else used
    if model == "layer" and surface.block is None:
        chosen = mf.Interacting(substrate=mf.BondedLayer(given["thickness"]))
    with _progress("predicting the law"):
        law = mf.friction_law(surface, chosen, load=newtons or None)
    if output is not None:
        write_text(output, law_table(law), force=force)
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


@main.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--checks", is_flag=True, help="Add the finite-element checks; takes about a minute.")
@json_option
def report(folder: Path, checks: bool, as_json: bool) -> None:
    """Write report.html of a result folder anew."""
    import metafem as mf
    from metafem.files import stored_hardness, write_text
    from metafem.report import page

    with _progress("drawing the report"):
        path = folder / "report.html"
        write_text(path, page(mf.load(folder), stored_hardness(folder), checks=checks), force=True)
    click.echo(json.dumps({"report": str(path)}) if as_json else f"wrote {path}")


@main.command()
@click.argument("name", type=click.Choice(STUDIES))
@click.argument("folder", type=click.Path(path_type=Path))
@force_option
@json_option
def study(name: str, folder: Path, force: bool, as_json: bool) -> None:
    """Study the design of a result folder and write NAME.nc into it.

    interaction: how coupling changes the law, as placed and in 1,000 random placements. fidelity: the law
    by every theory, from independent asperities to the true block and finite elements; a minute or two
    the first time.
    """
    import metafem as mf
    from metafem.files import study_data, study_path, write_study

    path = study_path(folder, name, force)
    design = mf.load(folder)
    with _progress(f"studying {name}"):
        found = getattr(mf.studies, name)(design)
    write_study(found, path, force=force)
    if as_json:
        click.echo(json.dumps({"file": str(path), **study_data(found)}))
    else:
        _tell_study(found, path)


def _tell_study(found: Dataset, path: Path) -> None:
    from metafem.studies import summary

    told = summary(found)
    console = terminal()
    tell_table(console, told.columns, told.rows, told.title)
    for text in told.notes:
        console.print(text, style="yellow", highlight=False, markup=False)
    console.print(f"wrote {path}", highlight=False, markup=False)


@main.command()
@json_option
def doctor(as_json: bool) -> None:
    """Check the installation: versions, compiled kernels, a known contact, the part's tools."""
    from metafem.doctor import examine

    findings = list(examine())
    if as_json:
        click.echo(json.dumps([{"what": f.what, "found": f.found, "well": f.well} for f in findings]))
    else:
        for finding in findings:
            mark = click.style("ok  ", fg="green") if finding.well else click.style("FAIL", fg="red")
            click.echo(f"{mark} {finding.what}: {finding.found}")
    sys.exit(0 if all(finding.well for finding in findings) else NOT_ACHIEVED)


@contextmanager
def _progress(first: str) -> Iterator[Callable[[str], None]]:
    """Show what is being done on a terminal, and say once when kernels are compiled."""
    from rich.console import Console

    from metafem._kernels.notice import on_first_compilation

    console = Console(stderr=True)
    on_first_compilation(lambda: console.print("compiling kernels, once for this installation …"))
    if not console.is_terminal:
        yield lambda text: None
        return
    with console.status(first) as status:
        yield status.update


def _tell_design(
    result: Design, specification: Specification, folder: Path, cautions: tuple[str, ...], as_json: bool
) -> None:
    from metafem.report import misfit_words, model_name, parameter_rows, wanted

    if as_json:
        data = {
            "folder": str(folder),
            "status": result.status.name.lower(),
            "misfit": result.misfit,
            "asperities": result.surface.count,
            "model": model_name(result.law.model),
            "parameters": {name: _plain(value) for name, value in result.parameters.items()},
            "slopes": [{"target": b.slope, "fitted": f.slope} for b, f in result.fits],
            "cautions": list(cautions),
        }
        click.echo(json.dumps(data))
        return
    from rich.console import Console
    from rich.table import Table

    console = Console()
    console.print(wanted(result.target), style="bold", highlight=False, markup=False)
    console.print(result.status.value, highlight=False, markup=False)
    table = Table(box=None, show_header=False)
    for name, value, unit in parameter_rows(result):
        table.add_row(name, value, unit)
    table.add_row(*misfit_words(result), "")
    table.add_row("asperities", f"{result.surface.count} of {result.template.count} places", "")
    console.print(table, highlight=False)
    for text in cautions:
        console.print(f"note: {text}", style="yellow", highlight=False, markup=False)
    console.print(f"wrote {folder}/: open {folder / 'report.html'}", highlight=False, markup=False)


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
    for note in law.notes:
        console.print(f"note: {note}", style="yellow", highlight=False, markup=False)


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
        "notes": list(law.notes),
    }
    if law.friction is not None:
        data["friction_force_N"] = law.friction_force.tolist()
    return data


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else value
