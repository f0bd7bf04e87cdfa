"""A surface in full contact, and its laws."""

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


def measured(law, **given):
    """Return the friction forces of a law as measured ones."""
    known = {"friction_force": law.friction_force, "material": law.material, "friction": law.friction}
    return MeasuredLaw(law.load, **(known | given))
