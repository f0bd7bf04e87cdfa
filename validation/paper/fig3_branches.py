"""Figs. 3 and S1: three levels of heights, the continuations of the branches, and the contacts at 0.92 N.

Without the lower levels of heights the law would follow the dashed lines of Fig. 3. Each joins the law of the
whole surface at an operating point, where the plane reaches the next level.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem.drawing import circles, law, name_law
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods.independent import approaches, areas
from validation.paper.pictures import LEVELS
from validation.paper.surfaces import RADIUS, fig3
from validation.published import paper
from validation.sources import known_input, printed, second_method

# Loads P/E* [mm²] up to which the figure is drawn; the last operating point is at 0.649.
LAST = 0.75

# Area and load of both solvers agree to rounding in sums over 58 asperities, heights to this [µm].
ROUNDING, METHODS = 1e-10, 1e-6

SKETCH = known_input("N = n1 + n2 + n3 + 3 of the Fig. S1 caption, with the printed n1 to n3")
ALL = known_input("all asperities of a level above the plane: n_i + 1, with the printed n_i")
SAME = known_input("identity: up to the operating point the lower levels are open")
SUMS = second_method(areas, "sums of eq. S1 and Newton's method for the approach, with numpy")
CALIBRATED = printed("SM, calibration of individual microcontacts, largest calibrated radius")
METHOD = "independent Hertz contacts, mf.equilibrium"


class Levels(NamedTuple):
    """The designed surface, the level of each asperity (n,) from 0 on, and loads of the operating points."""

    surface: mf.Surface
    number: np.ndarray
    loads: np.ndarray

    def upper(self, count: int) -> mf.Surface:
        """Return the surface with its first levels only, each with its adjustment asperity."""
        return self.surface.only(self.number < count)


@cache
def levels() -> Levels:
    """Design the surface, and tell its levels apart by their heights."""
    design = fig3()
    between = 0.5 * (design.parameters["adjustment_heights"][:-1] + design.parameters["levels"][1:])
    number = (design.surface.height[:, None] < between).sum(axis=1)
    return Levels(design.surface, number, design.target_law.load)


@cache
def inset() -> mf.ContactState:
    """Return the contacts at the load of the inset."""
    return mf.equilibrium(levels().surface, load=paper()["fig3"]["inset_load_N"])


def claim() -> Claim:
    """The surface of Fig. 3 has three levels of heights, each with one adjustment asperity, as Fig. S1
    sketches. The law of its first level alone, and that of its first two, are the dashed lines of the figure.
    The paper prints no numbers for them, and shows the contacts at 0.92 N as a photograph: the sites of the
    heights in it are not printed, so that the inset below has the counts and sizes of the contacts, at sites
    chosen by this design.
    """
    title = "Figs. 3 and S1: levels, continued branches, and contacts at 0.92 N"
    return Claim(title, [*_continuations(), *_contacts()], {"branches": Picture(_branches)})


def _continuations() -> Iterator[Row]:
    found, counts = levels(), paper()["fig3"]["counts"]
    modulus, last = found.surface.material.composite_modulus, float(found.loads[-1])
    yield near("number of asperities N", found.surface.count, sum(counts) + len(counts), 0, SKETCH)
    for i, load in enumerate(found.loads[:-1].tolist(), 1):
        part, name, point = found.upper(i), f"continuation {i}", f"operating point {i}"
        shared = modulus * load * np.linspace(0.02, 1.0, 50)
        whole, alone = (mf.friction_law(each, load=shared).area for each in (found.surface, part))
        worst = np.abs(alone / whole - 1.0).max()
        yield below(f"{name}, up to {point}: largest difference of A0 from the law", worst, 1e-12, SAME)
        plane = float(part.height.max() - approaches(part.height, [load], RADIUS)[0])
        apart = 1e3 * (found.surface.height[found.number == i].max() - plane)
        yield near(f"h_{i + 1} and the plane at {point}: difference [µm]", apart, 0.0, METHODS, SUMS)
        area = mf.equilibrium(part, load=modulus * last).area
        exact = float(areas(part.height, [last], RADIUS)[0])
        yield near(f"{name} at P/E* = {last} [mm²]: F/σB [mm²]", area, exact, ROUNDING * exact, SUMS)


def _contacts() -> Iterator[Row]:
    found, state, published = levels(), inset(), paper()["fig3"]
    load = f"{published['inset_load_N']} N"
    for i, count in enumerate(published["counts"]):
        on = (found.number == i) & (state.asperity_area > 0.0)
        name = f"level {i + 1} at {load}"
        number = np.count_nonzero(on)
        yield near(f"{name}: contacts, with the adjustment asperity", number, count + 1, 0, ALL)
        radius = 1e3 * float(np.sqrt(state.asperity_area[on].max() / np.pi))
        yield reported(f"{name}: contact radius [µm]", radius, METHOD)
    rescaled = state.load / found.surface.material.composite_modulus
    area = float(areas(found.surface.height, [rescaled], RADIUS)[0])
    yield near(f"A0 at {load} [mm²]", state.area, area, ROUNDING * area, SUMS)
    largest = 1e3 * float(np.sqrt(state.asperity_area.max() / np.pi))
    limit = paper()["sample"]["max_contact_radius_um"]
    yield below(f"largest contact radius at {load} [µm]", largest, limit, CALIBRATED)


@panels(7.0, 4.6)
def _branches(ax):
    """Law of the surface of Fig. 3 (solid) through its three operating points, and the continuations without
    the lower levels (dashed), as in the paper. Each dashed line leaves the solid one at an operating point.
    The inset shows the contacts at 0.92 N to scale, in the colours of their levels.
    """
    found, published = levels(), paper()["fig3"]
    modulus = found.surface.material.composite_modulus
    load = LAST * np.linspace(0.002, 1.0, 300)
    law(ax, load, mf.friction_law(found.surface, load=modulus * load).area, forces=False, label="all levels")
    for i, label in enumerate(("level 1 alone", "levels 1 and 2")):
        beyond = np.linspace(found.loads[i], LAST, 100)
        area = mf.friction_law(found.upper(i + 1), load=modulus * beyond).area
        ax.plot(beyond, area, "--", color=LEVELS[i], label=label)
    for i, (x, y) in enumerate(zip(published["load_mm2"], published["friction_mm2"], strict=True)):
        ax.plot(x, y, "o", ms=9, color=LEVELS[i], label=f"operating point {i + 1}")
    name_law(ax, forces=False)
    ax.set_xlim(right=LAST)
    ax.legend(frameon=False, loc="lower right", fontsize=8)
    small, diameter = ax.inset_axes((0.04, 0.42, 0.36, 0.56)), 2.0 * np.sqrt(inset().asperity_area / np.pi)
    for i, colour in enumerate(LEVELS):
        on = found.number == i
        circles(small, found.surface.position[on], diameter[on]).set_facecolor(colour)
    low, high = found.surface.position.min() - 0.9, found.surface.position.max() + 0.9
    small.set(xlim=(low, high), ylim=(low, high), aspect="equal", xticks=[], yticks=[])
