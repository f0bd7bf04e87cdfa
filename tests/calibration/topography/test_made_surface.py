"""The made surface that `measured_surface` finds on synthetic maps is the one of which they were made."""

import numpy as np
import pytest

import metafem as mf
from validation.scenes.height_maps import Placement, Roughness, height_map

MATERIAL = mf.Material(1.36)
SHAPE = (800, 800)
PIXEL = 4e-3
PLACE = Placement(0.01, (1.62, 1.55))


def design(height):
    return mf.Surface.square_lattice(height, (2, 2), 1.5, radius=0.526, material=MATERIAL)


DESIGN = design([0.05, 0.12, 0.2, 0.27])


@pytest.fixture(scope="module")
def rough():
    return height_map(DESIGN, SHAPE, PIXEL, placement=PLACE)


def test_exact_caps_are_found_exactly():
    perfect = height_map(
        DESIGN, SHAPE, PIXEL, placement=PLACE, roughness=Roughness(0.0), noise=0.0, steepest=None
    )
    made = mf.calibration.measured_surface(perfect, PIXEL, DESIGN)
    # single precision of a map of 0.3 mm: 2e-8 mm
    assert np.abs(made.height_error).max() < 2e-8
    assert np.abs(made.radius_error).max() < 1e-6
    assert made.rotation == pytest.approx(0.01, abs=1e-6)
    assert np.abs(made.position_error).max() < 1e-6
    assert made.missing.size == 0
    assert not made.mirrored


def test_heights_radii_and_positions_of_rough_caps(rough):
    made = mf.calibration.measured_surface(rough, PIXEL, DESIGN)
    assert np.abs(made.height_error).max() < 4.0 * made.height_sd.max() < 1e-3
    assert np.abs(made.radius_error / made.radius_sd).max() < 4.0
    assert np.abs(made.position_error / made.position_sd[:, None]).max() < 4.0
    assert made.levelling.tilt == pytest.approx([2e-3, -1e-3], abs=5e-5)


@pytest.mark.parametrize(("quarter", "mirrored"), [(0, True), (1, False), (2, False), (3, True)])
def test_a_turned_or_mirrored_map_gives_the_same_surface(rough, quarter, mirrored):
    turned = np.rot90(rough[:, ::-1] if mirrored else rough, quarter)
    made = mf.calibration.measured_surface(turned, PIXEL, DESIGN)
    assert made.mirrored == mirrored
    assert np.abs(made.height_error).max() < 1e-3
    assert np.abs(made.position_error).max() < 2e-3


def test_pixels_at_infinity_were_not_measured(rough):
    holes = rough.copy()
    holes[::7, ::5] = np.inf
    made = mf.calibration.measured_surface(holes, PIXEL, DESIGN)
    assert np.abs(made.height_error).max() < 1e-3


def test_the_map_of_another_part_is_noted(rough):
    other = DESIGN.replaced(height=np.array([0.5, 2.0, 0.7, 1.6]) * DESIGN.height)
    text = "\n".join(map(str, mf.calibration.measured_surface(rough, PIXEL, other).notes))
    assert "the heights of the caps are not those of the design" in text
    assert not mf.calibration.measured_surface(rough, PIXEL, DESIGN).notes


def test_a_mould_is_measured_like_its_part(rough):
    part = mf.calibration.measured_surface(rough, PIXEL, DESIGN)
    mould = mf.calibration.measured_surface(-rough[:, ::-1], PIXEL, DESIGN, mould=True)
    np.testing.assert_allclose(mould.surface.height, part.surface.height, atol=1e-4)
    assert mould.mirrored


def test_a_common_radius_reduces_the_errors_of_the_heights(rough):
    own = mf.calibration.measured_surface(rough, PIXEL, DESIGN)
    common = mf.calibration.measured_surface(rough, PIXEL, DESIGN, common_radius=True)
    assert (common.height_sd < own.height_sd).all()
    assert np.ptp(common.surface.radius) == 0.0
    assert np.abs(common.height_error / common.height_sd).max() < 4.0
    # one radius has no scatter, but an error
    assert "the radii are" not in str(mf.calibration.corrected_heights(DESIGN, common).notes)


def test_missing_summits_and_hills_are_named(rough):
    gone = rough.copy()
    gone[400:, :400] = np.nan  # asperity 0, on the lower left
    gone[600:620, 600:606] += 0.05  # dust at a foot
    gone[20:50, 100:130] += 0.03
    made = mf.calibration.measured_surface(gone, PIXEL, DESIGN)
    assert made.missing.tolist() == [0]
    assert made.site.tolist() == [1, 2, 3]
    text = "\n".join(map(str, made.notes))
    assert "asperity 0 of the design, at (-0.750, -0.750) mm, is missing on the map" in text
    assert "is no cap of the design" in text
    assert np.abs(made.height_error).max() < 1e-3


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"height_map": np.zeros((800, 800))}, "no cap of a radius near 0.526 mm"),
        ({"height_map": np.zeros(800)}, r"shape \(800,\)"),
        ({"height_map": np.full((800, 800), np.nan)}, "the map holds no heights"),
        ({"pixel_size": 0.012}, "no cap"),
        ({"pixel_size": -1.0}, "pixel_size"),
        ({"steepest": 0.0}, "steepest"),
        ({"mould": True}, "mould=False"),
        ({"design_surface": None}, "metafem.Surface"),
    ],
)
def test_what_cannot_be_measured_is_refused(rough, change, message):
    given = {"height_map": rough, "pixel_size": PIXEL, "design_surface": DESIGN, **change}
    with pytest.raises(mf.InvalidInput, match=message):
        mf.calibration.measured_surface(**given)
