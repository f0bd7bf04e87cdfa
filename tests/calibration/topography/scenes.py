"""Made surfaces without a map: a design and its height errors."""

import numpy as np

import metafem as mf
from metafem.calibration.topography.levelled import Levelling
from metafem.calibration.topography.made_surface import MadeSurface

FLAT = Levelling(np.zeros(2), 6.0, np.zeros(2), np.zeros(3), 0.0, 1e-3, 0.03, 0.2, np.zeros((6, 6)))


def lattice(rng, shape=(8, 8)):
    height = rng.uniform(0.05, 0.27, shape[0] * shape[1])
    return mf.Surface.square_lattice(height, shape, 1.5, radius=0.526, material=mf.Material(1.36))


def made_surface(design, error, sd=1e-4, site=None):
    """A part with height errors, those of the measurement among them, which have a standard deviation."""
    site = np.arange(design.count) if site is None else np.asarray(site)
    surface = mf.Surface(
        design.position[site], design.height[site] + error, design.radius[site], design.material
    )
    one = np.full(len(site), sd)
    missing = np.setdiff1d(np.arange(design.count), site)
    return MadeSurface(
        surface, design, site, one, one, one, FLAT, missing, 1.5e-3, 0.0, False, surface.position
    )
