"""Made surfaces on rough and damaged maps, and their errors."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import metafem as mf
from metafem.calibration.topography.alignment import aligned
from metafem.calibration.topography.caps import pooled
from metafem.calibration.topography.cells import HeightMap
from metafem.calibration.topography.correlation import correlation, summed
from tests.calibration.topography.scenes import FOUR, PIXEL, damaged, lattice, made_surface, mapped
from validation.scenes.cap_bound import smallest_errors
from validation.scenes.height_maps import Roughness, height_map

measured_surface = mf.calibration.measured_surface


def test_heights_decide_where_a_part_of_the_lattice_lies_and_equal_ones_decide_nothing():
    design = lattice(np.random.default_rng(0), (5, 4))
    summits = np.array([5, 6, 7, 9, 10, 11, 13, 14, 15])  # 3 x 3 sites fit in many places
    noise = np.random.default_rng(1).normal(0.0, 1e-3, 9)
    place = aligned(design.position[summits] + [7.0, 5.0], design.height[summits] + noise, design, False)
    assert place.site.tolist() == summits.tolist()
    flat = design.replaced(height=np.full(20, 0.1))
    place = aligned(flat.position + 3.0, np.full(20, 0.1), flat, None)
    assert not place.decided
    assert place.site.tolist() == list(range(20))


@pytest.mark.parametrize("kind", ["spikes", "steep", "marks"])
def test_damaged_maps_give_the_same_heights(kind):
    made = measured_surface(damaged(mapped(), kind), PIXEL, FOUR)
    assert made.missing.size == 0
    assert np.abs(made.height_error / made.height_sd).max() < 4.0


def test_caps_of_the_height_of_the_roughness_are_missing_and_the_others_are_measured():
    height = [0.0003, 0.002, 0.006, 0.012, 0.02, 0.04, 0.08, 0.1, 0.12]
    low = mf.Surface.square_lattice(height, (3, 3), radius=0.526, material=mf.Material(1.36))
    values = height_map(low, (1200, 1200), PIXEL, rng=3)
    made = mf.calibration.measured_surface(values, PIXEL, low)
    assert set(made.missing.tolist()) <= {0, 1, 2, 3}
    assert np.abs(made.height_error[-5:] / made.height_sd[-5:]).max() < 4.0


def test_standard_errors_cover_the_errors_and_are_near_the_smallest_possible():
    rough = Roughness(1.2e-3, 8e-3)
    errors, scores = [], []
    for rng in range(50):
        made = measured_surface(mapped(rng=rng, roughness=rough), PIXEL, FOUR)
        errors.append(made.height_error)
        scores.append(
            np.column_stack([made.height_error / made.height_sd, made.radius_error / made.radius_sd])
        )
    score = np.concatenate(scores)
    # 200 caps: a standard error of 3.3 %
    assert (np.abs(score) < 1.0).mean(axis=0) == pytest.approx(0.6827, abs=0.1)
    bound = [smallest_errors(h, 0.526, rough, pixel=PIXEL)[0] for h in FOUR.height.tolist()]
    ratio = np.sqrt(np.mean(np.square(errors)) / np.mean(np.square(bound)))
    # the foot is left out, and 200 heights have a standard error of 5 %
    assert 0.85 < ratio < 1.3


def test_a_design_can_be_saved_with_corrected_heights(tmp_path):
    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
    design = mf.design(mf.LinearLaw(6.87), template)
    made = made_surface(design.surface, np.full(design.surface.count, -1e-4), sd=1e-6)
    correction = mf.calibration.corrected_heights(design, made)
    mf.save(correction.design, tmp_path / "next")
    stored = mf.load(tmp_path / "next")
    np.testing.assert_allclose(stored.surface.height, design.surface.height + 1e-4, rtol=1e-12)
    assert "make next" in str(stored.notes[-1])


@pytest.mark.parametrize("width", [0.3, 2.0])
def test_the_correlation_of_fitted_residuals_gives_the_variance_of_the_fit(width):
    """The mean of a correlated field over a disc, from the residuals about the means of many discs."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[-16:17, -16:17]
    disc = (x**2 + y**2 <= 15**2).astype(float)
    fields = [gaussian_filter(rng.normal(size=(49, 49)), width)[8:41, 8:41] for _ in range(300)]
    means = np.array([(field * disc).sum() / disc.sum() for field in fields])
    rest = [(field - mean) * disc for field, mean in zip(fields, means, strict=True)]
    found = correlation(rest, [disc] * len(rest), 1)
    variance = np.mean([(each**2).sum() for each in rest]) / disc.sum()
    expected = variance * summed(disc[None], found)[0, 0] / disc.sum() ** 2
    # the variance of 300 means has a relative standard error of sqrt(2 / 300), 8 %
    assert expected == pytest.approx(means.var(), rel=0.2)


def test_windows_hold_the_pixels_around_a_point():
    flat = HeightMap(np.zeros((10, 20)), (0.5, 1.0), -1.0)
    rows, columns = flat.window(np.array([5.0, 2.0]), 1.0)
    np.testing.assert_allclose(flat.x(columns), [4.25, 4.75, 5.25, 5.75])
    np.testing.assert_allclose(flat.y(rows), [2.5, 1.5])


def test_a_common_radius_is_the_joint_least_squares_estimate():
    rng = np.random.default_rng(2)
    root = rng.normal(size=(3, 4, 4))
    covariance = root @ root.transpose(0, 2, 1)
    value = rng.normal(size=(3, 4))
    found, error = pooled(value, covariance)
    # unknowns: x, y, height of each of three caps, and one radius
    matrix, weight = np.zeros((12, 10)), np.zeros((12, 12))
    for i in range(3):
        matrix[4 * i : 4 * i + 3, 3 * i : 3 * i + 3] = np.eye(3)
        matrix[4 * i + 3, 9] = 1.0
        weight[4 * i : 4 * i + 4, 4 * i : 4 * i + 4] = np.linalg.inv(covariance[i])
    spread = np.linalg.inv(matrix.T @ weight @ matrix)
    joint = spread @ matrix.T @ weight @ value.ravel()
    np.testing.assert_allclose(found[:, :3].ravel(), joint[:9], atol=1e-9)
    np.testing.assert_allclose(found[:, 3], joint[9], atol=1e-9)
    for i in range(3):
        at = [3 * i, 3 * i + 1, 3 * i + 2, 9]
        np.testing.assert_allclose(error[i], spread[np.ix_(at, at)], atol=1e-8)


def test_a_bow_is_found_and_a_missing_asperity_is_corrected_too():
    design = lattice(np.random.default_rng(3))
    bow = 1e-4 * (design.position**2).sum(axis=1)
    made = made_surface(design, bow[1:], sd=0.0, site=np.arange(1, 64))
    correction = mf.calibration.corrected_heights(design, made)
    np.testing.assert_allclose(correction.surface.height, design.height - bow, atol=1e-12)
    assert "1 of the asperities" in str(correction.notes[0])
