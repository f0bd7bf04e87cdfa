"""Extreme inputs: other units, equal heights, one asperity, radii of 1 to 1000, light loads, thin layers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import QUIET
from metafem.models import Model
from metafem.reference import single_contacts
from validation.check import Check, Claim, Picture, below, near, reported
from validation.figures import panels
from validation.methods.equation_errors import equation_error
from validation.sources import closed_form, known_input, self_consistency

MATERIAL = mf.Material(1.36)
RADIUS, CELL = 0.526, 0.02

# Factors of lengths and moduli, height differences over R, and the ratio of two radii.
FACTORS, DIFFERENCE, RATIO = (1e-6, 1e6), 1e-12, 1000.0

# Loads from this part of that at which the plane reaches the base plane.
LIGHTEST, LOADS = 1e-12, 49

# Contact radius over the thickness of the layers, and Poisson's ratios.
THIN, RATIOS = (0.9, 2.0, 5.0), (0.0, 0.5)

# Relative errors: rounding of a solution to 1e-12, the same of cells to 1e-9, and that of a height difference
# of 1e-12 R over the indentation of about 0.05 R.
ROUNDING, CELLS_ROUNDING, SHIFTED = 1e-11, 1e-8, 1e-9

# Error of the area of one contact by cells of 1/25 of its radius that BoundaryElements states, 0.37/n^2.
BY_CELLS = 6e-4

MODELS: dict[str, Model] = {
    "independent": mf.Independent(),
    "order 1": mf.Interacting(order=1),
    "order 3": mf.Interacting(),
    "order 3, layer": mf.Interacting(substrate=mf.BondedLayer()),
    "automatic": mf.Automatic(),
    "resolved": mf.BoundaryElements(CELL),
}

SCALED = known_input("the same scene in other units: lengths or moduli multiplied by 1e-6 and 1e6")
EQUAL = known_input("the same scene with equal heights")
HERTZ = closed_form(single_contacts.hertz, "Hertz: P = 4/3 E* a³/R, A = πa²")
RECOMPUTED = self_consistency(equation_error, "the equations in plain numpy, without the compiled kernels")
RISING = known_input("requirement: A0 grows with the load, without a step back")
SAID = known_input("requirement: a solution, or a refusal with words")


def scene(length: float = 1.0, modulus: float = 1.0, below_top: float = 0.01) -> mf.Surface:
    """Return four asperities on a block in units of length and modulus."""
    height = length * (0.2 - below_top * np.array([0.0, 1.0, 3.0, 2.0]))
    return mf.Surface.square_lattice(
        height, (2, 2), length, radius=RADIUS * length, material=mf.Material(1.36 * modulus, 0.5),
        block=mf.Block(20.0 * length, 20.0 * length, 7.2 * length),
    )  # fmt: skip


def in_units(model: Model, length: float) -> Model:
    """Return a model in another unit of length."""
    return mf.BoundaryElements(CELL * length) if isinstance(model, mf.BoundaryElements) else model


def rescaled(model: Model) -> float:
    """Return the largest relative change of A0 by other units."""
    area = mf.equilibrium(scene(), model, load=0.1).area
    found = []
    for factor in FACTORS:
        longer = mf.equilibrium(scene(length=factor), in_units(model, factor), load=0.1 * factor**2)
        stiffer = mf.equilibrium(scene(modulus=factor), model, load=0.1 * factor)
        found += [longer.area / factor**2 / area - 1.0, stiffer.area / area - 1.0]
    return float(np.abs(found).max())


def nearly_equal(model: Model) -> float:
    """Return the relative change of A0 by height differences of 1e-12 R."""
    equal, other = (scene(below_top=below_top) for below_top in (0.0, DIFFERENCE * RADIUS))
    area = mf.equilibrium(equal, model, load=0.1).area
    return abs(mf.equilibrium(other, model, load=0.1).area / area - 1.0)


def lone(model: Model) -> float:
    """Return the relative error of A0 of one asperity on a half-space."""
    radius = 0.5
    load = MATERIAL.composite_modulus * single_contacts.hertz(radius, 10.0)[0]
    surface = mf.Surface([[0.0, 0.0]], [0.2], 10.0, MATERIAL)
    return abs(mf.equilibrium(surface, model, load=load).area / (math.pi * radius**2) - 1.0)


@cache
def decades(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return loads [N] over twelve decades up to that of the base plane, and A0 [mm²] of four asperities."""
    load = mf.equilibrium(scene(), separation=0.0).load * np.geomspace(LIGHTEST, 1.0, LOADS)
    return load, mf.friction_law(scene(), MODELS[name], load=load).area


