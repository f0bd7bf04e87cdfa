"""One cell of an infinite lattice, compared with the lattice sum of the layer."""

from __future__ import annotations

import math

import numpy as np

from metafem import fe
from metafem import reference as exact
from validation.check import Claim, Picture
from validation.figures import panels
from validation.finite_elements.checks import PITCH, RADIUS, THICKNESS, cell_check

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """An infinite lattice of equal contacts, 1.5 mm apart on the bonded layer, is computed by finite elements
    of one cell, a cylinder without radial displacement at its wall. Its load is compared with Hertz's law in
    the curved field of the neighbours, and its indentation with the lattice sum of the layer's influence and
    with the series of the cylinder.
    """
    return Claim(
        "Finite elements: interaction in an infinite lattice",
        cell_check(),
        {"Stiffening by the neighbours": Picture(_figure)},
    )


@panels(5.0, 3.4)
def _figure(ax):
    """Load of one contact of the lattice over that of Hertz at the same contact radius, minus 1 [%], over the
    contact radius [mm]: finite elements of one cell (dots), and the curvature of the field of the neighbours
    (line). Neighbours stiffen a contact by 1 % where its radius is a fifth of the pitch.
    """
    a = np.linspace(0.08, 0.32, 7)
    side = PITCH / math.sqrt(math.pi)
    load = [fe.press(x, RADIUS, thickness=THICKNESS, cell_radius=side).rescaled_load for x in a.tolist()]
    _, curvature = exact.layer_lattice_sums(PITCH, THICKNESS, 0.5)
    fine = np.linspace(0.05, 0.33, 60)
    ax.plot(a, 100.0 * (np.array(load) / exact.hertz(a, RADIUS)[0] - 1.0), "o", label="one cell")
    bent = 1.0 / (1.0 - 2.0 / 3.0 * fine**3 * curvature)
    ax.plot(fine, 100.0 * (bent - 1.0), "k-", lw=0.8, label="curvature of the field of the neighbours")
    ax.set(xlabel="contact radius [mm]", ylabel="load over that of Hertz at the same a [%]")
