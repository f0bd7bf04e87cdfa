"""Measured laws of known surfaces, with one branch and with two."""

from functools import cache

import numpy as np

import metafem as mf
from metafem.calibration import MeasuredLaw, MeasurementErrors
from tests.calibration.contacts import table_of

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.404, 0.85)
ERRORS = MeasurementErrors()
LOAD = np.linspace(0.01, 0.19, 19)


def law_of(**changed):
    """Return a law of three points in no order."""
    return MeasuredLaw(
        **{"load": [0.2, 0.1, 0.3], "friction_force": [0.09, 0.05, 0.13], "material": MATERIAL}
        | {"friction": FRICTION}
        | changed
    )


def contacts(**changed):
    """Return the table of three images of two contacts."""
    area = np.array([[0.1, 0.2], [0.05, 0.0], [0.3, 0.4]])
    arrays = {
        "image": ("a", "b", "c"), "test": ("", "", ""), "load": np.array([0.2, 0.1, 0.3]),
        "friction_force": np.full(3, np.nan), "position": np.zeros((2, 2)), "site": np.array([5, 2]),
        "matched": True, "area": area, "area_error": 0.01 * area,
        "sheared_area": np.full((3, 2), np.nan), "sheared_area_error": np.full((3, 2), np.nan),
    }  # fmt: skip
    return table_of(*(arrays | changed).values())


def two_branches(x=LOAD, noise=0.0, crossover=0.1, sx=3e-3, sy=8e-3, seed=0):
    """Return a law of the slopes 7 and 12.5."""
    rng = np.random.default_rng(seed)
    y = np.where(x < crossover, 7.0 * x, 7.0 * crossover + 12.5 * (x - crossover))
    return MeasuredLaw(
        x + noise * sx * rng.standard_normal(len(x)),
        area=y + noise * sy * rng.standard_normal(len(x)),
        load_sd=np.full(len(x), sx),
        area_sd=np.full(len(x), sy),
        material=mf.Material(1.0),
    )


def template():
    """Return the paper's lattice with a material pair."""
    friction = mf.Friction(0.358, 0.85)
    return mf.Surface.square_lattice(0.12, radius=0.526, material=MATERIAL, friction=friction)


@cache
def linear_design():
    """Return the design of a linear law."""
    return mf.design(mf.LinearLaw(6.87), template())


def measured_on(design, load, factor=1.0, rng=None, **given):
    """Return a measured law of a design whose friction is larger by a factor, with the paper's noise."""
    surface = design.surface
    force = factor * mf.friction_law(surface, load=load).friction_force
    if rng is not None:
        load = load + rng.normal(0.0, ERRORS.load, len(load))
        force = force + ERRORS.of_friction_force(force) * rng.standard_normal(len(load))
    pair = {"material": surface.material, "friction": surface.friction}
    return MeasuredLaw(load, **{"friction_force": force} | pair | given)
