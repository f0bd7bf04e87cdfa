"""A surface in full contact with its laws, and records of one pull."""

import numpy as np

import metafem as mf
from metafem.calibration import MeasuredLaw

SURFACE = mf.Surface.square_lattice(
    np.linspace(0.1, 0.12, 9),
    (3, 3),
    radius=0.526,
    material=mf.Material(1.36),
    friction=mf.Friction(0.37, 0.85),
    block=mf.Block(20.0, 20.0, 7.2),
)

# 0.1 mm/s, forces at 10 Hz: every 10 um, as in the paper.
X = np.linspace(0.0, 0.6, 61)


def measured(law, **given):
    """Return the friction forces of a law as measured ones."""
    known = {"friction_force": law.friction_force, "material": law.material, "friction": law.friction}
    return MeasuredLaw(law.load, **(known | given))


def force(x, peak=0.15, static=0.2, sliding=0.17):
    """Rise linearly to the peak, then fall to a plateau within 0.05 mm."""
    fallen = np.clip((x - peak) / 0.05, 0.0, 1.0)
    return np.where(x <= peak, static * x / peak, static + (sliding - static) * fallen)


def area(x, peak=0.15):
    """Fall with the square of the force to 85 %, then to 80 %."""
    return np.where(x <= peak, 0.5 - 0.075 * (x / peak) ** 2, np.maximum(0.425 - 0.5 * (x - peak), 0.4))
