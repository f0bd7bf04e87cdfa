"""Friction in true proportion to the load, over nearly the range that any surface allows."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.feasibility import friction_bounds
from metafem.inversion.proportional import proportional_range
from metafem.inversion.radii import Radii

LIMITS = mf.Limits(0.27)
ONE = Radii.of(0.526)


def test_range_ends_where_the_law_meets_the_bounds():
    low, high = proportional_range(7.0, ONE, 64)
    least, most = friction_bounds(np.array([low, high]), ONE, 64)
    assert (least[0], most[1]) == (pytest.approx(7.0 * low), pytest.approx(7.0 * high))


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(order=1)], ids=["alone", "coupled"])
@pytest.mark.parametrize("slope", [7.0, 12.0])
def test_friction_is_proportional_over_most_of_the_range(template, slope, model):
    result = mf.design(mf.LinearLaw(slope, through_origin=True), template, model, LIMITS)
    low, last = result.parameters["load_range"]
    first, end = proportional_range(slope, ONE, 64)
    assert low == pytest.approx(first)
    assert last > 0.5 * end
    load = np.geomspace(low, last, 200)
    ratio = model.curve(result.surface, load).area / load / slope
    assert np.sqrt(((ratio - 1.0) ** 2).mean()) < 0.01
    assert result.misfit < 0.01
    assert abs(result.fits[0][1].intercept) < 0.01 * slope * last
    assert f"from {low:.4g} to {last:.4g} mm^2" in result.notes[0].text


def test_little_height_shortens_the_range(template):
    wide, narrow = (
        mf.design(mf.LinearLaw(7.0, through_origin=True), template, limits=mf.Limits(top, offset=0.2))
        for top in (0.27, 0.12)
    )
    assert narrow.parameters["load_range"][1] < 0.7 * wide.parameters["load_range"][1]
    assert np.ptp(narrow.surface.height) <= 0.12 * (1.0 + 1e-12)


@pytest.mark.parametrize(
    ("slope", "words"), [(0.5, "below the friction of a single asperity"), (5.5, "raise max_height, or the")]
)
def test_a_slope_beyond_reach_is_refused_with_one_that_is_not(template, slope, words):
    with pytest.raises(mf.Infeasible, match=words) as caught:
        mf.design(mf.LinearLaw(slope, through_origin=True), template, limits=mf.Limits(0.1))
    near = caught.value.nearest
    assert near.through_origin
    assert mf.design(near, template, limits=mf.Limits(0.1)).misfit < 0.01


def test_one_asperity_is_never_proportional(template):
    one = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.0))
    with pytest.raises(mf.Infeasible):
        mf.design(mf.LinearLaw(7.0, through_origin=True), one, limits=LIMITS)


def test_friction_coefficients_may_go_through_the_origin(template):
    pair = template.material, template.friction
    law = mf.LinearLaw.from_friction_coefficient(1.5, *pair, through_origin=True)
    assert law.through_origin
    with pytest.raises(mf.InvalidInput, match="through_origin = 1 must be True or False"):
        mf.LinearLaw(7.0, through_origin=1)
