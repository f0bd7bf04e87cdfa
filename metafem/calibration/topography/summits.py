"""Search for caps on a height map, and initial guesses of their spheres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from metafem._validate import FloatArray
from metafem.calibration.topography.caps import Cap
from metafem.calibration.topography.cells import Cells
from metafem.calibration.topography.levelled import Levelling

# Smallest height of a cap above the base plane, in robust standard deviations of the cells' means.
ABOVE = 6.0

# Smallest number of cells of a cap, twice the number of unknowns. Smaller hills are assumed to be dust.
FEWEST = 8

# Largest ratio between the radius of a cap and the radius of the design.
RADIUS_FACTOR = 2.0

# The initial guess of a sphere is fitted to the cells above this fraction of the height of a hill, which
# excludes its foot.
UPPER = 0.3


def hills(
    found: Cells, levelling: Levelling, lowest: float, radius: float
) -> tuple[NDArray[np.bool_], list[Cap], list[tuple[float, float]]]:
    """Return a mask of the cells on hills, initial guesses of caps, and the centres of other hills [mm].

    The mask includes a margin. `lowest` is the smallest height of a cap, `radius` the radius of the design
    [mm].
    """
    x, y = np.meshgrid(found.x, found.y)
    above = found.mean - levelling.base(x, y)
    with np.errstate(invalid="ignore"):
        high = above > max(ABOVE * levelling.sd, lowest)
    # close holes in the flanks
    closed = ndimage.binary_closing(high, iterations=2) | high
    label, _ = ndimage.label(closed, np.ones((3, 3)))
    starts, other = [], []
    for number, window in enumerate(ndimage.find_objects(label), 1):
        own = (label[window] == number) & np.isfinite(above[window])
        at = x[window][own], y[window][own], above[window][own]
        guess = _sphere(*at) if own.sum() >= FEWEST else None
        if guess is not None and radius / RADIUS_FACTOR <= guess.radius <= radius * RADIUS_FACTOR:
            starts.append(guess)
        else:
            other.append((float(at[0].mean()), float(at[1].mean())))
    # margin: one cell for the foot of a hill below the threshold, and one for the closing
    return np.asarray(ndimage.binary_dilation(closed, np.ones((3, 3)), iterations=2)), starts, other


def _sphere(x: FloatArray, y: FloatArray, z: FloatArray) -> Cap | None:
    """Return the least-squares sphere ``|p|^2 - 2 c p - (R^2 - |c|^2) = 0``, or None if invalid."""
    upper = z > UPPER * z.max()
    if upper.sum() < FEWEST:
        return None
    middle = np.array([x[upper].mean(), y[upper].mean(), 0.0])
    points = np.column_stack([x[upper], y[upper], z[upper]]) - middle
    matrix = np.column_stack([2.0 * points, np.ones(len(points))])
    solved = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    centre, square = solved[:3], solved[3] + (solved[:3] ** 2).sum()
    if square <= 0.0:
        return None
    radius = float(np.sqrt(square))
    cx, cy, cz = (centre + middle).tolist()
    return Cap(cx, cy, cz + radius, radius) if 0.0 < cz + radius < 2.0 * radius else None
