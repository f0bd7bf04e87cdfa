"""The study of tilts against separate laws, closed forms and itself."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.misalignment import moments

RANGE = (0.02, 0.1)


def slope(surface, model, load):
    rescaled = np.linspace(*RANGE, 20)
    law = mf.friction_law(surface, model, load=rescaled * surface.material.composite_modulus)
    return np.polyfit(rescaled, law.area, 1)[0], law.area


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(substrate=mf.BondedLayer())])
def test_moments_are_those_of_the_laws_of_tilted_surfaces(surface, model):
    steps = np.linspace(-0.001, 0.001, 5)
    laws = [slope(surface.tilted(angle, angle), model, RANGE) for angle in steps]
    found = mf.studies.misalignment(surface, steps[3:], model=model, load_range=RANGE)
    assert found.nominal_slope == pytest.approx(laws[2][0], rel=1e-7)
    np.testing.assert_allclose(found.nominal_area, laws[2][1], rtol=1e-7)
    # the law is linear between the angles; a hundred thousand values on each side make the integrals
    many = np.linspace(-0.001, 0.001, 200_001)
    for k, largest in enumerate(steps[3:]):
        inside = np.interp(many[np.abs(many) <= largest * (1.0 + 1e-12)], steps, [law[0] for law in laws])
        assert found.slope_mean[0, k] == pytest.approx(inside.mean(), rel=1e-6)
        assert found.slope_sd[0, k] == pytest.approx(inside.std(), rel=1e-4)
    inside = np.interp(many, steps, [law[1][-1] for law in laws])
    assert found.area_mean[-1, -1] == pytest.approx(inside.mean(), rel=1e-6)
    assert found.area_sd[-1, -1] == pytest.approx(inside.std(), rel=1e-4)


def test_random_assignments_repeat_and_belong_to_the_seed(surface):
    angle = np.array([0.0005, 0.001])
    found = mf.studies.misalignment(surface, angle, assignments=12)
    assert found.identical(mf.studies.misalignment(surface, angle, assignments=12))
    fewer = mf.studies.misalignment(surface, angle, assignments=4)
    np.testing.assert_array_equal(found.slope_sd[:5], fewer.slope_sd)
    other = mf.studies.misalignment(surface, angle, assignments=12, rng=1)
    np.testing.assert_array_equal(other.slope_sd[0], found.slope_sd[0])
    assert (other.slope_sd[1:] != found.slope_sd[1:]).any()
    low, high = np.quantile(found.slope_sd[1:], [0.05, 0.95], axis=0)
    np.testing.assert_allclose(found.slope_sd_quantile.sel(quantile=[0.05, 0.95]), [low, high], rtol=1e-12)


def test_a_base_plane_that_would_touch_is_a_warning(surface):
    assert "base plane" not in mf.studies.misalignment(surface, [0.001], load_range=RANGE).attrs["notes"]
    # a rise of 5 mm times 0.02 in each direction exceeds the heights
    found = mf.studies.misalignment(surface, [0.02], load_range=RANGE)
    assert "warning: at 0.02 rad and a load of 0.1 mm^2 the edge of the base plane" in found.attrs["notes"]


def test_integrals_over_the_angles_are_of_second_order():
    # mean and deviation of exp(x) over [-1, 1]
    mean = np.sinh(1.0)
    sd = np.sqrt(np.sinh(2.0) / 2.0 - mean**2)
    errors = []
    for steps in (7, 14, 28):
        angle = np.linspace(0.0, 1.0, steps + 1)[1:]
        value, spread = moments(angle, np.exp(np.concatenate([-angle[::-1], [0.0], angle])))
        errors.append([value[-1] - mean, spread[-1] - sd])
    order = np.log2(np.abs(np.array(errors)[:-1] / np.array(errors)[1:]))
    np.testing.assert_allclose(order, 2.0, atol=0.1)
    mean, sd = moments(np.array([0.1, 0.3]), 5.0 + np.array([-0.3, -0.1, 0.0, 0.1, 0.3]))
    np.testing.assert_allclose(mean, 5.0, rtol=1e-12)
    np.testing.assert_allclose(sd, np.array([0.1, 0.3]) / np.sqrt(3.0), rtol=1e-12)
