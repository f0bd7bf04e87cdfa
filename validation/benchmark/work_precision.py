"""Time against error of A0 for every model, on the surface of the paper's red linear law.

The reference is resolved contacts on a half-space, extrapolated from the two finest cells. tamaas is
installed by the extra ``[peers]``; without it the picture has no line for it.
``python -m validation.benchmark.work_precision`` prints all points and draws the picture.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import click
import numpy as np

import metafem as mf
from metafem.drawing import new_figure, svg
from metafem.models.model import Model
from validation.benchmark.resolved import solve_with_tamaas
from validation.benchmark.timing import Row, best
from validation.paper.surfaces import fig4

PICTURE = Path(__file__).parents[1] / "work_precision.svg"

# Rescaled loads P/E* [mm²]: at the first 18 of the 64 asperities touch, at the second all.
LOADS = (0.1, 0.6)

# Cells of the resolved line [mm], coarsest first; the finest cell serves the reference alone.
CELLS = (0.04, 0.02, 0.01, 0.005)
FINEST = 0.0025
PEER_CELLS = (0.04, 0.02)
TOLERANCES = (0.1, 1e-2, 1e-3, 1e-4)

# Number of loads of a law, for the time per load.
LAW_LOADS = 100

LINES: dict[str, dict[str, Model]] = {
    "Independent()": {"": mf.Independent()},
    "MeanField()": {"": mf.MeanField()},
    "Interacting(order=1)": {"": mf.Interacting(order=1)},
    "Interacting(order=3)": {"": mf.Interacting(order=3)},
    "Automatic(tolerance)": {f"{value:g}": mf.Automatic(value) for value in TOLERANCES},
    "BoundaryElements(cell)": {f"{1e3 * cell:g} µm": mf.BoundaryElements(cell) for cell in CELLS},
}
PEER = "tamaas"

# The models of the README's table: name, line and setting, assumption, range.
TABLE = (
    (
        "Independent()", "Independent()", "",
        "each contact obeys Hertz; neighbours have no influence",
        "loads up to base contact; a/R up to about 0.5 with a fitted modulus",
    ),
    (
        "MeanField()", "MeanField()", "",
        "the mean pressure on a half-space sinks all asperities equally",
        "many asperities; A0(P) is that of `Independent()`, the separation is not",
    ),
    (
        "Interacting(order=1)", "Interacting(order=1)", "",
        "each contact acts on the others as a point load, on a half-space, a layer or the true block",
        "a/r up to about 0.15: the error grows as (a/r)³",
    ),
    (
        "Interacting()", "Interacting(order=3)", "",
        "as order 1, with the size of the contacts and the slope and curvature of their fields",
        "checked against resolved contacts up to a/r = 0.32; no overlap; up to 10⁶ asperities",
    ),
    (
        "BoundaryElements(0.01)", "BoundaryElements(cell)", "10 µm",
        "nothing about single contacts; pressures on cells of 10 µm",
        "any contacts, also merged ones; at least four cells per radius of the largest contact",
    ),
    (
        "Automatic(1e-3)", "Automatic(tolerance)", "0.001",
        "the cheapest of the others whose estimated error of A0(P) is within the tolerance",
        "that of the chosen model; `state.notes` gives the reason",
    ),
)  # fmt: skip

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
def surface() -> mf.Surface:
    """Return the design of Fig. 4, red."""
    return fig4("red").surface


@cache
def reference(load: float) -> tuple[float, float]:
    """Return A0 [mm²] extrapolated from the two finest cells, and its relative change by the finest cell."""
    areas = [state(mf.BoundaryElements(cell), load).area for cell in (*CELLS[-2:], FINEST)]
    # the error falls as the square of the cell, which is halved
    before, last = ((4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(areas))
    return last, abs(last / before - 1.0)


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
    """Return the README's table of the models in Markdown, costs rounded to 1, 2 or 5."""
    lines = [
        f"| model | assumes | one load, 64 asperities | each of {LAW_LOADS} loads | error in A0 | range |",
        "|---|---|---|---|---|---|",
    ]
    doubt = max(reference(load)[1] for load in LOADS)
    for name, line, setting, assumption, span in TABLE:
        mine = [p for p in points() if (p.line, p.setting) == (line, setting)]
        alone = rounded(mine[-1].seconds)
        law = "–" if line.startswith("Boundary") else rounded(_law_seconds(LINES[line][setting]))
        error = shown_error(max(p.error for p in mine), doubt)
        lines.append(f"| `{name}` | {assumption} | {alone} | {law} | {error} | {span} |")
    return "\n".join(lines)


def shown_error(error: float, uncertainty: float) -> str:
    """Return an error to one digit, or the reference's uncertainty if the error is smaller."""
    return f"{100 * error:.1g} %" if error > uncertainty else f"below {100 * uncertainty:.1g} %"


def draw() -> None:
    """Write the picture."""
    figure = new_figure(9.0, 3.4)
    axes = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, load in zip(axes, LOADS, strict=True):
        for line, colour in COLOURS.items():
            mine = [p for p in points() if (p.line, p.load) == (line, load)]
            if not mine:
                continue
            seconds, error = [p.seconds for p in mine], [p.error for p in mine]
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


def state(model: Model, load: float) -> mf.ContactState:
    """Return the equilibrium under a rescaled load."""
    return mf.equilibrium(surface(), model, load=load * surface().material.composite_modulus)


def _seconds(work: Callable[[], object]) -> float:
    """Shortest of several runs [s]; quick work is noisy and runs more often."""
    first = best(work, 1)
    return first if first > 1.0 else min(first, best(work, 3 if first > 0.05 else 20))


def _law_seconds(model: Model) -> float:
    """Seconds per load of a law up to the largest load."""
    loads = LOADS[-1] * surface().material.composite_modulus * np.arange(1, LAW_LOADS + 1) / LAW_LOADS
    return best(lambda: mf.friction_law(surface(), model, load=loads), 5) / LAW_LOADS


def rounded(seconds: float) -> str:
    """Return a time rounded to 1, 2 or 5 in each decade, so that noise seldom changes it."""
    steps = np.multiply.outer(10.0 ** np.arange(-7, 4), [1.0, 2.0, 5.0]).ravel()
    value = float(steps[np.abs(np.log(steps / seconds)).argmin()])
    scale, unit = next(
        (s, u) for s, u in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")) if value >= s
    )
    return f"{value / scale:.0f} {unit}"


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
        click.echo("tamaas is not installed (extra [peers]); its line is left out")
    draw()
    click.echo(PICTURE)


if __name__ == "__main__":
    main()
