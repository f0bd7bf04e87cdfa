"""Surfaces with a periodic cell."""

from __future__ import annotations

import numpy as np

import metafem as mf

PITCH, RADIUS, THICKNESS, MATERIAL = 1.5, 0.526, 7.2, mf.Material(1.36)

BLOCK = mf.Block(20.0, 20.0, THICKNESS)

SITES = np.array([[0.3, 0.4], [2.1, 0.6], [1.2, 2.0]])

THREE = mf.Surface(SITES, [0.1, 0.11, 0.12], RADIUS, MATERIAL, block=BLOCK, cell=mf.PeriodicCell(3.0, 3.0))


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
