"""The made surface that a height map shows: caps, base plane, sites and errors."""

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.special import ndtri

import metafem as mf
from metafem.calibration.topography import SD_OF_MEDIAN, _map, aligned, base, cells_of, correlated, without
from tests.calibration.topography.scenes import FOUR, PIXEL, damaged, lattice, mapped
from validation.scenes.height_maps import Placement, Roughness, height_map

EXACT = {"roughness": Roughness(0.0), "noise": 0.0, "steepest": None}
made_surface = mf.calibration.made_surface


def test_exact_caps_are_found_exactly():
    made = made_surface(mapped(**EXACT), PIXEL, FOUR)
    # single precision of a map of 0.3 mm: 2e-8 mm
    assert np.abs(made.height_error).max() < 2e-8
    assert np.abs(made.radius_error).max() < 1e-6
    assert made.rotation == pytest.approx(0.01, abs=1e-6)
    assert np.abs(made.position_error).max() < 1e-6
    assert made.missing.size == 0


def test_heights_radii_and_positions_of_rough_caps_and_of_a_mould():
    rough = mapped()
    made = made_surface(rough, PIXEL, FOUR)
    assert np.abs(made.height_error).max() < 4.0 * made.height_sd.max() < 1e-3
    assert np.abs(made.radius_error / made.radius_sd).max() < 4.0
    assert np.abs(made.position_error / made.position_sd[:, None]).max() < 4.0
    assert not made.notes
    mould = made_surface(-rough[:, ::-1], PIXEL, FOUR, mould=True)
    np.testing.assert_allclose(mould.surface.height, made.surface.height, atol=1e-4)


def test_a_turned_or_mirrored_map_gives_the_same_surface():
    rough = mapped()
    for quarter, mirrored in ((3, True), (2, False)):
        turned = np.rot90(-rough[:, ::-1] if mirrored else rough, quarter)
        made = made_surface(turned, PIXEL, FOUR, mould=mirrored)
        assert np.abs(made.height_error).max() < 1e-3
        assert np.abs(made.position_error).max() < 2e-3


def test_missing_summits_and_hills_are_named():
    gone = mapped()
    gone[400:, :400] = np.nan  # asperity 0, on the lower left
    gone[600:620, 600:606] += 0.05  # dust at a foot
    gone[20:50, 100:130] += 0.03  # no cap
    gone[::7, ::5] = np.nan  # not measured
    made = made_surface(gone, PIXEL, FOUR)
    assert made.missing.tolist() == [0]
    assert made.site.tolist() == [1, 2, 3]
    text = "\n".join(map(str, made.notes))
    assert "1 asperities of the design are missing on the map: (-0.750, -0.750) mm" in text
    assert np.abs(made.height_error).max() < 1e-3


@pytest.mark.parametrize("kind", ["dust", "dropouts", "spikes", "steep", "marks"])
def test_damaged_maps_give_the_same_heights(kind):
    made = made_surface(damaged(mapped(), kind), PIXEL, FOUR)
    assert made.missing.size == 0
    assert np.abs(made.height_error / made.height_sd).max() < 4.0
    assert np.abs(made.position_error).max() < 1e-3


def test_tilt_and_bow_of_an_exact_map_are_found_from_below():
    cells = cells_of(_map(height_map(FOUR, (400, 400), 8e-3, rng=0, **EXACT), 8e-3, False), 4)
    u, v = cells.x.values - 1.6, cells.y.values[:, None] - 1.6
    expected = 2e-3 * u - 1e-3 * v + 3e-4 * u**2 + 1e-4 * u * v - 2e-4 * v**2
    # cells that a foot crosses rise less than 4.5 s.d. only if the s.d. is not 0: single precision is left
    np.testing.assert_allclose(cells - without(cells, base(cells)[0]), expected, atol=2e-7)
    assert ndtri(0.75) == pytest.approx(1.0 / SD_OF_MEDIAN, abs=1e-4)


def test_summits_are_matched_whichever_way_the_part_lay_on_the_map():
    rng = np.random.default_rng(0)
    design = lattice(rng, (5, 4))
    for degrees, mirrored in ((10.0, False), (172.0, True)):
        summits = rng.permutation(20)[:14]
        centre = Placement(math.radians(degrees), (7.0, 5.0)).of(design.position[summits])
        centre = centre * np.array([-1.0, 1.0]) if mirrored else centre
        site, position, factor, decided = aligned(
            centre + rng.normal(0.0, 2e-4, centre.shape),
            design.height[summits] + rng.normal(0.0, 1e-3, 14),
            *(design, mirrored),
        )
        assert site.tolist() == summits.tolist()
        assert decided
        assert np.abs(position - design.position[summits]).max() < 1e-3
        turned = -degrees if mirrored else degrees
        assert math.remainder(np.angle(factor) - math.radians(turned), math.tau) == pytest.approx(0, abs=1e-3)


def test_equal_heights_decide_nothing():
    flat = lattice(np.random.default_rng(0), (5, 4)).replaced(height=np.full(20, 0.1))
    site, *_, decided = aligned(flat.position + 3.0, np.full(20, 0.1), flat, False)
    assert not decided
    assert site.tolist() == list(range(20))


def test_caps_of_the_height_of_the_roughness_are_missing_and_the_others_are_measured():
    height = [0.0003, 0.002, 0.006, 0.012, 0.02, 0.04, 0.08, 0.1, 0.12]
    low = mf.Surface.square_lattice(height, (3, 3), radius=0.526, material=mf.Material(1.36))
    values = height_map(low, (1200, 1200), PIXEL, rng=3)
    made = mf.calibration.made_surface(values, PIXEL, low)
    assert set(made.missing.tolist()) <= {0, 1, 2, 3}
    assert np.abs(made.height_error[-5:] / made.height_sd[-5:]).max() < 4.0


@pytest.mark.parametrize("width", [0.3, 2.0])
def test_the_correlation_of_fitted_residuals_gives_the_variance_of_the_fit(width):
    """The mean of a correlated field over a disc, from the residuals about the means of many discs."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[-16:17, -16:17]
    disc = (x**2 + y**2 <= 15**2).astype(float)
    fields = [gaussian_filter(rng.normal(size=(49, 49)), width)[8:41, 8:41] for _ in range(300)]
    means = np.array([(field * disc).sum() / disc.sum() for field in fields])
    rest = [(field - mean) * disc for field, mean in zip(fields, means, strict=True)]
    variance = np.mean([(each**2).sum() for each in rest]) / disc.sum()
    expected = variance * correlated(rest, 1, 5) / disc.sum()
    # the variance of 300 means has a relative standard error of sqrt(2 / 300), 8 %
    assert expected == pytest.approx(means.var(), rel=0.2)
