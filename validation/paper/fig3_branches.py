"""Fig. 3: the continuations of the branches, and the contacts at 0.92 N.

Without the lower levels of heights the law would follow the dashed lines of the figure. Each joins the law of
the whole surface at an operating point, where the plane reaches the next level.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import circles, law, name_law
from validation.check import Check, Claim, Picture, Result, below, near, reported
from validation.figures import panels
from validation.methods import contact_equations
from validation.paper.pictures import LEVELS
from validation.paper.surfaces import RADIUS, fig3
from validation.published import paper
from validation.sources import known_input, printed, second_method

# Loads P/E* [mm²] up to which the figure is drawn; the last operating point is at 0.649.
LAST = 0.75

# Area and load of solver and bisection agree to rounding in sums over 58 asperities.
ROUNDING = 1e-10

# Distance of the plane from a level, over the indentation of the asperities above, at which slopes are
# evaluated; the new contacts change the slope by its square root, times the kink: below 1e-3 of it.
NEAR = 1e-9

ALL = known_input("all asperities of a level above the plane: n_i + 1, with the printed n_i")
SAME = known_input("identity: up to the operating point the lower levels are open")
KINK = known_input("identity dA0/dP = (π√R/2) n/Σ√d: n grows by the new contacts at the same Σ√d")
SUMS = second_method(contact_equations.independent, "bisection of the sums of eq. S1 with numpy")
METHOD = "independent Hertz contacts, mf.equilibrium"


@dataclass(frozen=True)
class Levels:
    """The designed surface, the level of each asperity (n,) from 0 on, and loads of the operating points."""

    surface: mf.Surface
    number: np.ndarray
    loads: np.ndarray

    def upper(self, count: int) -> mf.Surface:
        """Return the surface with its first levels only, each with its adjustment asperity."""
        kept = self.number < count
        fields = {name: getattr(self.surface, name)[kept] for name in ("position", "height", "radius")}
        return self.surface.replaced(**fields)


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
    """The surface of Fig. 3 has three levels of heights. The law of its first level alone, and that of its
    first two, are the dashed lines of the figure. The paper prints no numbers for them, and shows the
    contacts at 0.92 N as a photograph: the sites of the heights in it are not printed, so that the inset
    below has the counts and sizes of the contacts, at sites chosen by this design.
    """
    return Claim(
        "Fig. 3: continued branches, and contacts at 0.92 N",
        [*_continuations(), *_contacts()],
        {"branches": Picture(_branches)},
    )


def _continuations() -> Iterator[Check | Result]:
    found = levels()
    modulus = found.surface.material.composite_modulus
    for i, load in enumerate(found.loads[:-1]):
        part, name = found.upper(i + 1), f"continuation {i + 1}"
        shared = load * np.linspace(0.02, 1.0, 50)
        whole, alone = (mf.friction_law(s, load=modulus * shared).area for s in (found.surface, part))
        before, after = (_slope_beside(part, found.surface, load, side) for side in (-1.0, 1.0))
        new = np.count_nonzero(found.number == i + 1) - 1  # all but the adjustment asperity, which is lower
        last = float(found.loads[-1])
        area = mf.equilibrium(part, load=modulus * last).area
        by_sums = contact_equations.independent(part.height, RADIUS, last).area
        loss = area / mf.equilibrium(found.surface, load=modulus * last).area - 1.0
        where = f"up to operating point {i + 1}"
        yield below(f"{name}, {where}: largest difference of A0 from the law",
                    np.abs(alone / whole - 1.0).max(), 1e-12, SAME)  # fmt: skip
        yield near(f"kink of the law at operating point {i + 1}: slope after over slope before",
                   after / before, kink := (part.count + new) / part.count, 1e-3 * kink, KINK)  # fmt: skip
        yield near(f"{name} at P/E* = {last} [mm²]: F/σB [mm²]", area, by_sums, ROUNDING * by_sums, SUMS)
        yield reported(f"{name} at P/E* = {last} [mm²]: F/σB missing from the law [%]", 1e2 * loss, METHOD)


def _slope_beside(part: mf.Surface, whole: mf.Surface, load: float, side: float) -> float:
    """Return dA0/d(P/E*) of the whole surface just before (-1) or after (1) the load of a part's point."""
    modulus = whole.material.composite_modulus
    plane = mf.equilibrium(part, load=modulus * load).separation
    step = NEAR * (whole.height.max() - plane)
    first, second = (mf.equilibrium(whole, separation=plane - side * factor * step) for factor in (1.0, 2.0))
    return modulus * (second.area - first.area) / (second.load - first.load)


