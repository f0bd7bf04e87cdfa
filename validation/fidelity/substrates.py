"""A0(P) and P(δ) on half-space, layer and true block, with and without the pedestals of the caps.

Zeka et al., arXiv:2604.08195, ask how the arrangement of the asperities and the size of their base change the
law. The influence of the block takes half a minute for each set of sites and is then read from disk.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem import reference
from metafem.contact import pedestal_compliance
from validation.check import Claim, Picture, Row, below, reported, rms
from validation.figures import panels
from validation.methods.contact_equations import coupled, influence
from validation.paper.pictures import INKS
from validation.paper.surfaces import LOADS, RADIUS, surfaces
from validation.sources import closed_form, second_method

# The tests of this claim carry the mark "slow".
SLOW = True

SUBSTRATES = {"half-space": mf.HalfSpace(), "layer": mf.BondedLayer(), "block": mf.fe.Block3D()}
PEDESTALS = " with pedestals"
MODELS = (*SUBSTRATES, f"layer{PEDESTALS}", f"block{PEDESTALS}")

# A block so wide that its sides lie 5 thicknesses from the loads, whose field has decayed there, with larger
# cells [thicknesses].
WIDE, CELLS = 90.0, {"cell": 0.4, "edge_cell": 0.05}

# Accuracies: influences of the layer and of meshes [1/mm], of which the smallest on the lattice is 4e-3; both
# solvers and the quadrature of the layer's influence, relative.
LAYER, INFLUENCE, SOLVERS = 1e-5, 5e-5, 1e-7

MESHES = second_method(mf.fe.Block3D, "the same with cells that are 1.6 times as large")
HANKEL = closed_form(reference.layer_influence, "Hankel integral of the bonded layer")
NEWTON = second_method(coupled, "Newton's method in all unknowns, with influences of metafem")

# The layer counts as a model of the block if it at least halves the error of the half-space.
HALF = 0.5

METHOD = "order 3, 20 loads P/E* to 0.7 mm²; the block by 3D finite elements"
AT_PLANES = "order 3, at the separations of independent contacts under 20 loads P/E* to 0.7 mm²"


def model(name: str, order: int = 3) -> mf.Interacting:
    """Return the model of a substrate, with pedestals or without."""
    return mf.Interacting(order, SUBSTRATES[name.removesuffix(PEDESTALS)], pedestal=name.endswith(PEDESTALS))


@cache
def law(name: str, chosen: str = "") -> mf.FrictionLaw:
    """Return the law of a surface under a model, or of independent asperities, at the loads."""
    surface = surfaces()[name]
    load = surface.material.composite_modulus * LOADS
    return mf.friction_law(surface, model(chosen) if chosen else mf.Independent(), load=load)


@cache
def at_planes(name: str, chosen: str) -> np.ndarray:
    """Return loads [N] at the separations of independent asperities."""
    return mf.friction_law(surfaces()[name], model(chosen), separation=law(name).separation).load


def change(name: str, chosen: str, other: str = "") -> np.ndarray:
    """Return the relative change of A0 at the loads (k,) from another model to a chosen one."""
    return law(name, chosen).area / law(name, other).area - 1.0


def claim() -> Claim:
    """The five surfaces are predicted on a half-space, on a bonded layer and on the true block (20 × 20 × 7.2
    mm, bonded base, free sides), whose influence is computed by 3D finite elements, and with caps that yield
    below their contacts as pedestals. Interaction mostly lowers the base as a whole, which changes the
    separation, but A0(P) hardly. The pedestals even out the loads and change A0(P) the other way. To predict
    P(δ), use the layer or the block: the half-space has no rigid base 7.2 mm below the contacts, and sinks
    several times too far.
    """
    rows = [row for name in surfaces() for row in (_second(name), *_areas(name), *_planes(name))]
    figures = {"Changes of A0(P)": Picture(_figure)}
    return Claim("Half-space, layer or true block", [*_influence(), *rows], figures)


def _influence() -> Iterator[Row]:
    """Check the influence of the block against the layer, a coarser mesh, and reciprocity."""
    surface = surfaces()["Fig. 5 red"]
    wide = surface.replaced(block=mf.Block(WIDE, WIDE, surface.block.thickness))
    error = np.abs(mf.fe.Block3D(**CELLS).influence_matrix(wide) - influence(surface, "layer")).max()
    (_, _, change), name = mf.fe.Block3D().solution(surface), "block of {:g} mm, 64 sites: largest {} [1/mm]"
    yield below(name.format(WIDE, "error of the influence"), error, LAYER, HANKEL)
    yield below(name.format(20, "change with the mesh"), change, INFLUENCE, MESHES)


def _second(name: str) -> Row:
    """Solve order 1 of every model a second time, at a light and at the last load."""
    surface, worst = surfaces()[name], 0.0
    for chosen in MODELS:
        substrate = chosen.removesuffix(PEDESTALS)
        matrix = model(chosen).substrate.influence_matrix(surface) if substrate == "block" else None
        matrix = influence(surface, substrate) if matrix is None else matrix.copy()
        if chosen.endswith(PEDESTALS):
            own = pedestal_compliance(surface.height, surface.radius) / np.pi
            matrix[np.diag_indices_from(matrix)] += own
        for load in LOADS[[1, -1]].tolist():
            second = coupled(surface.height, RADIUS, matrix, load)
            newtons = load * surface.material.composite_modulus
            found = mf.equilibrium(surface, model(chosen, order=1), load=newtons)
            off = abs(found.separation - second.separation) / RADIUS
            worst = max(worst, abs(found.area / second.area - 1.0), off)
    words = "order 1, five models: largest relative error of A0, and of the separation over R"
    return below(f"{name}, {words}", worst, SOLVERS, NEWTON)


def _areas(name: str) -> Iterator[Row]:
    """Report the rms changes of A0(P), and the largest differences from the block."""
    for chosen in MODELS:
        yield reported(f"{name}, {chosen}: rms change of A0", rms(change(name, chosen)), METHOD)
    added = rms(change(name, f"layer{PEDESTALS}", "layer"))
    yield reported(f"{name}: rms change of A0 by the pedestals", added, METHOD)
    for chosen, exact in (
        ("half-space", "block"), ("layer", "block"),
        ("layer", f"block{PEDESTALS}"), (f"layer{PEDESTALS}", f"block{PEDESTALS}"),
    ):  # fmt: skip
        most = np.abs(change(name, chosen, exact)).max()
        where = "block alone" if exact == "block" else exact
        yield reported(f"{name}, {chosen}: largest relative difference of A0 from the {where}", most, METHOD)


def _planes(name: str) -> Iterator[Row]:
    """Report the differences of P(δ) and of the separation from the block."""
    block, errors = at_planes(name, "block"), []
    rescaled = block / surfaces()[name].material.composite_modulus
    yield reported(f"{name}, block: rms change of P(δ) [%]", 1e2 * rms(rescaled / LOADS - 1.0), AT_PLANES)
    for chosen in ("half-space", "layer"):
        errors.append(rms(at_planes(name, chosen) / block - 1.0))
        yield reported(f"{name}, {chosen} against block: rms error of P(δ) [%]", 1e2 * errors[-1], AT_PLANES)
        apart = 1e3 * np.abs(law(name, "block").separation - law(name, chosen).separation).max()
        yield reported(f"{name}, {chosen}: largest difference of separation [µm]", apart, METHOD)
    exact = second_method(mf.fe.Block3D, "influence of the block by 3D finite elements")
    yield below(f"{name}: error of P(δ), layer over half-space", errors[1] / errors[0], HALF, exact)


@panels(8.4, 3.8, columns=2, sharey=True)
def _figure(left, right):
    """Change of A0(P) against independent asperities on the layer (dotted), on the block with free sides
    (dashed), and on the block with pedestals (solid). The pedestals bring the laws of Figs. 4 and 5 back
    towards zero.
    """
    styles = {"layer": ":", "block": "--", f"block{PEDESTALS}": "-"}
    for name in surfaces():
        ax = left if "3" in name else right
        for chosen, style in styles.items():
            label = name if style == "-" else None
            ax.plot(LOADS, 1e2 * change(name, chosen), style, color=INKS[name], label=label)
    for ax in (left, right):
        ax.axhline(0.0, color="grey", lw=0.8)
        ax.set_xlabel("rescaled load  P/E* [mm²]")
    left.set_ylabel("change of A0 [%]")
