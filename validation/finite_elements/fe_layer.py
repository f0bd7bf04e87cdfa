"""The influence of the bonded layer, compared with its Hankel integral."""

from __future__ import annotations

import numpy as np

from metafem import fe, studies
from metafem.drawing import new_figure
from metafem.reference import bonded_layer
from metafem.studies.element_checks import RADIUS, THICKNESS
from validation.check import Claim, of_elements

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """Compare at distances up to the block's half-width, for three Poisson ratios."""
    checks = [row for nu in (0.5, 0.49, 0.3) for row in of_elements(studies.layer_check(nu))]
    return Claim("Finite elements: the bonded layer's influence", checks, {"influence": _figure})


def _figure():
    figure = new_figure(5.0, 3.4)
    ax = figure.add_subplot()
    contact = fe.press(0.01, RADIUS, thickness=THICKNESS)
    r = np.linspace(0.5, 20.0, 60)
    ax.plot(
        r, np.pi * r * contact.displacement(r) / contact.rescaled_load, ".", ms=4, label="finite elements"
    )
    ax.plot(r, np.pi * r * bonded_layer.influence(r, THICKNESS, 0.5), "k-", lw=0.8, label="Hankel integral")
    ax.set(xlabel="r [mm]", ylabel="layer / half-space")
    ax.legend(frameon=False)
    return figure
