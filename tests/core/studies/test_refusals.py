"""What studies refuse: the argument and the value that was given are in the message."""

from functools import partial

import numpy as np
import pytest
import xarray as xr

import metafem as mf
from metafem.studies import summary
from metafem.studies.slope import slope_loads
from tests.refusals import faults

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.404, 0.85)
SURFACE = mf.Surface.square_lattice(
    [0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=MATERIAL, friction=FRICTION
)
FLAT, BARE = SURFACE.replaced(height=np.full(4, 0.1)), SURFACE.replaced(friction=None)
PLASTIC = mf.Independent(mf.KogutEtsion(1.0))


def manufacturing(height_sd, surface=SURFACE, **given):
    return lambda: mf.studies.manufacturing(surface, height_sd, **given)


def misalignment(angle, surface=SURFACE, **given):
    return lambda: mf.studies.misalignment(surface, angle, **given)


def uncertainty(surface=SURFACE, **given):
    return lambda: mf.studies.uncertainty(surface, **({"parameters": {"radius": 0.005}} | given))


REFUSALS = {
    "manufacturing": [
        (manufacturing(-0.001), "height_sd", "-0.001"),
        (manufacturing(0.001, others=mf.Tolerances(radius_sd=0.1)), "radius", "0.1"),
        (manufacturing(0.001, rng=-1), "rng", "-1"),
        (manufacturing(0.001, draws=1), "draws", "1"),
    ],
    "misalignment": [
        (misalignment(0.0), "angle", "0"),
        (misalignment(0.8), "angle", "0.8"),
        (misalignment([-0.1, 0.1]), "angle[0]", "-0.1"),
        (misalignment([0.2, 0.1]), "angle[1]", "0.1"),
        (misalignment(0.001, assignments=-1), "assignments", "-1"),
    ],
    "uncertainty": [
        (uncertainty(load=[0.1, -0.1]), "load[1]", "-0.1"),
        (uncertainty(BARE, parameters={"shear_strength": 0.01}), "parameters.shear_strength", "Friction"),
        (uncertainty(model="layer"), "model", "layer"),
        (
            uncertainty(parameters={"composite_modulus": 0.05}, model=PLASTIC, load=[0.01]),
            "composite_modulus",
            "law",
        ),
    ],
    "ranges": [
        (lambda: slope_loads(FLAT, None, mf.Independent()), "load_range", "height"),
        (lambda: slope_loads(FLAT, (0.3, 0.1), mf.Independent()), "load_range", "0.1"),
        (lambda: summary(xr.Dataset()), "summary", ""),
    ],
    "parameters": [
        (uncertainty(parameters={}), "parameters", "errors"),
        (uncertainty(parameters=(["radius", "radius"], np.eye(2))), "parameters", "different"),
        (uncertainty(parameters=(["radius", "load"], np.eye(3))), "covariance", "(3, 3)"),
        (uncertainty(parameters=(["radius", "load"], [[1e-4, 2e-4], [2e-4, 1e-4]])), "covariance", "radius"),
        (uncertainty(parameters=(["radius"], [[0.04]])), "parameters.radius", "0.2"),
        (uncertainty(parameters={"young_modulus": 0.1}), "young_modulus", "composite_modulus"),
        (uncertainty(parameters={"radius": -0.01}), "parameters.radius", "-0.01"),
        (uncertainty(parameters={"radius": 0.1}), "parameters.radius", "0.1 must be at most 0.0"),
        (uncertainty(parameters={"radius": [0.01, 0.02]}), "parameters.radius", "0.01"),
        (uncertainty(load=[0.1, 0.2], parameters={"load": [0.01, -0.02]}), "parameters.load", "-0.02"),
        (uncertainty(load=[0.1, 0.2], parameters={"load": [0.01, 0.02, 0.03]}), "parameters.load", "3"),
        (uncertainty(load=[0.1], parameters={"radius": 0.0, "load": [0.0]}), "parameters", "errors"),
    ],
}


@pytest.mark.parametrize("border", REFUSALS)
def test_a_refusal_names_the_argument_and_its_value(border, tmp_path):
    rows = []
    for k, (call, key, value) in enumerate(REFUSALS[border]):
        (folder := tmp_path / str(k)).mkdir()
        rows.append((partial(call, *[folder] * call.__code__.co_argcount), key, value))
    assert faults(rows) == []
