"""Check all claims: write the report and results.json, exit 1 if any check failed."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click

import metafem as mf
from metafem.drawing import svg
from metafem.report.figures import law_figure
from validation import explorer_picture, shape_pictures
from validation.chapters import CHAPTERS, chosen
from validation.check import Claim
from validation.cost import work_precision
from validation.cost.table import table
from validation.numbers import computed, expected
from validation.page import write_report
from validation.paper.surfaces import fig4
from validation.published import REFERENCE
from validation.questions import markdown
from validation.results import evaluated_in_turn, marked

PICTURE = Path(__file__).parent / "first_minute.svg"
PROOF = Path(__file__).parent / "guide" / "proof.md"
LISTED = "\n\n".join(f"{each.name}: {', '.join(each.claims)}." for each in CHAPTERS)
LADDER = Path(__file__).parent / "work_precision.svg"


def renew_readme(results: dict[str, Claim]) -> None:
    """Write the numbers of the proof, and the pictures of README and guide."""
    _renew("questions", markdown(results))
    _renew("models", table())
    ladder = svg(
        work_precision.picture(), "Seconds against error of the models, from sparse to merged contacts"
    )
    LADDER.write_text(ladder, "utf-8")
    PICTURE.write_text(svg(_first_minute(), "Target, achieved law, and order 3 on the block"), "utf-8")
    explorer_picture.renew_picture()
    shape_pictures.renew_pictures()


def _renew(part: str, body: str) -> None:
    """Write a part of the proof, which stands between its own pair of marks."""
    begin, end = f"<!-- {part}: python -m validation --readme -->", f"<!-- end of the {part} -->"
    text = PROOF.read_text("utf-8")
    head, tail = text.split(begin)[0], text.split(end)[1]
    PROOF.write_text(f"{head}{begin}\n{body}\n{end}{tail}", "utf-8")


def _first_minute():
    """Draw the demo's law with the areas by order 3 on its block."""
    design = fig4("red")
    found = mf.studies.fidelity(design)
    figure = law_figure(design)
    ax = figure.axes[0]
    every = slice(4, None, 8)
    area = found["area"].sel(model="block").values[every]
    ax.plot(design.law.rescaled_load[every], area, "k^", ms=4, label="order 3 on the block")
    ax.legend(frameon=False, loc="upper left")
    return figure


@click.command(epilog=LISTED)
@click.option("-o", "--output", default="validation/results", show_default=True, help="Folder to write.")
@click.option("--quick", is_flag=True, help="Leave out the claims that take long or measure times.")
@click.option("--readme", is_flag=True, help="Also renew the numbers of guide/proof.md, and all pictures.")
@click.option("--mutate", is_flag=True, help="Change one term of the package at a time, see below.")
@click.option("--random", type=int, default=0, metavar="N", help="With --mutate: N random changes instead.")
@click.argument("names", nargs=-1)
def main(output: str, quick: bool, readme: bool, mutate: bool, random: int, names: tuple[str, ...]) -> None:
    """Check the claims NAMES, those of whole chapters, or all. Prints failed checks and writes the report.

    With --mutate NAMES are mutants of validation/mutants.toml, default: all. Each changes one constant, sign
    or term in a copy of the package. One that no core test notices, or none of its claims, is marked, and the
    exit status is then 1. With --random it prints how many of N random changes core tests notice, and of the
    others slow tests.
    """
    from rich.console import Console

    if mutate:
        from validation.mutate import survey, survivors

        sys.exit(survey(random) if random else 1 if survivors(names) else 0)
    console = Console()
    try:
        named = chosen(names)
    except KeyError as unknown:
        raise click.UsageError(f"{unknown} is none of the claims and chapters that --help lists") from None
    left_out = [name for name in named if quick and (marked("SLOW", name) or marked("TIMED", name))]
    if readme and (left_out or names):
        raise click.UsageError("--readme needs all claims: give it without --quick and without names")
    begin = time.perf_counter()
    results = _evaluate_all(console, [name for name in named if name not in left_out])
    folder = Path(output)
    write_report(folder, results, left_out)
    if readme:
        renew_readme(results)
    checks = [check for each in results.values() for check in each.checks]
    failed = [(each, check) for each in results.values() for check in each.failed]
    for each, check in failed:
        console.print(
            f"failed: {each.name}: {check.name}: computed {computed(check)}, expected {expected(check)}; "
            f"{check.source}", style="bold red", markup=False, soft_wrap=True,
        )  # fmt: skip
    if left_out:
        console.print(f"left out by --quick: {', '.join(left_out)}", soft_wrap=True)
    console.print(REFERENCE, soft_wrap=True, highlight=False)
    console.print(
        f"{len(checks) - len(failed)} of {len(checks)} checks passed in {time.perf_counter() - begin:.0f} s; "
        f"{folder / 'index.html'}", soft_wrap=True, highlight=False,
    )  # fmt: skip
    sys.exit(1 if failed else 0)


def _evaluate_all(console, wanted: list[str]) -> dict[str, Claim]:
    """Evaluate claims with a bar of progress, and a line for each that is done."""
    from rich.progress import track

    found = {}
    for each in track(evaluated_in_turn(wanted), "claims", len(wanted), console=console, transient=True):
        passed = len(each.checks) - len(each.failed)
        line = f"{each.name}: {passed} of {len(each.checks)} checks passed, {each.seconds:.1f} s"
        console.print(line, style="bold red" if each.failed else None, highlight=False, markup=False)
        found[each.name] = each
    return {name: found[name] for name in wanted}


if __name__ == "__main__":
    main()
