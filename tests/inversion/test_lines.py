"""The widest ranges of lines, what little height leaves of them, and the ranges that a refusal offers."""

import re

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus, achievable_load_range, feasible_region
from tests.core.inversion.test_lines import DEMO, TALL, deviation
from tests.models.scenes import said

LIMITS, NUMBER = mf.Limits(0.12), r"([\d.e-]+)"
LATTICE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))


@pytest.mark.parametrize("cap", [mf.Hertz(), mf.Elastic(mf.Power(1.5))], ids=repr)
def test_the_widest_range_is_nearly_that_of_the_bounds(cap):
    low, high = achievable_load_range(mf.LinearLaw(7.0), LATTICE, TALL, contact=cap)
    ends = feasible_region(LATTICE, [low, high], TALL, contact=cap)
    assert ends[0][0] <= 7.0 * low * 1.01
    assert 0.99 * 7.0 * high <= ends[1][1]
    line = mf.LinearLaw(7.0, (low, high))
    assert deviation(mf.design(line, LATTICE, mf.Independent(contact=cap), TALL)) < 0.01


def test_little_height_shortens_the_range():
    line, low = mf.BilinearLaw((6.0, 9.0), 0.08), mf.Limits(0.15, offset=0.2)
    wide = achievable_load_range(line, LATTICE, mf.Limits(0.27, offset=0.2))
    narrow = achievable_load_range(line, LATTICE, low)
    assert wide[0] < narrow[0] < 0.08 < narrow[1] < wide[1]
    result = mf.design(mf.BilinearLaw((6.0, 9.0), 0.08, wide), LATTICE, limits=low)
    assert result.status is DesignStatus.MISSED


@pytest.mark.parametrize("step", [None, 0.006])
def test_a_line_beyond_the_allowed_heights_is_met_as_nearly_as_they_allow(template, step):
    pair = template.material, template.friction
    target = mf.LinearLaw.from_friction_coefficient(1.4, *pair, load_range_N=(0.1, 0.6))
    limits = mf.Limits(0.12, offset=0.084, height_step=step)
    result = mf.design(target, template, limits=limits)
    assert result.status is DesignStatus.MISSED
    assert result.misfit < 0.038  # found by hand, on the steps
    whole = 0.12 if step is None else 0.12 - step
    assert np.ptp(result.surface.height) == pytest.approx(whole)
    assert f"the whole allowed range of {whole:g} mm" in said(result)


def test_heights_that_steps_alone_hold_back_are_not_said_to_be_too_low(template):
    limits = mf.Limits(0.12, offset=DEMO.offset, height_step=0.02)
    result = mf.design(mf.LinearLaw(6.87, (0.1, 0.25)), template, limits=limits)
    assert result.misfit > 0.01 > result.misfit - result.parameters["step_loss"]
    assert "raise max_height" not in said(result)


@pytest.mark.parametrize(("slopes", "crossover"), [((7.15, 12.0), 5.0), ((7.15, 5.0), 0.4)])
def test_the_crossovers_that_are_offered_can_be_designed(slopes, crossover):
    with pytest.raises(mf.Infeasible) as caught:
        mf.design(mf.BilinearLaw(slopes, crossover), LATTICE, limits=LIMITS)
    words = rf"with these slopes.* from {NUMBER} to {NUMBER} mm\^2"
    ends = [float(end) for end in re.search(words, str(caught.value)).groups()]
    assert not ends[0] < crossover < ends[1]
    for load in ends:
        design = mf.design(mf.BilinearLaw(slopes, load), LATTICE, limits=LIMITS)
        assert design.density.asymptotic_slopes(0.526) == pytest.approx(slopes, rel=1e-6)
        assert design.density.crossover_load(64, 0.526) == pytest.approx(load, rel=1e-6)
