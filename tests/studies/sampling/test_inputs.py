"""Random inputs: their covariance, their groups and refused ones."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.sampling.inputs import Inputs
from metafem.studies.sampling.points import unit_points

MEAN = {"radius": 0.5, "composite_modulus": 1.4, "area_ratio": 0.9, "load": np.array([0.1, 0.2])}


def test_errors_have_the_covariance():
    matrix = np.array([[1e-4, 0.0, -5e-5], [0.0, 4e-4, 0.0], [-5e-5, 0.0, 1e-3]])
    inputs = Inputs.of(["radius", "composite_modulus", "area_ratio"], matrix, MEAN)
    assert inputs.labels == ["radius + area_ratio", "composite_modulus"]
    errors = inputs.errors(unit_points(0, 0, 2**14, 3))
    drawn = np.cov(np.column_stack([errors[name] for name in inputs.names]).T)
    np.testing.assert_allclose(drawn, matrix, atol=2e-6)


def test_a_singular_covariance_links_its_inputs():
    inputs = Inputs.of(["radius", "area_ratio"], np.outer([0.01, 0.02], [0.01, 0.02]), MEAN)
    errors = inputs.errors(np.array([[0.3, 0.8], [0.9, 0.1]]))
    np.testing.assert_allclose(errors["area_ratio"], 2.0 * errors["radius"], rtol=1e-7)


def test_inputs_are_grouped_by_way_of_others():
    matrix = np.eye(4) * 1e-4
    matrix[0, 1] = matrix[1, 0] = matrix[1, 3] = matrix[3, 1] = 1e-5
    inputs = Inputs.of(["radius", "composite_modulus", "area_ratio", "load"], matrix, MEAN)
    assert inputs.groups == ((0, 1, 3), (2,))


def test_each_load_has_its_own_deviation():
    inputs = Inputs.of({"load": [0.01, 0.02]}, None, MEAN)
    errors = inputs.errors(np.array([[0.7], [0.2]]))["load"]
    assert errors.shape == (2, 2)
    np.testing.assert_allclose(errors[:, 1], 2.0 * errors[:, 0], rtol=1e-15)


@pytest.mark.parametrize(
    ("parameters", "covariance", "message"),
    [
        ({}, None, "must name each of its parameters once"),
        (["radius", "radius"], np.eye(2), "must name each of its parameters once"),
        ([["radius"]], np.eye(1), "no parameter"),
        (["radius"], None, "must map names to standard deviations, or list the names"),
        ({"radius": 0.01}, np.eye(1), "must map names to standard deviations, or list the names"),
        ({"young_modulus": 0.1}, None, r"young_modulus is not an input; give composite_modulus"),
        ({"modulus": 0.01}, None, "no parameter 'modulus'; there are radius, composite_modulus, area_ratio"),
        ({"radius": -0.01}, None, r"parameters\.radius = -0.01 must be at least 0"),
        ({"radius": 0.1}, None, r"parameters\.radius = 0.1 must be at most 0.0714"),
        ({"radius": [0.01, 0.02]}, None, r"parameters\.radius"),
        ({"load": [0.01, -0.02]}, None, r"parameters\.load holds -0.02; it must be at least 0"),
        ({"load": [0.01, 0.02, 0.03]}, None, r"parameters\.load has 3 numbers; it must have 2"),
        ({"radius": 0.0, "load": [0.0, 0.0]}, None, "all without errors"),
        (["radius", "load"], np.eye(3), r"covariance has shape \(3, 3\)"),
        (["radius", "load"], [[-1e-4, 0], [0, 1]], "must be positive semidefinite.* is -1$"),
        (["radius", "load"], [[1e-4, 1e-5], [0, 1e-4]], "must be a symmetric matrix"),
        (["radius", "load"], [[1e-4, 2e-4], [2e-4, 1e-4]], "must be positive semidefinite.* is -1$"),
        (["radius", "load"], [[0, 1e-4], [1e-4, 1e-4]], "must be positive semidefinite"),
        (["radius"], [[0.04]], r"parameters\.radius = 0.2 must be at most 0.0714"),
    ],
)  # fmt: skip
def test_wrong_inputs_are_named(parameters, covariance, message):
    with pytest.raises(mf.InvalidInput, match=message):
        Inputs.of(parameters, covariance, MEAN)
