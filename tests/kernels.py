"""Compile the kernels that tests share, by small scenes of each kind."""

import sys

import numpy as np

import metafem as mf

MATERIAL = mf.Material(1.36)


def lattice(side, cap=None):
    """A lattice of asperities with random heights."""
    height = np.random.default_rng(0).exponential(0.03, side**2) + 0.05
    more = {} if cap is None else {"cap": cap}
    return mf.Surface.square_lattice(height, (side, side), pitch=1.5, radius=0.526, material=MATERIAL, **more)


SMALL, LOAD, LIMITS = lattice(3), np.array([0.01, 0.02]), mf.Limits(0.4)


def target():
    """A law that nine asperities have."""
    law = mf.friction_law(SMALL, mf.Independent(), load=np.linspace(0.02, 0.05, 8))
    return mf.SampledLaw(law.rescaled_load, 1.01 * law.area)


def dense():
    """Solve few interacting asperities."""
    mf.friction_law(SMALL, mf.Interacting(substrate=mf.BondedLayer(5.0)), load=LOAD)
    mf.design(target(), SMALL, mf.Interacting(), LIMITS)


def others():
    """Solve independent, many and resolved contacts."""
    mf.friction_law(SMALL, mf.Independent(mf.JKR(1e-5)), load=LOAD)
    for contact in (mf.Hertz(), mf.KogutEtsion(20.0)):
        model = mf.Independent(contact)
        mf.friction_law(SMALL, model, load=LOAD)
        mf.friction_law(SMALL, model, separation=[0.1, 0.05])
        model.areas(SMALL, LOAD, np.stack([SMALL.height, 0.9 * SMALL.height]))
    for cap in (mf.Sphere(), mf.Power(3.0)):
        mf.friction_law(lattice(3, cap), mf.Independent(mf.Elastic()), load=LOAD)
    mf.design(target(), SMALL, limits=LIMITS)
    mf.friction_law(SMALL, mf.BoundaryElements(0.02), load=LOAD)
    for side, order in ((21, 3), (46, 1)):
        surface = lattice(side)
        mf.friction_law(surface, mf.Interacting(order=order), load=[1.0])
        moved = surface.position + 0.1 * np.random.default_rng(1).uniform(size=surface.position.shape)
        mf.friction_law(surface.replaced(position=moved), mf.Interacting(order=order), load=[1.0])


# What one process compiles, and what another one compiles beside it.
PARTS = (dense, others)

if __name__ == "__main__":
    PARTS[int(sys.argv[1])]()
