"""Slopes of Figs. 4 and 5 by three contact laws, beside the measured ones.

The paper fits σ to friction forces in full contact, with the areas of Hertz's law. The same forces give
another σ with the areas of another law. All slopes are those of F over P in the paper's units, F/(σB) and
P/E* with its σ and E*, so that the measured ones stay as they are printed.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

import metafem as mf
from metafem.drawing import MEASURED, TARGET
from validation.check import Row, near, reported
from validation.figures import panels
from validation.methods import independent, tabulated_contacts
from validation.paper.surfaces import RADIUS, designs, surfaces
from validation.published import paper
from validation.sources import second_method

FloatArray = NDArray[np.float64]

# The paper's adhesion energy [N/mm].
ENERGY = paper()["sample"]["adhesion_energy_mJ_per_m2"] * 1e-6

ADHESION = "w = 9 mJ/m²"
LAWS: dict[str, mf.Contact] = {"Hertz": mf.Hertz(), "spheres": mf.Elastic(), ADHESION: mf.JKR(ENERGY)}

PRINTED, REFITTED = "σ as printed", "σ refitted"
CASES = (
    ("Hertz", PRINTED), ("spheres", PRINTED), ("spheres", REFITTED),
    (ADHESION, PRINTED), (ADHESION, REFITTED),
)  # fmt: skip

# Loads of the fit of σ over the load at which the lowest asperity touches, and those of two fits at one load:
# the paper prints no range.
FULL, ENDS = tuple(np.linspace(1.0, 2.0, 21)), (1.0, 3.0)

# Largest contact radius of the tables of the second method [mm], and their relative accuracy with a margin.
LARGEST, METHODS = 0.45, 1e-5

SECOND = second_method(
    tabulated_contacts.areas, "closed forms of one contact as tables, summed over the heights"
)
SIGMA = "F = σ B A0 by least squares, loads from full contact to twice that load, with the areas of both laws"
SLOPE = "line through F(P) of independent asperities over the range of the design's fit"


@cache
def branches() -> dict[str, tuple[str, FloatArray, float, float]]:
    """Return surface, loads of the fit, measured slope and standard deviation; of Fig. 5 target and 5.2 %."""
    printed, found = paper(), {}
    within = printed["fig5"]["measured_within"]
    for name, design in designs().items():
        for i, (branch, _) in enumerate(design.fits, 1):
            if _linear(name):
                measured = printed["fig4"][name.split()[-1]]["measured_slope"]
                found[name] = (name, branch.load, *measured)
            else:
                found[f"{name}, slope {i}"] = (name, branch.load, branch.slope, within * branch.slope)
    return found


def area(surface: str, law: str, load: FloatArray) -> FloatArray:
    """Return A0 [mm²] at loads over E* [mm²]."""
    found = surfaces()[surface]
    newtons = found.material.composite_modulus * load
    return mf.friction_law(found, mf.Independent(contact=LAWS[law]), load=newtons).area


def tabulated(surface: mf.Surface, law: str, load: FloatArray) -> FloatArray:
    """Return the same areas by the second method, for spheres or a law such as "w = 9 mJ/m²"."""
    if law == "spheres":
        table = tabulated_contacts.sphere(RADIUS, LARGEST)
    else:
        energy, modulus = 1e-6 * float(law.split()[2]), surface.material.composite_modulus
        table = tabulated_contacts.adhesive(energy, modulus, RADIUS, LARGEST)
    return tabulated_contacts.areas(table, surface.height, load)


def full_contact(surface: str, over: tuple[float, ...] = FULL) -> FloatArray:
    """Return the loads [mm²] at which σ is fitted, multiples of that at which the lowest asperity touches."""
    height = surfaces()[surface].height
    return np.array(over) * independent.sums(height - height.min(), RADIUS)[1]


def refitted(hertz: FloatArray, other: FloatArray) -> float:
    """Return σ fitted with other areas over σ with those of Hertz's law, by the same forces."""
    return float(hertz @ other / (other @ other))


@cache
def strength(surface: str, law: str, over: tuple[float, ...] = FULL) -> float:
    """Return σ of a law over the printed one."""
    load = full_contact(surface, over)
    return refitted(area(surface, "Hertz", load), area(surface, law, load))


@cache
def slope(branch: str, law: str, case: str) -> float:
    """Return a predicted slope in the units of the measured one."""
    surface, load, *_ = branches()[branch]
    sigma = 1.0 if case == PRINTED else strength(surface, law)
    return sigma * float(np.polyfit(load, area(surface, law, load), 1)[0])


def deviation(branch: str, law: str, case: str) -> float:
    """Return the difference in standard deviations for Fig. 4, and from the target in percent for Fig. 5."""
    *_, wanted, error = branches()[branch]
    found = slope(branch, law, case)
    return (found - wanted) / error if _linear(branch) else 1e2 * (found / wanted - 1.0)


