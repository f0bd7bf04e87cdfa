"""A0(P) and the separation on a half-space and on a bonded layer, compared with the true block.

Zeka et al., arXiv:2604.08195, ask how the arrangement of the asperities and the size of their base change the
law. The influence of the block takes half a minute for each set of sites and is then read from disk.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem import reference
from validation.check import Claim, Picture, Row, below, reported
from validation.figures import panels
from validation.methods import contact_equations
from validation.paper.pictures import INKS
from validation.paper.surfaces import RADIUS, surfaces
from validation.sources import closed_form, known_input, second_method

# The tests of this claim carry the mark "slow".
SLOW = True

# Loads P/E* [mm²] of the compared laws.
LOADS = np.linspace(0.05, 0.5, 19)

SUBSTRATES = {"half-space": mf.HalfSpace(), "layer": mf.BondedLayer(), "block": mf.fe.Block3D()}

# A block so wide that its sides lie 5 thicknesses from the loads, whose field has decayed there, with larger
# cells [thicknesses].
WIDE, CELLS = 90.0, {"cell": 0.4, "edge_cell": 0.05}

# Accuracies: influences of the layer and of meshes [1/mm], of which the smallest on the lattice is 4e-3; both
# solvers, relative.
LAYER, INFLUENCE, SOLVERS = 1e-5, 5e-5, 1e-9

BETTI = known_input("identity: displacement at i by a load on j is that at j by a load on i (Betti)")
MESHES = second_method(mf.fe.Block3D, "the same with cells that are 1.6 times as large")
NEWTON = second_method(contact_equations.coupled, "point loads with numpy, Newton's method in all unknowns")
ORDER3 = "order 3, 19 loads P/E* from 0.05 to 0.5 mm²; block by 3D finite elements"


@cache
def law(name: str, substrate: str, order: int) -> mf.FrictionLaw:
    """Law of one surface on one substrate, or of independent asperities, at the loads."""
    surface = surfaces()[name]
    coupled = mf.Interacting(order=order, substrate=SUBSTRATES.get(substrate, mf.HalfSpace()))
    model = mf.Independent() if substrate == "none" else coupled
    return mf.friction_law(surface, model, load=LOADS * surface.material.composite_modulus)


def difference(name: str, substrate: str, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Relative difference of A0 [-] and separation on the block minus that on a substrate [µm], (k,)."""
    found, block = law(name, substrate, order), law(name, "block", order)
    return found.area / block.area - 1.0, 1e3 * (block.separation - found.separation)


def claim() -> Claim:
    """The law and the separation are predicted on a half-space, on a bonded layer and on the true block (20 ×
    20 × 7.2 mm, bonded base, free sides), whose influence is computed by 3D finite elements. The influence of
    a wide block is the Hankel integral of the layer, and the laws at order 1 are solved a second time with
    numpy. In A0(P) the layer differs from the block by at most 0.4 %, the half-space by at most 0.7 % on
    Figs. 4 and 5 and 1.9 % on Fig. 3. In the separation the half-space is off by up to 25 µm, the layer by 3
    µm: use the layer or the block for P(δ).
    """
    rows = [*_influence(), *_second(), *_order3()]
    figures = {"Differences from the block": Picture(_differences)}
    return Claim("Half-space, layer or true block", rows, figures)


def _influence() -> list[Row]:
    """Check the influence of the block against the layer, a coarser mesh, and reciprocity."""
    surface = surfaces()["Fig. 5 red"]
    wide = surface.replaced(block=mf.Block(WIDE, WIDE, surface.block.thickness))
    error = np.abs(mf.fe.Block3D(**CELLS).influence_matrix(wide) - _matrix(surface, "layer")).max()
    block = mf.fe.Block3D().solution(surface)
    hankel = closed_form(reference.layer_influence, "Hankel integral of the bonded layer")
    return [
        below(f"block of {WIDE:g} mm, 64 sites: largest error of the influence [1/mm]",
              error, LAYER, hankel),
        below("block of 20 mm, 64 sites: largest change of the influence with the mesh [1/mm]",
              block.error_estimate, INFLUENCE, MESHES),
        below("block of 20 mm, 64 sites: largest asymmetry of the influence [1/mm]",
              block.asymmetry, 1e-9, BETTI),
    ]  # fmt: skip


def _second() -> Iterator[Row]:
    """Solve the laws at order 1 a second time, at every load."""
    for name in ("Fig. 5 blue", "Fig. 5 red"):
        surface = surfaces()[name]
        for substrate in SUBSTRATES:
            found, influence = law(name, substrate, 1), _matrix(surface, substrate)
            second = [contact_equations.coupled(surface.height, RADIUS, influence, p) for p in LOADS.tolist()]
            _, plane, area = map(np.array, zip(*second, strict=True))
            label, off = f"{name}, {substrate}, order 1", np.abs(found.separation - plane).max() / RADIUS
            worst = np.abs(found.area / area - 1.0).max()
            yield below(f"{label}: largest relative error of A0", worst, SOLVERS, NEWTON)
            yield below(f"{label}: largest error of the separation over R", off, SOLVERS, NEWTON)


def _matrix(surface: mf.Surface, substrate: str) -> np.ndarray:
    """Influence (n, n) [1/mm]: of the half-space and the layer by the second method, of the block its own."""
    if substrate == "block":
        return mf.fe.Block3D().influence_matrix(surface)
    return contact_equations.influence(surface, substrate)


def _order3() -> Iterator[Row]:
    """Report the differences of the five surfaces at order 3."""
    for name in surfaces():
        fall = 1e2 * (law(name, "block", 3).area / law(name, "none", 3).area - 1.0)
        yield reported(f"{name}: largest change of A0 on the block [%]", fall[np.abs(fall).argmax()], ORDER3)
        for substrate in ("half-space", "layer"):
            area, plane = difference(name, substrate, 3)
            label = f"{name}, {substrate}"
            yield reported(f"{label}: largest relative difference of A0 from the block",
                           np.abs(area).max(), ORDER3)  # fmt: skip
            yield reported(f"{label}: largest difference of separation [µm]", np.abs(plane).max(), ORDER3)


@panels(8.4, 3.6, columns=2)
def _differences(left, right) -> None:
    """Left: A0 on the half-space (dashed) and on the layer (solid) relative to the block [%], over the
    rescaled load P/E* [mm²], at order 3 on the five surfaces. Right: separation on the block minus that on
    the other substrate [µm]. The half-space is off by up to 25 µm and the layer by up to 3 µm.
    """
    for name in surfaces():
        for substrate, style in (("half-space", "--"), ("layer", "-")):
            area, plane = difference(name, substrate, 3)
            label = name if substrate == "layer" else None
            left.plot(LOADS, 100.0 * area, style, color=INKS[name], label=label)
            right.plot(LOADS, plane, style, color=INKS[name])
    left.set(xlabel="rescaled load  P/E* [mm²]", ylabel="difference of A0 from the true block [%]")
    right.set(xlabel="rescaled load  P/E* [mm²]", ylabel="separation on the block minus this one [µm]")
    for style, substrate in (("--", "half-space"), ("-", "layer")):
        right.plot([], [], style, color="black", label=substrate)
