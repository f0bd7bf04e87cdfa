"""A periodic cell against sums over its periods, copies of it and the unit cell of finite elements."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.reference import bonded_layer
from validation.check import Claim, Picture, Row, below
from validation.figures import panels
from validation.methods.lattice_images import image_sum
from validation.scenes.periodic import (
    PITCH,
    RADII,
    RADIUS,
    THREE,
    copies_error,
    repeated,
    unit_cell_error,
)
from validation.sources import second_method

# The 225 copies take some seconds.
SLOW = True

# A thin layer, whose influence ends within a few periods, and its Poisson's ratio [mm], [-].
THICKNESS, POISSON, SIDES = 1.0, 0.3, (6.0, 2.0)
PLACES = ((0.6, 0.04), (-2.7, 0.6), (3.0, 1.0))

# Distance beyond which the influence of the layer is below 1e-9 of its largest value, over its thickness.
REACH = 40.0

IMAGES = second_method(image_sum, "sum over the periods, with the layer's influence by quadrature")
ELEMENTS = second_method(mf.fe.press, "finite elements of one unit cell, whose wall has no shear")
COPIES = second_method(mf.Interacting, "the same cell in the middle of 15 x 15 copies without a cell")


def claim() -> Claim:
    """A surface may be one period of an infinite one. The sums over all periods are compared with the same
    sums added one by one, equal asperities with a unit cell of finite elements, and a cell of three unequal
    asperities with many copies of it.
    """
    return Claim("Periodic cells", list(_rows()), {"A cell and its copies": Picture(_figure)})


def influence(distance: FloatArray) -> FloatArray:
    """Return the influence of the thin layer [1/mm] by Hankel's integral, without the package's tables."""
    regular = bonded_layer.regular_influence(distance, THICKNESS, POISSON)
    return np.asarray(1.0 / (math.pi * distance) + regular)


def _rows() -> Iterator[Row]:
    layer = mf.BondedLayer(THICKNESS, POISSON)
    for x, y in PLACES:
        found = float(layer.periodic(mf.PeriodicCell(*SIDES), np.array([x]), np.array([y])).value[0])
        error = abs(found / image_sum(influence, SIDES, x, y, REACH * THICKNESS) - 1.0)
        yield below(f"relative error of the sum over all periods at ({x:g}, {y:g}) mm", error, 1e-6, IMAGES)
    for radius in RADII:
        name = f"equal asperities, a/L = {radius / PITCH:.2f}: relative error of P(a)"
        yield below(name, abs(unit_cell_error(radius)), 5e-4, ELEMENTS)
    yield below(
        "three asperities on a layer of 1 mm: largest relative error of a load", copies_error(), 1e-6, COPIES
    )


@panels(6.0, 3.4)
def _figure(ax):
    """Difference of the load of the middle one of n x n equal asperities from that of a periodic cell, at
    the separation of the cell, on layers of two thicknesses. The effect of the missing periods falls
    exponentially with their distance over the thickness.
    """
    cell, counts = mf.PeriodicCell(PITCH, PITCH), (1, 3, 5, 7, 9, 13, 17, 25)
    for thickness in (7.2, 1.5):
        block = mf.Block(60.0, 60.0, thickness)
        one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, THREE.material, block=block, cell=cell)
        model = mf.Interacting(substrate=mf.BondedLayer())
        alone = mf.equilibrium(one, model, load=0.02)  # [N]
        loads = [
            mf.equilibrium(repeated(one, n).replaced(cell=None), model, separation=alone.separation)
            .asperity_load[n * n // 2] for n in counts
        ]  # fmt: skip
        off = 100.0 * np.abs(np.array(loads) / alone.load - 1.0)
        ax.semilogy(counts, off, "o-", ms=3, label=f"layer of {thickness:g} mm")
    ax.set_xlabel("n")
    ax.set_ylabel("difference [%]")
    ax.legend(frameon=False)
