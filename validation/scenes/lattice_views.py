"""Lattices as a camera sees them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray


def lattice(shape: tuple[int, int] = (8, 8), pitch: float = 1.5) -> FloatArray:
    """Return the sites of a lattice, centred on the origin, row by row along x, (n, 2)."""
    y, x = (pitch * (np.arange(count) - 0.5 * (count - 1)) for count in shape)
    return np.array([(a, b) for b in y for a in x])


def seen(
    sites: FloatArray,
    *,
    turn: float = 0.0,
    scale: float = 1.0,
    shift: tuple[float, float] = (6.0, 7.0),
    mirrored: bool = False,
) -> FloatArray:
    """Return the positions in the image of sites, by a rotation matrix."""
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return scale * (sites * [-1.0 if mirrored else 1.0, 1.0]) @ rotation.T + shift


def trial(
    seed: int,
    *,
    contacts: int = 45,
    noise: float = 0.005,
    spurious: int = 4,
    rows: int = 8,
    mirrored: bool = False,
) -> tuple[FloatArray, NDArray[np.intp]]:
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
