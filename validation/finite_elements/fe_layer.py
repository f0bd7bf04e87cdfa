"""The influence of the bonded layer, compared with its Hankel integral."""

from __future__ import annotations

import numpy as np

from metafem import fe, reference
from validation.check import Claim, Picture
from validation.figures import panels
from validation.finite_elements.checks import RADIUS, THICKNESS, layer_check

# Several seconds of finite elements.
SLOW = True


def claim() -> Claim:
    """The models use the influence of a bonded layer of 7.2 mm, a Hankel integral: the displacement of the
    surface at a distance r from a load. Here it is computed by finite elements of a small contact, and
    compared at seven distances and three Poisson's ratios, as a multiple of the influence of the half-space.
    """
    checks = [row for nu in (0.5, 0.49, 0.3) for row in layer_check(nu)]
    figures = {"Influence of the layer": Picture(_figure)}
    return Claim("Finite elements: the bonded layer's influence", checks, figures)


@panels(5.0, 3.4)
def _figure(ax):
    """Displacement at a distance r from a load on the layer, over that on a half-space, by finite elements
    (dots) and by the Hankel integral (line), at a Poisson's ratio of 0.5. The layer is stiffer than the
    half-space at all distances, and rises beside the load beyond 5.5 mm.
    """
    contact = fe.press(0.01, RADIUS, thickness=THICKNESS)
    r = np.linspace(0.5, 20.0, 60)
    ax.plot(
        r, np.pi * r * contact.displacement(r) / contact.rescaled_load, ".", ms=4, label="finite elements"
    )
    ax.plot(
        r,
        np.pi * r * reference.layer_influence(r, THICKNESS, 0.5),
        "k-",
        lw=0.8,
        label="Hankel integral",
    )
    ax.set(xlabel="r [mm]", ylabel="layer / half-space")
