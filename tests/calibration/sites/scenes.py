"""Lattices as a camera sees them."""

import numpy as np

from metafem.calibration import ContactAreas


def lattice(shape=(8, 8), pitch=1.5):
    """Return the sites of a lattice, centred on the origin, row by row along x, (n, 2)."""
    y, x = (pitch * (np.arange(count) - 0.5 * (count - 1)) for count in shape)
    return np.array([(a, b) for b in y for a in x])


def seen(sites, *, turn=0.0, scale=1.0, shift=(6.0, 7.0), mirrored=False):
    """Return the positions in the image of sites, by a rotation matrix."""
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return scale * (sites * [-1.0 if mirrored else 1.0, 1.0]) @ rotation.T + shift


def trial(seed, *, contacts=45, noise=0.005, spurious=4, rows=8, mirrored=False):
    """Return centres in an image of the 8 x 8 lattice with open contacts, and the site of each, -1 if none.

    The first `rows` rows have contacts; rotation, scale and shift are drawn from their ranges.
    """
    rng = np.random.default_rng(seed)
    sites = lattice()
    site = rng.permutation(8 * rows)[:contacts]
    turn, scale = np.radians(rng.uniform(-5.0, 5.0)), rng.uniform(0.9, 1.1)
    where = seen(sites, turn=turn, scale=scale, shift=rng.uniform(-50.0, 50.0, 2), mirrored=mirrored)
    centre = where[site] + noise * rng.normal(size=(contacts, 2))
    dust = rng.uniform(where.min(axis=0) - 1.5, where.max(axis=0) + 1.5, (spurious, 2))
    # a region on an open site cannot be told from a contact
    near = np.linalg.norm(dust[:, None] - where, axis=2).min(axis=1) < 0.1
    centre = np.vstack([centre, dust[~near]])
    site = np.append(site, np.full(np.count_nonzero(~near), -1))
    order = rng.permutation(len(site))
    return centre[order], site[order]


def contacts(centre, radius, *, shape=(1400, 1400), pixel=0.01, edge=(), merged=(), **more):
    """Return the contacts of an image: circles, of which those of the given indices are flagged."""
    centre = np.asarray(centre, dtype=float)
    n = len(centre)
    area = np.pi * np.broadcast_to(np.asarray(radius, dtype=float), n) ** 2
    none = np.zeros(n, dtype=bool)
    values = {
        "area": area,
        "area_error": 0.01 * area,
        "otsu_area": area,
        "centre": centre,
        "axes": np.column_stack([np.sqrt(area / np.pi)] * 2),
        "angle": np.zeros(n),
        "edge": np.isin(np.arange(n), edge),
        "merged": np.isin(np.arange(n), merged),
        "saturated": none,
        "holes": np.zeros(n, dtype=int),
        "threshold": 0.7,
        "dark_level": 0.3,
        "blur": 1.5 * pixel,
        "noise": 0.01,
        "pixel_size": pixel,
        "shape": shape,
    }
    return ContactAreas(**{**values, **more})
