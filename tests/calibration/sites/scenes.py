"""Contacts of images of lattices, without images."""

import numpy as np

from metafem.calibration import ContactAreas
from validation.scenes.lattice_views import lattice, seen

SITES = lattice()


def contacts(centre, radius, *, shape=(1400, 1400), pixel=0.01, edge=(), merged=(), **more):
    """Return the contacts of an image: circles, of which those of the given indices are flagged."""
    centre = np.asarray(centre, dtype=float)
    n = len(centre)
    area = np.pi * np.broadcast_to(np.asarray(radius, dtype=float), n) ** 2
    values = {
        "area": area,
        "area_error": 0.01 * area,
        "centre": centre,
        "axes": np.column_stack([np.sqrt(area / np.pi)] * 2),
        "angle": np.zeros(n),
        "edge": np.isin(np.arange(n), edge),
        "merged": np.isin(np.arange(n), merged),
        "dark_level": 0.3,
        "blur": 1.5 * pixel,
        "pixel_size": pixel,
        "shape": shape,
    }
    return ContactAreas(**{**values, **more})


def loading(seed=0, images=6, drift=0.2, mirrored=False):
    """Return the images of a loading of a lattice, and the exact areas (k, 64) [mm²]."""
    rng = np.random.default_rng(seed)
    entry = rng.permutation(64)  # the image in which each contact closes
    where = seen(SITES, turn=0.05, scale=0.96, shift=(7.0, 7.0), mirrored=mirrored)
    found, exact = [], np.zeros((images, 64))
    for i in range(images):
        closed = np.flatnonzero(entry < 64 * (i + 1) // images)
        exact[i, closed] = np.pi * (0.05 + 0.004 * (i * 10 + entry[closed] % 7)) ** 2
        order = rng.permutation(closed)
        shift = rng.uniform(-drift, drift, 2)
        centre = where[order] + shift + 0.003 * rng.normal(size=(len(order), 2))
        found.append(contacts(centre, np.sqrt(exact[i, order] / np.pi)))
    return found, exact


def cropped():
    """Return two images of a lattice whose frame cuts two large contacts, its sites, and the closed ones."""
    where = seen(SITES)
    closed = [0, 9, 18, 33, 45, 50, 39, 63]
    few = contacts(where[closed], 0.02 + 0.001 * np.arange(8))
    centre = where.copy()
    centre[[39, 63], 0] -= 0.07  # the centre of the part that is seen
    return few, contacts(centre, 0.2, edge=[39, 63]), where, closed
