"""Time and error of A0 of every model, measured in one run on the surface of the paper's red linear law.

The reference is resolved contacts on a half-space, extrapolated from the two finest cells. tamaas is
installed by the extra ``[peers]``; without it the picture has no line of it.
``python -m validation.benchmark.work_precision`` prints all points and draws the picture.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import click
import numpy as np

import metafem as mf
from metafem.drawing import new_figure, svg
from metafem.models.model import Model
from validation.benchmark.resolved import solve_with_tamaas
from validation.scenes.model_table import (
    LINES,
    LOADS,
    PICTURE,
    TABLE,
    TOLERANCES,
    reference,
    rounded,
    shown_error,
    state,
    surface,
)
from validation.timing import Row, best

PEER_CELLS = (0.04, 0.02)

# Loads of a law, for the time per load.
LAW_LOADS = 100

PEER = "tamaas"

COLOURS = dict(
    zip(
        [*LINES, PEER],
        ("#8a8f98", "#c9a227", "#7fb069", "#1b6f8a", "#6a4c93", "#c8553d", "#1f2933"),
        strict=True,
    )
)


@dataclass(frozen=True)
class Point:
    """One measurement: a line, its setting, the rescaled load [mm²], seconds and relative error of A0."""

    line: str
    setting: str
    load: float
    seconds: float
    error: float


@cache
def points() -> tuple[Point, ...]:
    """Measure every line at every load."""
    measured = []
    for load in LOADS:
        exact, _ = reference(load)
        for line, models in LINES.items():
            for setting, model in models.items():
                seconds = _seconds(lambda model=model, load=load: state(model, load))
                error = abs(state(model, load).area / exact - 1.0)
                measured.append(Point(line, setting, load, seconds, error))
        if importlib.util.find_spec("tamaas") is not None:
            for cell in PEER_CELLS:
                newtons = load * surface().material.composite_modulus
                answer = solve_with_tamaas(surface(), cell, newtons)
                error = abs(answer.area / exact - 1.0)
                measured.append(Point(PEER, f"{1e3 * cell:g} µm", load, answer.seconds, error))
    return tuple(measured)


def rows() -> list[Row]:
    """Compare the errors with the required ones."""
    found = {(p.line, p.setting): p.error for p in points() if p.load == LOADS[-1]}
    light = {(p.line, p.setting): p.error for p in points() if p.load == LOADS[0]}
    measured = [Row("A0 of order 3 against resolved contacts", 8e-4, found["Interacting(order=3)", ""], "")]
    for value in TOLERANCES:
        key = ("Automatic(tolerance)", f"{value:g}")
        measured.append(Row(f"A0 of Automatic({value:g})", value, max(found[key], light[key]), ""))
    uncertain = max(reference(load)[1] for load in LOADS)
    measured.append(Row("A0 of the reference: last step of the extrapolation", 1e-4, uncertain, ""))
    return measured


def readme_table() -> str:
    """Return the README's table of the models in Markdown, times rounded to 1, 2 or 5."""
    lines = [
        f"| model | assumes | one load, 64 asperities | each of {LAW_LOADS} loads | error in A0 | range |",
        "|---|---|---|---|---|---|",
    ]
    uncertainty = max(reference(load)[1] for load in LOADS)
    for name, line, setting, assumption, span in TABLE:
        selected = [p for p in points() if (p.line, p.setting) == (line, setting)]
        one_load = rounded(selected[-1].seconds)
        law = "–" if line.startswith("Boundary") else rounded(_law_seconds(LINES[line][setting]))
        error = shown_error(max(p.error for p in selected), uncertainty)
        lines.append(f"| `{name}` | {assumption} | {one_load} | {law} | {error} | {span} |")
    return "\n".join(lines)


def draw() -> None:
    """Draw the picture and write it."""
    figure = new_figure(9.0, 3.4)
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, load in zip(axes, LOADS, strict=True):
        for line, colour in COLOURS.items():
            selected = [p for p in points() if (p.line, p.load) == (line, load)]
            if not selected:
                continue
            seconds, error = [p.seconds for p in selected], [p.error for p in selected]
            marker = "s" if line == PEER else "o"
            ax.plot(seconds, error, marker=marker, ms=5, lw=1, color=colour, label=line)
        ax.axhline(reference(load)[1], color="grey", lw=0.8, ls=":", label="uncertainty of the reference")
        touching = int((state(mf.Interacting(), load).asperity_load > 0.0).sum())
        ax.set_title(f"P/E* = {load:g} mm², {touching} of {surface().count} in contact", fontsize=10)
        ax.set_xlabel("seconds for one load")
        ax.loglog()
    axes[0].set_ylabel("relative error of A0")
    figure.legend(*axes[1].get_legend_handles_labels(), frameon=False, fontsize=8, loc="outside right center")
    PICTURE.write_text(svg(figure, "Seconds against error of the models"), "utf-8")


def _seconds(work: Callable[[], object]) -> float:
    """Shortest time of several runs [s]; short runs vary more and are repeated more often."""
    first = best(work, 1)
    return first if first > 1.0 else min(first, best(work, 3 if first > 0.05 else 20))


def _law_seconds(model: Model) -> float:
    """Seconds per load of a law up to the largest load."""
    loads = LOADS[-1] * surface().material.composite_modulus * np.arange(1, LAW_LOADS + 1) / LAW_LOADS
    return best(lambda: mf.friction_law(surface(), model, load=loads), 5) / LAW_LOADS


@click.command()
def main() -> None:
    """Print every point and draw the picture."""
    from rich.console import Console
    from rich.table import Table

    table = Table("model", "setting", "P/E* [mm²]", "seconds", "error of A0")
    for p in points():
        table.add_row(p.line, p.setting, f"{p.load:g}", f"{p.seconds:.2g}", f"{p.error:.1e}")
    Console().print(table)
    for load in LOADS:
        click.echo(f"the reference at {load:g} mm² is uncertain by {reference(load)[1]:.1e}")
    if importlib.util.find_spec("tamaas") is None:
        click.echo("tamaas is not installed (extra [peers]); its line is missing")
    draw()
    click.echo(PICTURE)


if __name__ == "__main__":
    main()
