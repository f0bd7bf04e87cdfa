"""Random inputs: their covariance, their groups and refused ones."""

import numpy as np

from metafem.studies.inputs import Inputs

MEAN = {"radius": 0.5, "composite_modulus": 1.4, "area_ratio": 0.9, "load": np.array([0.1, 0.2])}


def test_errors_have_the_covariance():
    matrix = np.array([[1e-4, 0.0, -5e-5], [0.0, 4e-4, 0.0], [-5e-5, 0.0, 1e-3]])
    inputs = Inputs.of((["radius", "composite_modulus", "area_ratio"], matrix), MEAN)
    assert inputs.labels == ["radius + area_ratio", "composite_modulus"]
    errors = inputs.errors(inputs.drawn(2**14, np.random.default_rng(0))[1])
    drawn = np.cov(np.column_stack([errors[name] for name in inputs.names]).T)
    np.testing.assert_allclose(drawn, matrix, atol=1.2e-5)


def test_a_singular_covariance_links_its_inputs_and_loads_have_their_own_deviations():
    inputs = Inputs.of((["radius", "area_ratio"], np.outer([0.01, 0.02], [0.01, 0.02])), MEAN)
    errors = inputs.errors(inputs.drawn(2, np.random.default_rng(0))[0])
    np.testing.assert_allclose(errors["area_ratio"], 2.0 * errors["radius"], rtol=1e-7)
    inputs = Inputs.of({"load": [0.01, 0.02]}, MEAN)
    errors = inputs.errors(np.array([[0.7], [0.2]]))["load"]
    assert errors.shape == (2, 2)
    np.testing.assert_allclose(errors[:, 1], 2.0 * errors[:, 0], rtol=1e-15)


def test_inputs_are_grouped_by_way_of_others():
    matrix = np.eye(4) * 1e-4
    matrix[0, 1] = matrix[1, 0] = matrix[1, 3] = matrix[3, 1] = 1e-5
    inputs = Inputs.of((["radius", "composite_modulus", "area_ratio", "load"], matrix), MEAN)
    assert inputs.groups == [[0, 1, 3], [2]]
