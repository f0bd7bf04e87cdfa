"""Check all claims: print the table, write results.json and the page, exit 1 if any check failed."""

from __future__ import annotations

import json
import sys
import time
import traceback
from dataclasses import asdict
from functools import cache
from pathlib import Path

import click

import metafem as mf
from metafem.drawing import svg
from metafem.report.figures import law_figure
from validation.check import Check, Claim
from validation.discovery import Listed, chosen, groups, module
from validation.page import page, readme_table
from validation.paper.surfaces import fig4
from validation.published import REFERENCE
from validation.readme import renew

PICTURE = Path(__file__).parent / "first_minute.svg"

MARKS = ("<!-- validation table: python -m validation --readme -->", "<!-- end of the validation table -->")


def claims() -> list[str]:
    """Names of the modules that make a claim, group by group."""
    return [name for names in groups("claim").values() for name in names]


def is_slow(name: str) -> bool:
    """Whether a claim takes more than a few seconds: its module holds ``SLOW = True``."""
    return bool(getattr(module(name, "claim"), "SLOW", False))


@cache
def evaluate(name: str) -> Claim:
    """Evaluate one claim; an exception is a failed check."""
    try:
        return module(name, "claim").claim()
    except Exception:
        reason = traceback.format_exc(limit=-1).strip().splitlines()[-1]
        return Claim(name, [Check(f"ran into: {reason}", float("inf"), "no error", False, "this run")])


def renew_readme(results: dict[str, Claim]) -> None:
    """Write the README's table and picture."""
    renew(MARKS, readme_table(results))
    PICTURE.write_text(svg(_first_minute(), "Target, achieved law and finite elements"), "utf-8")


def _first_minute():
    """Draw the demo's law with the areas of finite elements of its caps."""
    design = fig4("red")
    found = mf.studies.fidelity(design)
    figure = law_figure(design)
    ax = figure.axes[0]
    every = slice(4, None, 8)
    area = found["area"].sel(model="fe").values[every]
    ax.plot(design.law.rescaled_load[every], area, "k^", ms=4, label="finite elements of the true caps")
    ax.legend(frameon=False, loc="upper left")
    return figure


class ListedClaims(Listed):
    """The command, whose help lists the claims."""

    attributes = ("claim",)


@click.command(cls=ListedClaims)
@click.option("-o", "--output", default="validation/results", show_default=True, help="Folder to write.")
@click.option("--readme", is_flag=True, help="Also renew the table in README.md.")
@click.argument("names", nargs=-1)
def main(output: str, readme: bool, names: tuple[str, ...]) -> None:
    """Check the claims NAMES, those of whole groups, or all. Prints computed and expected numbers."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    results: dict[str, Claim] = {}
    for name in chosen(names, "claim"):
        start = time.perf_counter()
        claim = results[name] = evaluate(name)
        title = f"{name}: {claim.title}"
        table = Table("check", "computed", "expected", "source", title=title, title_justify="left")
        for check in claim.checks:
            style = None if check.passed else "bold red"
            row = (check.name, f"{check.computed:.6g}", check.expected, str(check.source))
            table.add_row(*map(Text, row), style=style)  # texts: a unit in brackets is no markup
        for each in claim.results:
            table.add_row(*map(Text, (each.name, f"{each.value:.6g}", "", each.method)), style="dim")
        console.print(table)
        console.print(f"{time.perf_counter() - start:.1f} s\n")
    folder = Path(output)
    folder.mkdir(parents=True, exist_ok=True)
    data = {
        name: {
            "title": c.title,
            "checks": [asdict(k) for k in c.checks],
            "results": [asdict(k) for k in c.results],
        }
        for name, c in results.items()
    }
    (folder / "results.json").write_text(json.dumps(data, indent=1, ensure_ascii=False, default=str), "utf-8")
    (folder / "index.html").write_text(page(results), "utf-8")
    if readme:
        renew_readme(results)
    checks = [check for claim in results.values() for check in claim.checks]
    failed = sum(not check.passed for check in checks)
    console.print(REFERENCE)
    console.print(f"{len(checks) - failed} of {len(checks)} checks passed; {folder / 'index.html'}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
