"""The README's table of the models: what each assumes, and the reference for its error in A0.

The surface is the design of Fig. 4, red. The reference is resolved contacts on a half-space, extrapolated
from the two finest cells.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np

import metafem as mf
from metafem.models.model import Model
from validation.paper.surfaces import fig4

MARKS = ("<!-- models: python -m validation.benchmark --readme -->", "<!-- end of the models -->")
PICTURE = Path(__file__).parents[1] / "work_precision.svg"

# Rescaled loads P/E* [mm²]: at the first 18 of the 64 asperities touch, at the second all.
LOADS = (0.1, 0.6)

# Cells of the resolved contacts [mm], coarsest first. The finest cell is used for the reference only.
CELLS = (0.04, 0.02, 0.01, 0.005)
FINEST = 0.0025
TOLERANCES = (0.1, 1e-2, 1e-3, 1e-4)

LINES: dict[str, dict[str, Model]] = {
    "Independent()": {"": mf.Independent()},
    "MeanField()": {"": mf.MeanField()},
    "Interacting(order=1)": {"": mf.Interacting(order=1)},
    "Interacting(order=3)": {"": mf.Interacting(order=3)},
    "Automatic(tolerance)": {f"{value:g}": mf.Automatic(value) for value in TOLERANCES},
    "BoundaryElements(cell)": {f"{1e3 * cell:g} µm": mf.BoundaryElements(cell) for cell in CELLS},
}

# The models of the README's table: name, line and setting, assumption, range.
TABLE = (
    (
        "Independent()", "Independent()", "",
        "each contact obeys Hertz, or the law of another cap; neighbours have no influence",
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
        "order 3, or resolved contacts where its estimated error of A0(P) exceeds the tolerance",
        "that of the chosen model; `state.notes` gives the reason",
    ),
)  # fmt: skip


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


def state(model: Model, load: float) -> mf.ContactState:
    """Return the equilibrium under a rescaled load."""
    return mf.equilibrium(surface(), model, load=load * surface().material.composite_modulus)


def shown_error(error: float, uncertainty: float) -> str:
    """Return an error to one digit, or the reference's uncertainty if the error is smaller."""
    return f"{100 * error:.1g} %" if error > uncertainty else f"below {100 * uncertainty:.1g} %"


def rounded(seconds: float) -> str:
    """Return a time rounded to 1, 2 or 5 in each decade, so that it seldom changes between runs."""
    steps = np.multiply.outer(10.0 ** np.arange(-7, 4), [1.0, 2.0, 5.0]).ravel()
    value = float(steps[np.abs(np.log(steps / seconds)).argmin()])
    scale, unit = next(
        (s, u) for s, u in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")) if value >= s
    )
    return f"{value / scale:.0f} {unit}"