def _contacts() -> Iterator[Check | Result]:
    found, state, published = levels(), inset(), paper()["fig3"]
    rescaled = state.load / found.surface.material.composite_modulus
    inset_load = f"{published['inset_load_N']} N"
    yield reported(f"{inset_load}: P/E* [mm²]", rescaled, "load of the inset over E* of batch 1")
    for i, count in enumerate(published["counts"]):
        on = (found.number == i) & (state.asperity_area > 0.0)
        radius = 1e3 * np.sqrt(state.asperity_area[on] / np.pi)
        name = f"level {i + 1} at {inset_load}"
        yield near(f"{name}: contacts, with the adjustment asperity",
                   np.count_nonzero(on), count + 1, 0, ALL)  # fmt: skip
        yield reported(f"{name}: area [mm²]", float(state.asperity_area[on].sum()), METHOD)
        yield reported(f"{name}: contact radius [µm]", float(radius.max()), METHOD)
        yield reported(f"{name}: contact radius of the adjustment asperity [µm]", float(radius.min()), METHOD)
    largest = float(1e3 * np.sqrt(state.asperity_area.max() / np.pi))
    area = contact_equations.independent(found.surface.height, RADIUS, rescaled).area
    yield near(f"A0 at {inset_load} [mm²]", state.area, area, ROUNDING * area, SUMS)
    calibrated = printed("SM, calibration of individual microcontacts, largest calibrated radius")
    yield below(f"largest contact radius at {inset_load} [µm]", largest,
                paper()["sample"]["max_contact_radius_um"], calibrated)  # fmt: skip


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
    for i in range(2):
        beyond = np.linspace(found.loads[i], LAST, 100)
        area = mf.friction_law(found.upper(i + 1), load=modulus * beyond).area
        label = "level 1 alone" if i == 0 else "levels 1 and 2"
        ax.plot(beyond, area, "--", color=LEVELS[i], label=label)
    for i, (x, y) in enumerate(zip(published["load_mm2"], published["friction_mm2"], strict=True)):
        ax.plot(x, y, "o", ms=9, color=LEVELS[i], label=f"operating point {i + 1}")
    name_law(ax, forces=False)
    ax.set_xlim(right=LAST)
    ax.legend(frameon=False, loc="lower right", fontsize=8)
    small = ax.inset_axes((0.04, 0.42, 0.36, 0.56))
    _draw_contacts(small)
    small.set(xticks=[], yticks=[])


def _draw_contacts(ax) -> None:
    """Draw contacts to scale in the colours of their levels, with a bar of 1.5 mm."""
    found, diameter = levels(), 2.0 * np.sqrt(inset().asperity_area / np.pi)
    for i, colour in enumerate(LEVELS):
        on = found.number == i
        circles(ax, found.surface.position[on], diameter[on]).set_facecolor(colour)
    low, high = found.surface.position.min(axis=0), found.surface.position.max(axis=0)
    ax.set(xlim=(low[0] - 0.9, high[0] + 0.9), ylim=(low[1] - 1.3, high[1] + 0.9), aspect="equal")
    pitch = paper()["sample"]["lattice_pitch_mm"]
    ax.plot([low[0], low[0] + pitch], 2 * [low[1] - 0.85], color="black", lw=2.5)
    ax.annotate(f"{pitch} mm", (low[0] + 1.1 * pitch, low[1] - 0.85), va="center", fontsize=7)
