"""Pictures of contacts on lattices."""

import numpy as np

from validation.scenes.pictures import picture

PIXEL = 0.005

# Two contacts at four loads, of which the second closes later.
SHAPE, CENTRE = (120, 120), [(30.0, 30.0), (85.0, 80.0)]
RADII = ([6.0, 0.0], [9.0, 7.0], [16.0, 14.0], [24.0, 20.0])


def centres(side, pitch, rng):
    """Return the shape of a frame and centres [pixels] about the sites of a square lattice."""
    sites = (np.arange(side) + 0.5) * pitch
    x, y = np.meshgrid(sites, sites)
    return (side * pitch, side * pitch), np.stack([x, y], axis=-1).reshape(-1, 2) + rng.uniform(
        -0.5, 0.5, (side * side, 2)
    )


def in_order(found, centre):
    """Return for each drawn contact the number of the found one."""
    distance = np.hypot(*(found.centre[None] / PIXEL - np.asarray(centre)[:, None]).transpose(2, 0, 1))
    assert distance.min(axis=1).max() < 0.5
    return distance.argmin(axis=1)


def images(**changes):
    """Return the pictures of the two contacts."""
    return [
        picture(SHAPE, CENTRE, np.maximum(radius, 1e-6), rng=i, **{"noise": 0.02, **changes})
        for i, radius in enumerate(RADII)
    ]
