"""Lines through the origin over a range of loads: met within 1 % at every load, or refused with what is."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.bounds import Bounds
from metafem.inversion.strategies.proportional import line_range
from metafem.inversion.tools.radii import Radii

TALL, DEMO = mf.Limits(0.27), mf.Limits(0.12, offset=0.084)
ONE = Radii.of(0.526)


def deviation(result):
    """Largest relative difference of A0 from the target's line, on loads between those of the design."""
    load = np.geomspace(*result.target.load_range, 300)
    return np.abs(result.law.model.curve(result.surface, load).area / result.target.line(load) - 1.0).max()


@pytest.mark.parametrize("slope", [7.0, 12.0])
def test_the_widest_range_is_nearly_that_of_the_bounds(template, slope):
    low, high = mf.achievable_load_range(mf.LinearLaw(slope), template, TALL)
    first, end = line_range(mf.LinearLaw(slope), Bounds(mf.Hertz(), ONE, 64, 1.0))
    assert low == pytest.approx(1.4 * first, rel=1e-5)
    assert high > 0.9 * end
    assert deviation(mf.design(mf.LinearLaw(slope, (low, high)), template, limits=TALL)) < 0.01


def test_little_height_shortens_the_range(template):
    wide, narrow = (
        mf.achievable_load_range(mf.BilinearLaw((6.0, 9.0), 0.08), template, mf.Limits(top, offset=0.2))
        for top in (0.27, 0.15)
    )
    assert wide[0] < narrow[0] < 0.08 < narrow[1] < wide[1]
    result = mf.design(mf.BilinearLaw((6.0, 9.0), 0.08, wide), template, limits=mf.Limits(0.15, offset=0.2))
    assert result.status is DesignStatus.MISSED
    (told,) = (str(note) for note in result.notes if "the line is not met within 1 % from" in str(note))
    within = mf.achievable_load_range(result.target, template, mf.Limits(0.15, offset=0.2))
    both = result.target.wording.of_part(template.material)
    assert f"as the only range, {both.inside(*within)} can be met within 1 %" in told


@pytest.mark.parametrize("step", [None, 0.006])
def test_a_line_beyond_the_allowed_heights_is_met_as_nearly_as_they_allow(template, step):
    target = mf.LinearLaw.from_friction_coefficient(
        1.4, template.material, template.friction, load_range_N=(0.1, 0.6)
    )
    limits = mf.Limits(0.12, offset=0.084, height_step=step)
    result = mf.design(target, template, limits=limits)
    assert result.status is DesignStatus.MISSED
    assert result.misfit < 0.036  # found by hand, on the steps
    told = [str(note) for note in result.notes]
    assert any("can be met within 1 % (independent asperities)" in note for note in told)
    whole = 0.12 if step is None else 0.12 - step
    assert np.ptp(result.surface.height) == pytest.approx(whole)
    assert any(f"the whole allowed range of {whole:g} mm" in note for note in told)


def test_heights_that_steps_alone_hold_back_are_not_said_to_be_too_low(template):
    limits = mf.Limits(0.12, offset=0.084, height_step=0.02)
    result = mf.design(mf.LinearLaw(6.87, (0.1, 0.25)), template, limits=limits)
    assert result.misfit > 0.01 > result.misfit - result.parameters["step_loss"]
    told = " ".join(str(note) for note in result.notes)
    assert "raise max_height" not in told
    assert "a smaller height_step brings it below 1 %" in told
