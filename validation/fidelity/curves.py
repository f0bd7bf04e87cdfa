"""A0(P), P(δ) and A0(δ) of the paper's surfaces, under independent and three interacting models.

The influence of the block takes half a minute for each set of sites and is then read from disk.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

import metafem as mf
from validation.check import Check, Claim, Picture, Result, below, near, reported, rms
from validation.figures import panels
from validation.methods import contact_equations
from validation.paper.surfaces import LOADS, RADIUS, surfaces
from validation.sources import second_method

# The tests of this claim carry the mark "slow".
SLOW = True

MODELS = {
    "independent": mf.Independent(),
    "half-space": mf.Interacting(),
    "layer": mf.Interacting(substrate=mf.BondedLayer()),
    "block": mf.Interacting(substrate=mf.fe.Block3D()),
}
SUBSTRATES = ("half-space", "layer", "block")
CURVES = ("A0(P)", "P(δ)", "A0(δ)")
STYLES = {"independent": "k-", "half-space": "C0--", "layer": "C1-.", "block": "C3-"}

# Solver and second method agree to rounding in sums of 64 terms; lengths relative to the radius.
ROUNDING = 1e-10

NEWTON = second_method(contact_equations.coupled, "Newton's method for point loads with numpy")
BLOCK = second_method(mf.fe.Block3D, "influence of the block by 3D finite elements")
METHOD = "20 loads, or the separations of independent contacts at them; order 3"


class Curves(NamedTuple):
    """A0 and separation at the loads, and P/E* and A0 at the separations, (k,)."""

    area: np.ndarray
    separation: np.ndarray
    load_there: np.ndarray
    area_there: np.ndarray


@cache
def curves(name: str, model: str) -> Curves:
    """Return the curves of a surface under a model."""
    surface = surfaces()[name]
    modulus = surface.material.composite_modulus
    by_load = mf.friction_law(surface, MODELS[model], load=modulus * LOADS)
    if model == "independent":
        return Curves(by_load.area, by_load.separation, LOADS, by_load.area)
    planes = curves(name, "independent").separation
    there = mf.friction_law(surface, MODELS[model], separation=planes)
    return Curves(by_load.area, by_load.separation, there.rescaled_load, there.area)


def claim() -> Claim:
    """The paper compares its independent contacts with a model of elastic interaction and finds that P(δ) and
    A0(δ) change, but A0(P) hardly. The reason is that interaction mostly lowers the base as a whole, which
    changes the separation and nothing else. On the block A0(P) changes by {min_area:.1f} to
    {max_area:.1f} % rms, P(δ) by {min_load:.0f}
    to {max_load:.0f} %. To predict P(δ), use the true block or the layer: the half-space has no rigid base
    7.2 mm below the contacts, the array sinks several times too far on it, and P(δ) errs by {min_wrong:.0f}
    to {max_wrong:.0f} % rms, on the layer by {min_flat:.0f} to {max_flat:.0f} %.
    """
    rows: list[Check | Result] = []
    for name in surfaces():
        rows += [*_changes(name), *_second(name)]
    rows += [*_largest(), *_against_block()]
    found = {
        "area": [rms(_change(name, "block")[0]) for name in surfaces()],
        "load": [rms(_change(name, "block")[1]) for name in surfaces()],
        "wrong": [rms(_to_block(name, "half-space")) for name in surfaces()],
        "flat": [rms(_to_block(name, "layer")) for name in surfaces()],
    }
    values = {f"{end.__name__}_{key}": end(each) for key, each in found.items() for end in (min, max)}
    figures = {"curves": Picture(_curves_figure)}
    return Claim("A0(P), P(δ) and A0(δ) under four models", rows, figures, values)


def _changes(name: str) -> Iterator[Result]:
    for model in SUBSTRATES:
        yield from (
            reported(f"{name}, {model}: rms change of {label} [%]", rms(values), METHOD)
            for label, values in zip(CURVES, _change(name, model), strict=True)
        )


def _largest() -> Iterator[Result]:
    """Report the largest change of each curve at one load or separation, over the five surfaces."""
    for model in SUBSTRATES:
        for k, label in enumerate(CURVES):
            values = np.concatenate([_change(name, model)[k] for name in surfaces()])
            found = float(values[np.abs(values).argmax()])
            yield reported(f"five surfaces, {model}: largest change of {label} [%]", found, METHOD)


def _against_block() -> list[Check | Result]:
    """State how wrong P(δ) is on the half-space and on the layer."""
    half_space, layer = (
        {name: rms(_to_block(name, model)) for name in surfaces()} for model in ("half-space", "layer")
    )
    name = "five surfaces, half-space against block: largest rms error of P(δ) [%]"
    return [
        reported(name, max(half_space.values()), METHOD),
        *(
            reported(f"{name}, {model} against block: rms error of P(δ) [%]", found[name], METHOD)
            for name in surfaces()
            for model, found in (("half-space", half_space), ("layer", layer))
        ),
        below("five surfaces: largest error of P(δ), layer over half-space",
              max(layer[name] / half_space[name] for name in surfaces()), 0.5, BLOCK),
    ]  # fmt: skip


def _second(name: str) -> Iterator[Check]:
    """Compare the separations of order 1 with those of Newton's method in numpy, at the tenth load."""
    surface, load = surfaces()[name], float(LOADS[9])
    for label, influence in (
        ("half-space", contact_equations.influence(surface, "half-space")),
        ("block", mf.fe.Block3D().influence_matrix(surface)),
    ):
        plane = contact_equations.coupled(surface.height, RADIUS, influence, load).separation
        model = mf.Interacting(order=1, substrate=MODELS[label].substrate)
        found = mf.equilibrium(surface, model, load=load * surface.material.composite_modulus).separation
        yield near(f"{name}, {label}, order 1: separation at {load:g} mm² [µm]",
                   1e3 * found, 1e3 * plane, 1e3 * ROUNDING * RADIUS, NEWTON)  # fmt: skip


def _change(name: str, model: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the changes of A0(P), P(δ) and A0(δ) against independent contacts, (k,) [%]."""
    first, found = curves(name, "independent"), curves(name, model)
    return (
        1e2 * (found.area / first.area - 1.0),
        1e2 * (found.load_there / first.load_there - 1.0),
        1e2 * (found.area_there / first.area_there - 1.0),
    )


def _to_block(name: str, model: str) -> np.ndarray:
    """Return the difference of P(δ) from that on the block, (k,) [%]."""
    return 1e2 * (curves(name, model).load_there / curves(name, "block").load_there - 1.0)


@panels(9.0, 3.4, columns=3)
def _curves_figure(left, middle, right):
    """Fig. 5, blue. Left: the four curves A0(P) coincide within the width of the lines. Middle and right: at
    a given separation the half-space (dashed) has about half of the load and
    area of independent contacts; layer and block are close to each other.
    """
    for model, style in STYLES.items():
        found = curves("Fig. 5 blue", model)
        plane = 1e3 * curves("Fig. 5 blue", "independent").separation
        left.plot(LOADS, found.area, style, label=model)
        middle.plot(plane, found.load_there, style)
        right.plot(plane, found.area_there, style)
    left.set(xlabel="rescaled load  P/E* [mm²]", ylabel="A0 [mm²]")
    middle.set(xlabel="separation δ [µm]", ylabel="P/E* [mm²]")
    right.set(xlabel="separation δ [µm]", ylabel="A0 [mm²]")
