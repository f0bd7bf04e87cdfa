"""The contacts at the loads of the photographs in Figs. 3 to 5, as independent and as interacting ones.

Neither counts nor areas are printed beside them.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, reduce
from operator import getitem

import numpy as np

import metafem as mf
from metafem.drawing import circles, plan
from validation.check import Check, Claim, Picture, Result, near, reported
from validation.figures import panels
from validation.methods import contact_equations
from validation.paper.pictures import INKS
from validation.paper.surfaces import RADIUS, surfaces
from validation.published import paper
from validation.sources import second_method

MODELS = {
    "independent": mf.Independent(),
    "layer, order 1": mf.Interacting(order=1, substrate=mf.BondedLayer()),
    "layer, order 3": mf.Interacting(substrate=mf.BondedLayer()),
}

# Solver and second method agree to rounding in their sums, and the influences to their quadratures.
EXACT, QUADRATURE = 1e-10, 1e-8

SUMS = second_method(contact_equations.independent, "bisection of the sums of eq. S1 with numpy")
NEWTON = second_method(
    contact_equations.coupled, "Newton's method for point loads on the layer, its influence by quadrature"
)


@cache
def state(name: str, model: str) -> mf.ContactState:
    """Return the contacts of a surface at the load of its photograph."""
    return mf.equilibrium(surfaces()[name], MODELS[model], load=load(name))


def load(name: str) -> float:
    """Return the load of the photograph of a surface [N]."""
    places = name.lower().replace(". ", "").split()
    return float(reduce(getitem, places, paper())["inset_load_N"])


def claim() -> Claim:
    """The paper shows photographs of the contacts at these loads: 0.92 N (Fig. 3), 0.39 N (Fig. 4, blue),
    0.93 N (Fig. 4, red), 0.34 N (Fig. 5, blue) and 0.23 N (Fig. 5, red). The models predict that on the
    surfaces of Figs. 4 and 5 all 64 asperities are then in contact, down to the lowest. The paper prints no
    sites: here those of Fig. 5 are Table S2 numbered row by row, the others those of the design. Interaction
    depends on them, independent asperities do not.
    """
    rows = [row for name in surfaces() for row in _rows(name)]
    return Claim("Contacts at the loads of the photographs", rows, {"contacts": Picture(_picture)})


def _rows(name: str) -> Iterator[Check | Result]:
    height, rescaled = surfaces()[name].height, load(name) / surfaces()[name].material.composite_modulus
    influence = contact_equations.influence(surfaces()[name], "layer")
    methods = {
        "independent": (SUMS, EXACT, contact_equations.independent(height, RADIUS, rescaled)),
        "layer, order 1": (
            NEWTON,
            QUADRATURE,
            contact_equations.coupled(height, RADIUS, influence, rescaled),
        ),
    }
    for model, (source, tolerance, contacts) in methods.items():
        found, label, area = state(name, model), f"{name}, {load(name)} N, {model}", contacts.area
        yield near(
            f"{label}: contacts", _count(found), np.count_nonzero(contacts.indentation > 0.0), 0, source
        )
        yield near(f"{label}: A0 [mm²]", found.area, area, tolerance * area, source)
        yield near(f"{label}: separation [µm]", 1e3 * found.separation, 1e3 * contacts.separation,
                   1e3 * tolerance * RADIUS, source)  # fmt: skip
    found, alone = state(name, "layer, order 3"), state(name, "independent")
    radii = 1e3 * np.sqrt(found.asperity_area[found.asperity_area > 0.0] / np.pi)
    label, method = f"{name}, {load(name)} N, layer, order 3", "mf.Interacting(substrate=mf.BondedLayer())"
    yield reported(f"{label}: contacts", _count(found), method)
    yield reported(f"{label}: A0 [mm²]", found.area, method)
    yield reported(f"{label}: change of A0 by interaction [%]", 1e2 * (found.area / alone.area - 1.0), method)
    yield reported(f"{label}: smallest contact radius [µm]", float(radii.min()), method)
    yield reported(f"{label}: largest contact radius [µm]", float(radii.max()), method)


def _count(found: mf.ContactState) -> int:
    return int(np.count_nonzero(found.asperity_area))


@panels(8.4, 6.0, rows=2, columns=3)
def _picture(*axes):
    """Contacts at the loads of the paper's photographs, to scale, on the bonded layer at order 3. Compare the
    mixture of large and small spots: few large ones on Fig. 3, a gradual decrease of the sizes on Figs. 4 and
    5.
    """
    for ax, name in zip(axes, surfaces(), strict=False):
        found = state(name, "layer, order 3")
        dots = circles(ax, surfaces()[name].position, 2.0 * np.sqrt(found.asperity_area / np.pi))
        dots.set_facecolor(INKS[name])
        plan(ax)
        ax.set_title(f"{name}, {load(name)} N: {_count(found)} contacts", fontsize=9)
    axes[-1].set_axis_off()
