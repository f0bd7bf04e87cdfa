"""Surfaces with a periodic cell, and their errors against the unit cell of finite elements and copies."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

import metafem as mf

PITCH, RADIUS, THICKNESS, MATERIAL = 1.5, 0.526, 7.2, mf.Material(1.36)

BLOCK = mf.Block(20.0, 20.0, THICKNESS)

ONE = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL, block=BLOCK, cell=mf.PeriodicCell(PITCH, PITCH))

SITES = np.array([[0.3, 0.4], [2.1, 0.6], [1.2, 2.0]])

THREE = mf.Surface(SITES, [0.1, 0.11, 0.12], RADIUS, MATERIAL, block=BLOCK, cell=mf.PeriodicCell(3.0, 3.0))

# Contact radii [mm], and thickness of the layer whose influence ends within seven periods of `THREE` [mm].
RADII, THIN = (0.12, 0.16, 0.20, 0.24, 0.28), 1.0

# Load on `THREE` [N], with a/r up to .17; numbers of cells along a period for the extrapolation.
LOAD, COUNTS = 0.1, (256, 512)


def repeated(surface: mf.Surface, times: int) -> mf.Surface:
    """Return `times` x `times` periods side by side, in a cell as many times as large."""
    cell = surface.cell
    assert cell is not None
    steps = np.stack(np.meshgrid(np.arange(times), np.arange(times)), axis=-1).reshape(-1, 1, 2)
    return surface.replaced(
        position=(surface.position + steps * [cell.width, cell.length]).reshape(-1, 2),
        height=np.tile(surface.height, times**2),
        radius=np.tile(surface.radius, times**2),
        cell=mf.PeriodicCell(times * cell.width, times * cell.length),
    )


def unit_cell_error(contact_radius: float) -> float:
    """Return the relative error of P(a) of order 3 against the unit cell of the finite elements."""
    elements = mf.fe.press(
        contact_radius=contact_radius,
        radius=RADIUS,
        poisson_ratio=MATERIAL.poisson_ratio,
        thickness=THICKNESS,
        cell_radius=PITCH / math.sqrt(math.pi),
    )
    model, expected = mf.Interacting(substrate=mf.BondedLayer()), elements.rescaled_load

    def missing(load: float) -> float:
        area = model.curve(ONE, np.array([load])).area[0]
        return math.sqrt(area / math.pi) - contact_radius

    return float(brentq(missing, 0.9 * expected, 1.1 * expected, xtol=1e-14)) / expected - 1.0


def copies_error() -> float:
    """Return the largest relative difference of the loads from those in the middle of 15 x 15 copies."""
    thin = THREE.replaced(block=mf.Block(60.0, 60.0, THIN))
    model = mf.Interacting(substrate=mf.BondedLayer())
    alone = mf.equilibrium(thin, model, load=LOAD)
    copies = repeated(thin, 15).replaced(cell=None)
    many = mf.equilibrium(copies, model, separation=alone.separation).asperity_load.reshape(-1, 3)[112]
    return float(np.abs(many / alone.asperity_load - 1.0).max())


def extrapolated(values: list[float]) -> float:
    """Return the value at cells of zero size, from the last two numbers of cells, of second order."""
    ratio = (COUNTS[1] / COUNTS[0]) ** 2
    return values[1] + (values[1] - values[0]) / (ratio - 1.0)
