"""The true block with the pedestals of its caps: what is left of the paper's laws.

The block has free sides and a bonded base, and each cap stands on it as a pedestal that yields. The two
corrections are of the same size and of opposite sign. The influence of the block takes half a minute for each
set of sites and is then read from disk.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem.contact import pedestal_compliance
from metafem.drawing import QUIET
from validation.check import Check, Claim, Picture, Result, near, reported, rms
from validation.figures import panels
from validation.methods import contact_equations
from validation.paper.pictures import INKS
from validation.paper.surfaces import LOADS, RADIUS, surfaces
from validation.sources import second_method

# The tests of this claim carry the mark "slow".
SLOW = True

MODELS = {
    "layer": mf.Interacting(substrate=mf.BondedLayer()),
    "block": mf.Interacting(substrate=mf.fe.Block3D()),
    "block with pedestals": mf.Interacting(substrate=mf.fe.Block3D(), pedestal=True),
}
WHOLE = "block with pedestals"

# What is recommended in place of the block, whose influence takes half a minute.
RECOMMENDED = {"layer with pedestals": mf.Interacting(substrate=mf.BondedLayer(), pedestal=True)}

# Solver and second method agree to rounding in sums of 64 terms.
ROUNDING = 1e-10

NEWTON = second_method(
    contact_equations.coupled,
    "Newton's method with numpy, pedestals on the diagonal of the block's influence",
)
METHOD = "order 3 on the block with pedestals, mf.fe.Block3D"


@cache
def law(name: str, model: str) -> mf.FrictionLaw:
    """Return the law of a surface under a model, or of independent asperities, at the loads."""
    surface = surfaces()[name]
    load = surface.material.composite_modulus * LOADS
    return mf.friction_law(surface, (MODELS | RECOMMENDED).get(model, mf.Independent()), load=load)


def change(name: str, model: str) -> np.ndarray:
    """Return the relative change of A0 by a model at the loads (k,)."""
    return law(name, model).area / law(name, "independent").area - 1.0


def claim() -> Claim:
    """The layer neglects the free sides of the block, and both neglect that a cap yields below its contact.
    With all of it together the laws of Figs. 4 and 5 change by {least_rms:.1f} to {most_rms:.1f} % rms, which
    is less than by the block alone. The law of Fig. 3 changes by more at the sites of this design; the paper
    does not print its sites. Its tall caps yield most, so that the third level comes into contact at a lower
    load. The compliance of the pedestals is that at light loads.
    """
    rows: list[Check | Result] = []
    for name in surfaces():
        rows += [*_changes(name), *_second(name)]
    changed = [100.0 * rms(change(name, WHOLE)) for name in surfaces() if "3" not in name]
    figures = {"change": Picture(_change_figure)}
    values = {"least_rms": min(changed), "most_rms": max(changed)}
    return Claim("Block with pedestals: what is left of the paper's laws", rows, figures, values)


def _changes(name: str) -> list[Result]:
    whole = change(name, WHOLE)
    lower = 1e3 * (law(name, "independent").separation - law(name, WHOLE).separation)
    return [
        reported(f"{name}: rms change of A0 by block and pedestals", rms(whole), METHOD),
        reported(f"{name}: rms change of A0 by the block alone", rms(change(name, "block")), METHOD),
        reported(f"{name}: rms change of A0 by the layer alone", rms(change(name, "layer")), METHOD),
        *(
            reported(f"{name}, {model}: largest relative difference of A0 from the block with pedestals",
                     np.abs(law(name, model).area / law(name, WHOLE).area - 1.0).max(), METHOD)
            for model in ("layer", "layer with pedestals")
        ),
        reported(f"{name}: largest change of A0", whole[np.abs(whole).argmax()], METHOD),
        reported(f"{name}: decrease of the separation at {LOADS[-1]:g} mm² [µm]", lower[-1], METHOD),
    ]  # fmt: skip


def _second(name: str) -> Iterator[Check]:
    """Compare order 1 at a light and a high load with Newton's method in numpy."""
    surface = surfaces()[name]
    influence = mf.fe.Block3D().influence_matrix(surface)
    influence[np.diag_indices_from(influence)] += pedestal_compliance(surface.height, surface.radius) / np.pi
    model = mf.Interacting(order=1, substrate=mf.fe.Block3D(), pedestal=True)
    for load in LOADS[[1, -1]]:
        area = contact_equations.coupled(surface.height, RADIUS, influence, float(load)).area
        found = mf.equilibrium(surface, model, load=surface.material.composite_modulus * load).area
        yield near(f"{name}, order 1, P/E* = {load:g} mm²: A0 [mm²]", found, area, ROUNDING * area, NEWTON)


@panels(8.4, 3.8, columns=2, sharey=True)
def _change_figure(left, right):
    """Change of A0(P) against independent asperities on the layer (dotted), on the block with free sides
    (dashed), and on the block with pedestals (solid). The pedestals bring the laws of Figs. 4 and 5 back
    towards zero.
    """
    for name in surfaces():
        ax = left if "3" in name else right
        for model, style in zip(MODELS, (":", "--", "-"), strict=True):
            label = name if model == WHOLE else None
            ax.plot(LOADS, 100.0 * change(name, model), style, color=INKS[name], label=label)
    for ax in (left, right):
        ax.axhline(0.0, color=QUIET, lw=0.8)
        ax.set_xlabel("rescaled load  P/E* [mm²]")
    left.set_ylabel("change of A0 [%]")