def compared() -> Iterator[Row]:
    """Return the ratios of σ, the slopes, and their differences from the measured ones."""
    for law in LAWS:
        if law != "Hertz":
            yield from (
                _sigma(surface, law) for surface in dict.fromkeys(each[0] for each in branches().values())
            )
            yield from (_slope(branch, law) for branch in branches())
    yield from (_deviation(branch, *case) for case in CASES for branch in branches())
    yield from (_at_one_load(branch, over) for branch in branches() if _linear(branch) for over in ENDS)


def _sigma(surface: str, law: str) -> Row:
    load, made = full_contact(surface), surfaces()[surface]
    second = refitted(independent.areas(made.height, load, RADIUS), tabulated(made, law, load))
    name = f"{surface}, {law}: σ refitted over σ as printed"
    return near(name, strength(surface, law), second, METHODS, SECOND)


def _slope(branch: str, law: str) -> Row:
    surface, load, *_ = branches()[branch]
    second = float(np.polyfit(load, tabulated(surfaces()[surface], law, load), 1)[0])
    found = slope(branch, law, PRINTED)
    return near(f"{branch}, {law}, {PRINTED}: slope", found, second, METHODS * second, SECOND)


def _deviation(branch: str, law: str, case: str) -> Row:
    *_, wanted, error = branches()[branch]
    words = (
        f"slope minus the measured {wanted:g} ± {error:g} [s.d.]"
        if _linear(branch)
        else f"slope over its target {wanted:g}, minus 1 [%]"
    )
    method = f"{slope(branch, law, case):.4g}; {SLOPE}" + ("" if case == PRINTED else f"; σ: {SIGMA}")
    return reported(f"{branch}, {law}, {case}: {words}", deviation(branch, law, case), method)


def _at_one_load(branch: str, over: float) -> Row:
    """Report how much the answer depends on the loads at which σ is fitted."""
    surface, _, wanted, error = branches()[branch]
    found = strength(surface, ADHESION, over=(over,)) * slope(branch, ADHESION, PRINTED)
    words = f"σ refitted at {over:g} times the load of full contact: slope minus the measured one [s.d.]"
    return reported(f"{branch}, {ADHESION}, {words}", (found - wanted) / error, f"{found:.4g}; {SLOPE}")


def _linear(branch: str) -> bool:
    return branch.startswith("Fig. 4")


def answers() -> dict[str, Any]:
    """Return the numbers that the text of the claim states."""
    linear, bilinear = ([name for name in branches() if _linear(name) == kind] for kind in (True, False))
    less = [1e2 * (1.0 - strength(each[0], ADHESION)) for each in branches().values()]
    high, low, hertz = (
        # 0.0 has no sign
        [f"{round(deviation(name, *case), 1) + 0.0:.1f}" for name in linear]
        for case in ((ADHESION, PRINTED), (ADHESION, REFITTED), ("Hertz", PRINTED))
    )
    cases = (("Hertz", PRINTED), (ADHESION, REFITTED))
    fifth = [max(abs(deviation(name, *case)) for name in bilinear) for case in cases]
    return {"high": high, "low": low, "hertz": hertz, "less": (min(less), max(less)), "fifth": fifth}


@panels(8.0, 3.8)
def picture(ax) -> None:
    """Predicted slopes over the measured ones of Fig. 4, with the printed standard deviations (bars), and
    over the targets of Fig. 5, which the measured slopes meet within 5.2 % (bars). Open symbols: σ as
    printed. Filled symbols: σ of the same forces in full contact. JKR's theory with w = 9 mJ/m² (triangles)
    lies above all bars with σ as printed, and on those of Fig. 4 with σ refitted; of Fig. 5 it then exceeds
    both second slopes, by more than Hertz's law (circles) does.
    """
    place = np.arange(len(branches()))
    wanted, error = np.array([each[2:] for each in branches().values()]).T
    ax.errorbar(place - 0.36, np.ones(len(place)), error / wanted, fmt="k_", capsize=3, label="measured")
    marks = {"Hertz": ("o", TARGET), "spheres": ("s", "C2"), ADHESION: ("^", MEASURED)}
    for k, (law, case) in enumerate(CASES):
        marker, colour = marks[law]
        value = [slope(name, law, case) for name in branches()]
        ax.plot(
            place + 0.1 * (k - 2), value / wanted, marker, color=colour, label=f"{law}, {case}",
            mfc="none" if case == PRINTED else colour,
        )  # fmt: skip
    ax.axhline(1.0, color="grey", lw=0.6)
    ax.set_xticks(place, [name.replace(", ", ",\n") for name in branches()], fontsize=8)
    ax.set_ylabel("slope over the measured one or its target")
    ax.legend(frameon=False, fontsize=8, ncols=2)