def lightest(name: str) -> float:
    """Return the relative error of A0 at the lightest load, where the tallest asperity alone touches."""
    load, area = decades(name)
    radius = np.sqrt(area[0] / math.pi)
    return abs(MATERIAL.composite_modulus * single_contacts.hertz(radius, RADIUS)[0] / load[0] - 1.0)


def unequal(model: Model) -> float:
    """Return the error of the equations of two asperities with radii of 1 to 1000."""
    surface = mf.Surface([[0.0, 0.0], [20.0, 0.0]], [0.02, 0.02], [10.0, 10.0 / RATIO], MATERIAL,
                         block=mf.Block(60.0, 20.0, 7.2))  # fmt: skip
    error = equation_error(surface, model, model.curve(surface, np.array([1e-4])))
    return 0.0 if error is None else error


@cache
def thin(width: float, poisson_ratio: float) -> tuple[str, str]:
    """Return how order 3 and Automatic end on a layer of a thickness of 1/width contact radii."""
    thickness = 0.1
    surface = mf.Surface([[0.0, 0.0]], [0.3], 10.0, mf.Material(1.0, poisson_ratio),
                         block=mf.Block(20.0, 20.0, thickness))  # fmt: skip
    load = mf.equilibrium(surface, approach=(width * thickness) ** 2 / 10.0).load
    ends = []
    for model in (mf.Interacting(substrate=mf.BondedLayer()), mf.Automatic(1e-2, mf.BondedLayer())):
        try:
            ends.append(mf.equilibrium(surface, model, load=load).model.name)
        except mf.MetafemError as error:
            ends.append(f"refused: {error}")
    return ends[0], ends[1]


def claim() -> Claim:
    """All models give the same areas in other units, with heights that are equal or differ by less than can
    be made, with one asperity and over twelve decades of load. On layers thinner than the contacts order 3
    refuses and says what to use; Automatic resolves these contacts.
    """
    ends = {f"a/t = {w:g}, ν = {r:g}": thin(w, r) for w in THIN for r in RATIOS}
    thinner = sum(first.startswith("refused") for first, _ in ends.values())
    rows = [*_checks(ends), reported("thin layers that order 3 refuses", thinner, f"of {len(ends)} layers")]
    figures = {"twelve decades of load": Picture(_decades_figure)}
    return Claim("Extreme inputs", rows, figures)


def _checks(ends: dict[str, tuple[str, str]]) -> Iterator[Check]:
    for name, model in MODELS.items():
        cells = isinstance(model, mf.BoundaryElements)
        rounding = CELLS_ROUNDING if cells else ROUNDING
        yield below(f"{name}: change of A0 by units of 1e-6 and 1e6", rescaled(model), rounding, SCALED)
        yield below(f"{name}: change of A0 by height differences of 1e-12 R", nearly_equal(model),
                    CELLS_ROUNDING if cells else SHIFTED, EQUAL)  # fmt: skip
        if "layer" not in name:
            yield below(f"{name}: error of A0 of one asperity", lone(model),
                        BY_CELLS if cells else ROUNDING, HERTZ)  # fmt: skip
        if not cells and name != "automatic":
            _, area = decades(name)
            back = int((np.diff(area) <= 0.0).sum())
            yield near(f"{name}: loads over twelve decades at which A0 does not grow", back, 0, 0, RISING)
            yield below(f"{name}: error of the load at A0 of the lightest load", lightest(name), 1e-9, HERTZ)
            yield below(f"{name}: error of the equations with radii of 1 to 1000", unequal(model),
                        ROUNDING, RECOMPUTED)  # fmt: skip
    refused = sum(second.startswith("refused") for _, second in ends.values())
    yield near("layers thinner than the contacts that Automatic refuses", refused, 0, 0, SAID)


@panels(6.4, 3.8)
def _decades_figure(ax):
    """A0 of four asperities over twelve decades of load, from the contact of the tallest alone, which is
    Hertz's (grey line), to the load at which the plane reaches the base plane.
    """
    load, _ = decades("independent")
    radius = np.cbrt(0.75 * load * RADIUS / MATERIAL.composite_modulus)
    ax.loglog(load, math.pi * radius**2, color=QUIET, lw=3.0, label="Hertz, one asperity")
    for name in ("independent", "order 3", "order 3, layer"):
        ax.loglog(*decades(name), lw=1.2, label=name)
    ax.set(xlabel="load  P [N]", ylabel="A0 [mm²]")
