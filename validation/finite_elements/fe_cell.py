"""One cell of an infinite lattice, compared with the lattice sum of the layer."""

from __future__ import annotations

import math

import numpy as np

from metafem import fe, studies
from metafem.drawing import new_figure
from metafem.reference import bonded_layer
from metafem.reference import single_contacts as exact
from metafem.studies.element_checks import PITCH, RADIUS, THICKNESS
from validation.check import Claim, of_elements

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """Compare load and indentation at three contact radii."""
    return Claim(
        "Finite elements: interaction in an infinite lattice",
        of_elements(studies.cell_check()),
        {"stiffening": _figure},
    )


def _figure():
    figure = new_figure(5.0, 3.4)
    ax = figure.add_subplot()
    a = np.linspace(0.08, 0.32, 7)
    side = PITCH / math.sqrt(math.pi)
    load = [fe.press(x, RADIUS, thickness=THICKNESS, cell_radius=side).rescaled_load for x in a.tolist()]
    _, curvature = bonded_layer.lattice_sums(PITCH, THICKNESS, 0.5)
    fine = np.linspace(0.05, 0.33, 60)
    ax.plot(a, 100.0 * (np.array(load) / exact.hertz(a, RADIUS)[0] - 1.0), "o", label="one cell")
    bent = 1.0 / (1.0 - 2.0 / 3.0 * fine**3 * curvature)
    ax.plot(fine, 100.0 * (bent - 1.0), "k-", lw=0.8, label="curvature of the field of the neighbours")
    ax.set(xlabel="contact radius [mm]", ylabel="load over that of Hertz at the same a [%]")
    ax.legend(frameon=False)
    return figure
