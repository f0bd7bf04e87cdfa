"""The influence of the bonded layer and of a lattice on it, compared with integral and sums."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from metafem import fe, reference
from validation.check import Check, Claim, Picture, near
from validation.figures import panels
from validation.finite_elements.frozen_meshes import PITCH, RADIUS, THICKNESS
from validation.sources import closed_form

# Several seconds of finite elements.
SLOW = True

# Contact radius of the load [mm], and distances from it; contact radii of a cell of the lattice.
LOADED, DISTANCES, RADII = 0.01, (0.5, 1.0, 1.5, 3.0, 5.0, 6.0, 10.0), (0.12, 0.20, 0.28)

INTEGRAL = "Hankel integral of the bonded layer, Johnson (1985), section 5.8, doi:10.1017/CBO9781139171731"
HANKEL = closed_form(reference.layer_influence, INTEGRAL)
CURVATURE = closed_form(
    reference.layer_lattice_sums, f"1/R + P S/2 with the curvature S of the lattice sum; {INTEGRAL}"
)
LATTICE = closed_form(reference.layer_lattice_sums, f"lattice sum of the layer's influence; {INTEGRAL}")
DINI = closed_form(reference.layer_cell, "Dini series of a cylinder on a rigid base")


def claim() -> Claim:
    """The models use the influence of a bonded layer of 7.2 mm, a Hankel integral: the displacement of the
    surface at a distance r from a load. Here it is computed by finite elements of a small contact, as a
    multiple of the influence of the half-space. An infinite lattice of equal contacts, 1.5 mm apart on the
    layer, is computed by finite elements of one cell, a cylinder without radial displacement at its wall. Its
    load is compared with Hertz's law in the curved field of the neighbours, and its indentation with the
    lattice sum of the layer's influence and with the series of the cylinder.
    """
    rows = [*(row for nu in (0.5, 0.49, 0.3) for row in _layer(nu)), *_cell()]
    return Claim(
        "Finite elements: the bonded layer, alone and in a lattice", rows, {"Influence": Picture(_figure)}
    )


def _layer(nu: float) -> Iterator[Check]:
    """Compare the influence with its Hankel integral."""
    contact = fe.press(LOADED, RADIUS, nu, thickness=THICKNESS)
    for r in DISTANCES:
        displacement = float(reference.hertz_displacement(np.array(r), LOADED, RADIUS))
        half_space = displacement / reference.hertz(LOADED, RADIUS)[0]
        exact = 1.0 + float(reference.layer_regular(r, THICKNESS, nu)) / half_space
        computed = float(contact.displacement(r)) / contact.rescaled_load / half_space
        yield near(f"ν = {nu}, r = {r} mm: layer over half-space", computed, exact, 1e-4, HANKEL)


def _cell() -> Iterator[Check]:
    """Compare a cell of the lattice with the layer's lattice sum and the cylinder's series."""
    side = PITCH / math.sqrt(math.pi)
    total, curvature = reference.layer_lattice_sums(PITCH, THICKNESS, 0.5)
    for a in RADII:
        contact = fe.press(a, RADIUS, thickness=THICKNESS, cell_radius=side)
        # effective radius R_i: 1/R_i = 1/R + P S/2, P = 4 a^3/(3 R_i), S = curvature due to the neighbours
        load, single = reference.hertz(a, RADIUS * (1.0 - 2.0 / 3.0 * a**3 * curvature))
        depth, where = contact.indentation, f"a = {a} mm"
        lattice = single + load * (total + 0.1 * a**2 * curvature)
        series = single + load * reference.layer_cell(a, side, THICKNESS, 0.5)
        yield near(
            f"{where}: load over Hertz's, sharpened", contact.rescaled_load / load, 1.0, 5e-4, CURVATURE
        )
        yield near(f"{where}: indentation over the lattice sum's", depth / lattice, 1.0, 5e-3, LATTICE)
        # the series' pressure is Hertz's only up to terms of order a^5
        yield near(f"{where}: indentation over the series'", depth / series, 1.0, 5e-4, DINI)


@panels(5.0, 3.4)
def _figure(ax):
    """Displacement at a distance r from a load on the layer, over that on a half-space, by finite elements
    (dots) and by the Hankel integral (line), at a Poisson's ratio of 0.5. The layer is stiffer than the
    half-space at all distances, and rises beside the load beyond 5.5 mm.
    """
    contact, r = fe.press(LOADED, RADIUS, thickness=THICKNESS), np.linspace(0.5, 20.0, 60)
    found = np.pi * r * contact.displacement(r) / contact.rescaled_load
    exact = np.pi * r * reference.layer_influence(r, THICKNESS, 0.5)
    ax.plot(r, found, ".", ms=4, label="finite elements")
    ax.plot(r, exact, "k-", lw=0.8, label="Hankel integral")
    ax.set(xlabel="r [mm]", ylabel="layer / half-space")
