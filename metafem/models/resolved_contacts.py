"""What each asperity carries of a resolved pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.models.resolved_grid import IntArray, Patch


@dataclass(frozen=True, eq=False)
class Contacts:
    """Loads and areas of the asperities, in units of the cell.

    Attributes
    ----------
    load : ndarray, (n,)
        Sum of p/E* over the cells on which the asperity is the highest.
    area : ndarray, (n,)
        ``5 pi sqrt(<x^2><y^2> - <xy>^2)`` of the pressure about its centroid; the number of cells
        where the contact has merged with another, which is no longer near an ellipse.
    merged : ndarray, (m, 2)
        Pairs of asperities whose contacts share an edge of a cell.
    """

    load: FloatArray
    area: FloatArray
    merged: IntArray


def measure(patches: list[Patch], pressure: list[FloatArray], count: int) -> Contacts:
    """Add up the pressure of each asperity and find contacts that have merged."""
    load, area, cells = np.zeros(count), np.zeros(count), np.zeros(count)
    pairs = []
    for place, p in zip(patches, pressure, strict=True):
        for i in np.unique(place.owner):
            own = np.where(place.owner == i, p, 0.0)
            load[i] = own.sum()
            cells[i] = np.count_nonzero(own)
            if load[i] > 0.0:
                area[i] = _ellipse(own / load[i])
        closed = p > 0.0
        for a, b in ((np.s_[1:, :], np.s_[:-1, :]), (np.s_[:, 1:], np.s_[:, :-1])):
            met = closed[a] & closed[b] & (place.owner[a] != place.owner[b])
            pairs.append(np.stack([place.owner[a][met], place.owner[b][met]], axis=1))
    merged = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)
    area[merged.ravel()] = cells[merged.ravel()]
    return Contacts(load, area, merged)


def _ellipse(density: FloatArray) -> float:
    """Area of the Hertzian ellipse with these second moments."""
    x, y = (np.arange(n, dtype=np.float64) for n in density.shape)
    along_x, along_y = density.sum(axis=1), density.sum(axis=0)
    x = x - along_x.dot(x)
    y = y - along_y.dot(y)
    xx, yy, xy = along_x.dot(x * x), along_y.dot(y * y), float(x @ density @ y)
    return 5.0 * math.pi * math.sqrt(max(xx * yy - xy**2, 0.0))
