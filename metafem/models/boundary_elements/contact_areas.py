"""Load and contact area of each asperity from a resolved pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.models.boundary_elements.patches import IntArray, Patch

# The moments of a pressure (1 - rho^2)^m on an ellipse determine m; Hertz's is 1/2. Where m differs from it
# by more than this, the area from the second moments has an error of 0.2 % (measured on thin layers).
EXPONENT_RANGE = 0.01

# With n cells per radius m is shifted by about 1.3/n^2 (measured on one Hertz contact); a shift of up to
# twice that is within the discretisation error.
EXPONENT_BY_CELL = 2.6

# With collocation the pressure extends this far beyond the edge, in cells (measured on one Hertz contact with
# 12 to 100 cells per radius).
RIM = 0.115


@dataclass(frozen=True, eq=False)
class Contacts:
    """Loads and areas of the asperities, in units of the cell.

    Attributes
    ----------
    load : ndarray, (n,)
        Sum of p/E* over the cells on which the asperity is the highest.
    area : ndarray, (n,)
        ``5 pi sqrt(<x^2><y^2> - <xy>^2)`` of the pressure about its centroid, where that is Hertzian;
        otherwise the number of its cells, corrected for the cells that collocation adds along the rim.
    counted : ndarray, (n,)
        Whether the area is a number of cells.
    merged : ndarray, (m, 2)
        Pairs of asperities whose contacts share an edge of a cell.
    """

    load: FloatArray
    area: FloatArray
    counted: NDArray[np.bool_]
    merged: IntArray


def measure(patches: list[Patch], pressure: list[FloatArray], count: int) -> Contacts:
    """Add up the pressure of each asperity and find contacts that have merged."""
    load, area, cells = np.zeros(count), np.zeros(count), np.zeros(count)
    counted = np.zeros(count, dtype=bool)
    pairs = []
    for place, p in zip(patches, pressure, strict=True):
        closed = p > 0.0
        for a, b in ((np.s_[1:, :], np.s_[:-1, :]), (np.s_[:, 1:], np.s_[:, :-1])):
            met = closed[a] & closed[b] & (place.owner[a] != place.owner[b])
            pairs.append(np.stack([place.owner[a][met], place.owner[b][met]], axis=1))
        for i in np.unique(place.owner[closed]):
            own = np.where(place.owner == i, p, 0.0)
            load[i] = own.sum()
            cells[i] = _counted(own > 0.0, closed)
            area[i], exponent = _ellipse(own / load[i])
            # a radius of n cells: n^2 = area / pi
            slack = EXPONENT_RANGE + EXPONENT_BY_CELL * math.pi / max(area[i], 1.0)
            counted[i] = abs(exponent - 0.5) > slack
    merged = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)
    counted[merged.ravel()] = True
    return Contacts(load, np.where(counted, cells, area), counted, merged)


def _ellipse(density: FloatArray) -> tuple[float, float]:
    """Area of the Hertzian ellipse with these second moments, and the exponent m of the fourth.

    For (1 - rho^2)^m the squared Mahalanobis distance s has ``<s^2> = 8 (m + 2)/(m + 3)``.
    """
    x, y = (np.arange(n, dtype=np.float64) for n in density.shape)
    along_x, along_y = density.sum(axis=1), density.sum(axis=0)
    x = (x - (along_x * x).sum())[:, None]
    y = (y - (along_y * y).sum())[None, :]
    xx, yy, xy = (float((density * z).sum()) for z in (x * x, y * y, x * y))
    square = xx * yy - xy**2
    if square <= 0.0:
        return 0.0, 0.5
    distance = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / square
    q = float((density * distance**2).sum()) / 4.0
    return 5.0 * math.pi * math.sqrt(square), (3.0 * q - 4.0) / (2.0 - q)


def _counted(own: NDArray[np.bool_], closed: NDArray[np.bool_]) -> float:
    """Number of cells of an asperity minus the rim, whose length is pi/4 of the outer edges of the cells."""
    inner = np.pad(closed, 1)
    open_edges = sum(
        np.count_nonzero(own & ~side)
        for side in (inner[2:, 1:-1], inner[:-2, 1:-1], inner[1:-1, 2:], inner[1:-1, :-2])
    )
    return max(np.count_nonzero(own) - RIM * 0.25 * math.pi * open_edges, 0.0)
