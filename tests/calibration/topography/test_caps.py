"""Spheres are fitted in spite of dust, spikes and holes, with standard errors that cover their errors."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration.topography.caps import pooled
from validation.scenes.cap_bound import smallest_errors
from validation.scenes.height_maps import Placement, Roughness, height_map

PIXEL = 4e-3
DESIGN = mf.Surface.square_lattice(
    np.linspace(0.05, 0.27, 9)[[4, 0, 7, 2, 8, 1, 5, 3, 6]], (3, 3), radius=0.526, material=mf.Material(1.36)
)


def mapped(rng=0, **options):
    return height_map(
        DESIGN, (1200, 1200), PIXEL, placement=Placement(0.01, (2.41, 2.39)), rng=rng, **options
    )


@pytest.fixture(scope="module")
def rough():
    return mapped()


def dust(values, rng):
    for i, j in rng.integers(0, 1190, (300, 2)):
        values[i : i + 7, j : j + 7] += rng.uniform(5e-3, 50e-3)


def spikes(values, rng):
    values[rng.random(values.shape) < 0.01] += 0.2
    values[rng.random(values.shape) < 0.01] -= 0.2


def dropouts(values, rng):
    values[rng.random(values.shape) < 0.6] = np.nan


def steep(values, rng):
    del rng
    x = PIXEL * np.arange(1200)
    values += (0.02 * x + 0.01 * x[:, None] + 1e-3 * (x - 2.4) ** 2).astype(np.float32)


def marks(values, rng):
    """Tool marks with a period of 50 um."""
    del rng
    values += (1e-3 * np.sin(2.0 * np.pi * PIXEL / 0.05 * np.arange(1200))).astype(np.float32)


@pytest.mark.parametrize("damage", [dust, spikes, dropouts, steep, marks])
def test_damaged_maps_give_the_same_heights(rough, damage):
    values = rough.copy()
    damage(values, np.random.default_rng(1))
    made = mf.calibration.measured_surface(values, PIXEL, DESIGN)
    assert made.missing.size == 0
    assert np.abs(made.height_error / made.height_sd).max() < 4.0
    assert made.height_sd.max() < 0.2e-3
    assert np.abs(made.position_error).max() < 1e-3


def test_caps_of_the_height_of_the_roughness_are_missing_and_the_others_are_measured():
    height = [0.0003, 0.002, 0.006, 0.012, 0.02, 0.04, 0.08, 0.1, 0.12]
    low = mf.Surface.square_lattice(height, (3, 3), radius=0.526, material=mf.Material(1.36))
    values = height_map(low, (1200, 1200), PIXEL, rng=3)
    made = mf.calibration.measured_surface(values, PIXEL, low)
    assert set(made.missing.tolist()) <= {0, 1, 2, 3}
    assert np.abs(made.height_error[-5:] / made.height_sd[-5:]).max() < 4.0


def test_a_common_radius_is_the_joint_least_squares_estimate():
    rng = np.random.default_rng(2)
    root = rng.normal(size=(3, 4, 4))
    covariance = root @ root.transpose(0, 2, 1)
    value = rng.normal(size=(3, 4))
    found, error = pooled(value, covariance)
    # unknowns: x, y, height of each of three caps, and one radius
    matrix = np.zeros((12, 10))
    for i in range(3):
        matrix[4 * i : 4 * i + 3, 3 * i : 3 * i + 3] = np.eye(3)
        matrix[4 * i + 3, 9] = 1.0
    weight = np.zeros((12, 12))
    for i in range(3):
        weight[4 * i : 4 * i + 4, 4 * i : 4 * i + 4] = np.linalg.inv(covariance[i])
    spread = np.linalg.inv(matrix.T @ weight @ matrix)
    joint = spread @ matrix.T @ weight @ value.ravel()
    np.testing.assert_allclose(found[:, :3].ravel(), joint[:9], atol=1e-9)
    np.testing.assert_allclose(found[:, 3], joint[9], atol=1e-9)
    for i in range(3):
        at = [3 * i, 3 * i + 1, 3 * i + 2, 9]
        np.testing.assert_allclose(error[i], spread[np.ix_(at, at)], atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("length", [8e-3, 2e-2])
def test_standard_errors_cover_the_errors_and_are_near_the_smallest_possible(length):
    rough = Roughness(1.2e-3, length)
    errors, scores = [], []
    for rng in range(25):
        made = mf.calibration.measured_surface(mapped(rng, roughness=rough), PIXEL, DESIGN)
        errors.append(made.height_error)
        scores.append(
            np.column_stack([made.height_error / made.height_sd, made.radius_error / made.radius_sd])
        )
    score = np.concatenate(scores)
    # 225 caps: a standard error of 3.1 %
    assert (np.abs(score) < 1.0).mean(axis=0) == pytest.approx(0.6827, abs=0.093)
    bound = [smallest_errors(h, 0.526, rough, pixel=PIXEL)[0] for h in DESIGN.height.tolist()]
    ratio = np.sqrt(np.mean(np.square(errors)) / np.mean(np.square(bound)))
    # the foot is left out, and 225 heights have a standard error of 4.7 %
    assert 0.86 < ratio < 1.3
