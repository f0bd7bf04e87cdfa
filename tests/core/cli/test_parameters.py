"""Covariance of the inputs of a study from a calibration."""

import json
from pathlib import Path

import numpy as np
import pytest

import metafem as mf
from metafem import progress
from metafem.cli.study import with_calibration

SURFACE = mf.Surface.square_lattice(
    0.1, (1, 2), radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.37, 0.85)
)

DATA = {
    "kind": "metafem calibration",
    "parameters": ["radius", "composite_modulus", "area_ratio", "shear_strength"],
    "values": [0.526, 1.36, 0.85, 0.372],
    "covariance": np.diag([0.005, 0.02, 0.01, 0.006]).tolist(),
}
DATA["covariance"] = (np.square(DATA["covariance"]) + 1e-6 * np.eye(4)[::-1]).tolist()


@pytest.fixture
def written(tmp_path):
    """Write a calibration with changes and return its path."""

    def call(**changes):
        path = Path(tmp_path, "calibration.json")
        path.write_text(json.dumps(DATA | changes), "utf-8")
        return path

    return call


def test_errors_of_options_stand_beside_those_of_the_calibration(written):
    names, covariance = with_calibration(written(), {"load": 0.002}, SURFACE)
    assert names == (*DATA["parameters"], "load")
    assert np.array_equal(covariance[:4, :4], DATA["covariance"])
    assert covariance[4].tolist() == [0.0, 0.0, 0.0, 0.0, pytest.approx(0.002**2)]


def test_without_friction_its_parameters_are_left_out(written):
    names, covariance = with_calibration(written(), {}, SURFACE.replaced(friction=None))
    assert names == ("radius", "composite_modulus")
    assert covariance.shape == (2, 2)


def test_values_that_differ_are_told(written):
    told = []
    with progress.listening(lambda step, done: None, told.append):
        with_calibration(written(), {}, SURFACE)
        assert told == []
        with_calibration(written(values=[0.526, 1.46, 0.85, 0.37]), {}, SURFACE)
    assert "composite_modulus of the design is 1.36, and that of the calibration 1.46 ± 0.02" in told[0]
