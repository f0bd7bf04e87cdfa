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
MODELS = [mf.Independent(), mf.Interacting(order=1)]


def deviation(result):
    """Largest relative difference of A0 from the target's line, on loads between those of the design."""
    load = np.geomspace(*result.target.load_range, 300)
    return np.abs(result.law.model.curve(result.surface, load).area / result.target.line(load) - 1.0).max()


def test_range_ends_where_the_line_meets_the_bounds():
    for line in (mf.LinearLaw(7.0), mf.BilinearLaw((6.0, 9.0), 0.08), mf.BilinearLaw((6.0, 4.5), 0.08)):
        bounds = Bounds(mf.Hertz(), ONE, 64, 1.0)
        low, high = line_range(line, bounds)
        friction = line.line(np.array([low, high]))
        least, _ = bounds.friction(np.array([low]))
        assert least[0] == pytest.approx(friction[0])
        # of 64 contacts that enter at once, dA0/dp = (pi/2) N R/(N a) at p = 4/3 N a^3/R or A0 = N pi a^2
        together = 64 * (0.75 * 0.526 * high / friction[1] * np.pi) ** 2 * np.pi
        steepest = 0.5 * np.pi * 64 * 0.526**2 * 0.75 * high / (friction[1] / np.pi) ** 2
        assert together >= friction[1]
        assert steepest == pytest.approx(line.lines[-1][0])


@pytest.mark.parametrize("model", MODELS, ids=["alone", "coupled"])
@pytest.mark.parametrize(
    ("target", "limits"),
    [
        (mf.LinearLaw(6.87, (0.05, 0.2)), DEMO),
        (mf.BilinearLaw((7.15, 12.52), 0.038, (0.02, 0.1)), mf.Limits(0.12, offset=0.05)),
        (mf.BilinearLaw((6.0, 9.0), 0.08, (0.03, 0.3)), TALL),
    ],
    ids=["linear demo", "bilinear demo", "6 and 9"],
)
def test_a_line_is_met_within_a_hundredth(template, target, limits, model):
    result = mf.design(target, template, model, limits)
    assert result.status in (DesignStatus.REACHED, DesignStatus.REFINED)
    assert deviation(result) < 0.01
    assert result.misfit == pytest.approx(deviation(result), rel=0.3)  # at a hundred loads
    assert not any(note.warns for note in result.notes)
    for branch, fit in result.fits:
        assert fit.intercept == pytest.approx(branch.intercept, abs=0.01 * target.line(target.last_load))


@pytest.mark.parametrize("target", [mf.LinearLaw(6.87), mf.BilinearLaw((6.0, 9.0), 0.08)])
def test_a_density_further_off_names_the_way(template, target):
    result = mf.design(target, template, limits=mf.Limits(0.15))
    assert result.misfit > 0.01
    (told,) = (note for note in result.notes if "Give load_range" in str(note))
    assert not told.warns  # within the bound of the density itself, 10 %
    assert f"{100 * result.misfit:.2g} %" in str(told)


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


@pytest.mark.parametrize(
    ("target", "words"),
    [
        (
            mf.LinearLaw(7.0, (0.01, 0.2)),
            r"slope 7 .* begin at 0.01 mm\^2 \(0.0136 N\): .* up to 0.01407 mm\^2",
        ),
        (
            mf.LinearLaw(7.0, (0.03, 0.7)),
            r"slope 7 .* go on up to 0.7 mm\^2 \(0.952 N\): from 0.6002 mm\^2 .* on",
        ),
        (
            mf.BilinearLaw((6.0, 9.0), 0.08, (0.03, 0.7)),
            r"slope 9 from 0.08 mm\^2 .* cannot .* 0.3336 mm\^2 .* on",
        ),
        (
            mf.BilinearLaw((6.0, 3.9), 0.08, (0.04, 0.2)),
            r"slope 3.9 cannot follow slope 6 .* from 4 to 71.48",
        ),
        (
            mf.BilinearLaw((9.0, 16.0), 0.0572, (0.05, 0.7)),
            r"slope 16 from 0.0572 mm\^2 .* cannot go on .* on friction",
        ),
    ],
)
def test_what_no_surface_has_is_refused_with_what_is_reached(template, target, words):
    with pytest.raises(mf.Infeasible, match=words) as caught:
        mf.design(target, template, limits=TALL)
    assert deviation(mf.design(caught.value.nearest, template, limits=TALL)) < 0.01


def test_a_range_of_a_few_per_cent_is_not_offered(template):
    """A steeper branch of slope 30 ends less than 5 % beyond the crossover."""
    with pytest.raises(
        mf.Infeasible, match=r"slope 30 from 0.0572 mm.2 .* cannot go on .* on friction"
    ) as caught:
        mf.design(mf.BilinearLaw((9.0, 30.0), 0.0572, (0.05, 0.7)), template, limits=TALL)
    assert caught.value.nearest is None
    assert "the line is reached" not in str(caught.value)


def test_a_range_out_of_reach_says_what_to_change(template):
    with pytest.raises(mf.Infeasible, match=r"a single asperity has more friction .*; raise the slope"):
        mf.design(mf.LinearLaw(0.5, (0.01, 0.2)), template, limits=TALL)
    one = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.0))
    with pytest.raises(mf.Infeasible, match="not reached within 1 % over any range of loads with 1 "):
        mf.achievable_load_range(mf.LinearLaw(7.0), one, TALL)
    with pytest.raises(mf.InvalidInput, match=r"target = .* must be a metafem\.LinearLaw or BilinearLaw"):
        mf.achievable_load_range(mf.PowerLaw(1.0, (0.1, 0.2)), template, TALL)


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
