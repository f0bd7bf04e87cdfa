"""Designs of all three kinds: exact where they can be, refused with a reason where they cannot."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem._kernels import continuation, independent
from metafem.inversion import DesignStatus
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.strategies.exponential import level_counts
from tests.models.scenes import said

LIMITS = mf.Limits(max_height=0.12, offset=0.05)
LATTICE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
TALL = mf.Limits(0.27)


def after(third, second=1.68):
    """Return three operating points with some frictions of the last two."""
    return mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, second, third])


POINTS = after(4.12)


@given(st.integers(0, 10**6))
def test_points_of_any_level_surface_can_be_designed(seed):
    """A law taken from levels with adjustments is reachable, whatever they are."""
    rng = np.random.default_rng(seed)
    levels = 0.3 - np.concatenate([[0.0], np.cumsum(rng.uniform(0.01, 0.06, 2))])
    height = np.repeat(levels, rng.integers(1, 12, 3))
    at = np.append(levels[1:], levels[-1] - 0.02)
    surface = mf.Surface.square_lattice(height, (1, len(height)), radius=0.526, material=mf.Material(1.0))
    law = mf.friction_law(surface, separation=at)
    target = mf.OperatingPoints(law.rescaled_load, law.rescaled_friction)
    result = mf.design(target, LATTICE, limits=mf.Limits(0.3))
    assert result.misfit <= 1e-9
    assert result.surface.count <= len(height) + 3


@pytest.mark.parametrize(
    ("target", "limits", "words"),
    [
        (after(9.0), TALL, r"point 3 .* 927 more asperities are needed, 54 are left"),
        (after(4.0, second=1.0), TALL, r"point 2 .*from 1.48208 to 2.80861 mm\^2"),
        (
            mf.OperatingPoints([0.0001], [1e-4]),
            TALL,
            "point 1 .*a single asperity already has more friction ",
        ),
        (mf.LinearLaw(3.0), LIMITS, "slope 3 is not above the bound 3 pi/4 .* = 4.93303"),
        (mf.BilinearLaw((3.0, 9.0), 0.04), LIMITS, "slope 3 is not above"),
        (
            mf.BilinearLaw((7.15, 12.0), 5.0),
            LIMITS,
            "crossover_load = 5 mm.2 .* is outside the law .* 0.4354",
        ),
        (mf.BilinearLaw((7.15, 12.0), 0.4), LIMITS, "the second slope can be from 5.70.* to 7.78"),
    ],
)
def test_unreachable_targets_say_why_and_what_is_near(template, target, limits, words):
    with pytest.raises(mf.Infeasible, match=words) as caught:
        mf.design(target, template, limits=limits)
    near = mf.design(caught.value.nearest, template, limits=limits)
    assert near.density is not None or near.misfit <= 1e-9


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (mf.Limits(0.15), "point 3 needs a summit at -0.0126.* raise max_height = 0.15 mm by 0.0126 mm"),
        (mf.Limits(0.163), "at operating point 3 the plane would reach the base plane; raise offset = 0"),
        (mf.Limits(0.27, min_height=0.15), "needs a summit at 0.1.* mm, below min_height = 0.15"),
    ],
)
def test_points_beyond_the_workshop_say_what_to_raise(template, limits, words):
    with pytest.raises(mf.Infeasible, match=words):
        mf.design(POINTS, template, limits=limits)


@pytest.mark.parametrize("shape", [(8, 8), (60, 60)])
def test_discrete_law_approaches_that_of_the_density(shape):
    lattice = mf.Surface.square_lattice(0.12, shape, radius=0.526, material=mf.Material(1.0))
    result = mf.design(mf.LinearLaw(7.0), lattice, limits=LIMITS)
    delta = np.linspace(0.0, 0.08, 9)
    load = result.density.rescaled_load(delta, lattice.count, 0.526)
    expected = result.density.area(delta, lattice.count, 0.526)
    found = mf.friction_law(result.surface, load=load).area[::-1]
    # the tallest interval holds 1/N of the mass: its middle is off by O(1/N) of the area there
    np.testing.assert_allclose(found, expected, rtol=1.5 / lattice.count)


@given(st.floats(5.2, 12.0), st.floats(0.0, 1.0), st.floats(0.05, 0.8))
def test_every_second_slope_within_the_stated_bounds_is_solved(first, share, load):
    full = mf.design(mf.LinearLaw(first), LATTICE, limits=LIMITS).parameters["foot_load"]
    bounds = []
    for extreme in (1e-3, 1e6):
        with pytest.raises(mf.Infeasible) as caught:
            mf.design(mf.BilinearLaw((first, extreme), load * full), LATTICE, limits=LIMITS)
        bounds.append(caught.value.nearest.slopes[1])
    second = bounds[0] + share * (bounds[1] - bounds[0])
    found = mf.design(mf.BilinearLaw((first, second), load * full), LATTICE, limits=LIMITS)
    assert found.density.asymptotic_slopes(0.526)[1] == pytest.approx(second, rel=1e-9)


def test_crossover_with_too_few_asperities_is_refused(template):
    one = template.replaced(
        position=template.position[:1], height=template.height[:1], radius=template.radius[:1]
    )
    with pytest.raises(mf.Infeasible, match="one of the branches has fewer than 1 of 1 asperities") as caught:
        mf.design(mf.BilinearLaw((7.15, 9.0), 0.001), one, limits=LIMITS)
    assert "; use more asperities" in str(caught.value)
    assert caught.value.nearest is None


@pytest.mark.parametrize("slope", [50.0, 1e3, 1e6])
def test_a_law_of_a_single_level_is_no_success(template, slope):
    result = mf.design(mf.LinearLaw(slope), template, limits=mf.Limits(0.12, height_step=0.006))
    assert result.status is DesignStatus.MISSED


@pytest.mark.parametrize("slope", [1e30, 1e200])
def test_slopes_beyond_double_precision_are_refused(template, slope):
    with pytest.raises(mf.Infeasible, match="double precision"):
        mf.design(mf.LinearLaw(slope), template, limits=LIMITS)


@given(st.floats(0.003, 1.0), st.integers(1, 300), st.floats(0.02, 1.0))
def test_level_counts_add_up_and_stay_near_their_expectation(scale, count, share):
    density = ExponentialDensity(scale, 0.12)
    levels, counts = level_counts(density, count, 0.12 * share)
    assert counts.sum() == count
    assert counts.min() >= 0
    assert levels.max() <= 0.12 * (1.0 + 1e-12)


def test_heights_are_dealt_by_the_seed_and_never_sorted(template):
    first, second, other = (mf.design(mf.LinearLaw(7.0), template, limits=LIMITS, rng=s) for s in (0, 0, 1))
    np.testing.assert_array_equal(first.surface.height, second.surface.height)
    assert not (first.surface.height == other.surface.height).all()
    np.testing.assert_array_equal(np.sort(first.surface.height), np.sort(other.surface.height))
    assert (np.diff(first.surface.height) > 0).any()
    assert (np.diff(first.surface.height) < 0).any()


def test_heights_stay_within_the_limits(template):
    limits = mf.Limits(max_height=0.15, min_height=0.03, offset=0.02, height_step=0.006)
    height = mf.design(mf.LinearLaw(7.0), template, limits=limits).surface.height
    assert height.min() >= 0.05
    assert height.max() <= 0.17


def test_heights_too_fine_for_the_workshop_are_noted(template):
    limits = mf.Limits(max_height=0.12, height_sd=0.003)
    notes = mf.design(mf.LinearLaw(9.0), template, limits=limits).notes
    assert "below 10 times height_sd" in notes[0].text
    assert "are lower than 10 times height_sd" in notes[1].text


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: mf.Limits(0.0), "max_height = 0 must be greater"),
        (lambda: mf.Limits(0.1, min_height=0.2), "min_height = 0.2 must be below max_height"),
        (lambda: mf.Limits(0.1, height_step=0.2), "height_step = 0.2 must be at most 0.1"),
        (lambda: mf.design("linear", LATTICE), "target = 'linear' must be one of OperatingPoints"),
        (lambda: mf.design(mf.LinearLaw(7), 3), "template = 3 must be a metafem.Surface"),
        (lambda: mf.design(mf.LinearLaw(7), LATTICE, limits=0.1), "limits = 0.1 must be metafem.Limits"),
        (
            lambda: mf.design(mf.LinearLaw(7), LATTICE.replaced(radius=np.linspace(1, 2, 64))),
            "one common radius is needed here, and the argument tools allows several",
        ),
    ],
)
def test_bad_requests_are_named(build, words):
    with pytest.raises(mf.InvalidInput, match=words):
        build()


def test_targets_from_forces(template):
    pair = template.material, template.friction
    factor = 0.358 * 0.85
    points = mf.OperatingPoints.from_forces([0.2, 0.4], [0.3, 0.5], *pair)
    np.testing.assert_allclose(points.rescaled_load, np.array([0.2, 0.4]) / 1.36, rtol=1e-12)
    np.testing.assert_allclose(points.rescaled_friction, np.array([0.3, 0.5]) / factor, rtol=1e-12)
    line = mf.LinearLaw.from_forces([0.1, 0.2, 0.3], [0.3, 0.5, 0.7], *pair)
    assert line.slope == pytest.approx(2.0 * 1.36 / factor, rel=1e-12)
    two = mf.BilinearLaw.from_forces([0.1, 0.2, 0.3], [0.1, 0.2, 0.4], *pair)
    assert two.slopes[1] == pytest.approx(2.0 * two.slopes[0], rel=1e-12)
    assert two.crossover_load == pytest.approx(0.2 / 1.36, rel=1e-12)


def test_plasticity_index_warns_above_its_limit(template):
    rough = template.replaced(height=np.linspace(0.0, 0.2, 64))
    psi = mf.plasticity_index(rough, 100.0)
    assert psi == pytest.approx(1.36 / 100.0 * math.sqrt(rough.height.std() / 0.526), rel=1e-12)
    with pytest.warns(mf.MetafemWarning, match="plasticity index .* is not below 0.6"):
        mf.plasticity_index(rough, 0.5)


def test_coefficient_bounds_need_a_friction(template):
    low, high = mf.achievable_friction_coefficients(template, mf.Limits(0.12))
    bound = 0.75 * math.pi * math.sqrt(0.526 / 0.12) * 0.358 * 0.85 / 1.36
    assert (low, high) == (pytest.approx(bound, rel=1e-12), math.inf)
    with pytest.raises(mf.InvalidInput, match="template has no friction"):
        mf.achievable_friction_coefficients(template.replaced(friction=None), LIMITS)


def test_a_law_missed_for_want_of_height_says_so(template):
    target = mf.PowerLaw(1.35, (0.1, 0.4))
    result = mf.design(target, template, limits=mf.Limits(0.1, offset=0.1))
    assert result.status is DesignStatus.MISSED
    assert "the heights use the whole allowed range of 0.1 mm: raise max_height" in " ".join(
        map(str, result.notes)
    )


@pytest.mark.parametrize(("count", "points"), [(3, 2), (8, 3), (64, 5)])
def test_points_of_surfaces_without_levels_are_met_or_nearly_so(count, points):
    lattice = mf.Surface.square_lattice(0.5, (1, count), radius=0.526, material=mf.Material(1.0))
    for seed in range(4):
        rng = np.random.default_rng(seed)
        height, load = rng.exponential(0.03, count), np.sort(rng.uniform(0.001, 1.8, points)) * count / 64
        area = mf.Independent().curves(height, 0.526, load)[2][0]
        result = mf.design(mf.OperatingPoints(load, area), lattice, limits=mf.Limits(0.5))
        assert result.misfit < 1e-3
        assert result.status in (DesignStatus.EXACT, DesignStatus.REACHED)


def test_no_summit_stands_below_the_foot(template):
    """Heights over the whole span end at it to rounding."""
    for top in np.arange(0.06, 0.1, 0.005):
        limits = mf.Limits(top, min_height=0.01)
        assert mf.design(mf.PowerLaw(1.5, (0.1, 0.4)), template, limits=limits).surface.height.min() >= 0.01


def test_levels_are_not_told_where_interaction_moved_them(template):
    result = mf.design(POINTS, template, mf.Interacting(order=1), TALL)
    assert result.surface.count == 64
    assert "6 asperities were added" in said(result)
    assert "levels" not in result.parameters


def test_a_density_whose_few_asperities_miss_its_law_is_refined(template):
    result = mf.design(mf.BilinearLaw((7.15, 12.52), 0.038), template, limits=TALL)
    assert result.misfit <= 0.1
    assert result.status is DesignStatus.APPROXIMATE
    assert any("for the scatter of so few asperities" in note.text for note in result.notes)


@pytest.mark.parametrize(("slope", "status"), [(6.87, "APPROXIMATE"), (9.0, "REFINED")])
def test_a_density_is_refined_where_its_law_has_the_slope_within_a_hundredth(template, slope, status):
    result = mf.design(mf.LinearLaw(slope), template, mf.Interacting(order=1), LIMITS)
    assert "heights were moved" in said(result)
    assert (result.misfit <= 0.01) == (status == "REFINED")
    assert result.status.name == status


def deepest_call(monkeypatch, *arguments, **options):
    """Return the largest number of frames between this function and a kernel during a design."""
    deepest, here = 0, sys._getframe().f_code

    def counted(kernel):
        def count(*arguments):
            nonlocal deepest
            frame, frames = sys._getframe(1), 0
            while frame is not None and frame.f_code is not here:
                frame, frames = frame.f_back, frames + 1
            deepest = max(deepest, frames)
            return kernel(*arguments)

        return count

    for module in (independent, continuation):
        monkeypatch.setattr(module, "curves", counted(module.curves))
    mf.design(*arguments, **options)
    return deepest


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting()], ids=["alone", "coupled"])
@pytest.mark.parametrize(
    ("target", "limits", "radii"),
    [
        (POINTS, TALL, None),
        (mf.LinearLaw(6.87), LIMITS, None),
        (mf.LinearLaw(6.87, (0.05, 0.2)), LIMITS, None),
        (mf.PowerLaw(1.2, (0.1, 0.4)), mf.Limits(0.27, height_step=0.006), None),
        (mf.PowerLaw(0.645, (0.1, 0.4)), TALL, [0.2, 0.8]),
    ],
    ids=["points", "density", "line", "steps", "radii"],
)
def test_a_kernel_is_called_within_ten_frames(template, monkeypatch, target, limits, radii, model):
    # with interaction, too, but that takes seconds
    robust = mf.Tolerances(height_sd=0.003) if limits.height_step and not model.couples else None
    deepest = deepest_call(monkeypatch, target, template, model, limits, tools=radii, robust=robust)
    assert 0 < deepest <= 10


@pytest.mark.parametrize(("target", "curves"), [(mf.PowerLaw(1.2, (0.1, 0.4)), 1), (mf.LinearLaw(9.0), 2)])
def test_a_law_is_computed_once(template, monkeypatch, target, curves):
    """Without a last load another curve finds the end of the law."""
    calls, curve = [], mf.Interacting.curve
    monkeypatch.setattr(mf.Interacting, "curve", lambda *given, **by: calls.append(1) or curve(*given, **by))
    mf.design(target, template, mf.Interacting(), TALL)
    assert len(calls) == curves


@pytest.mark.parametrize("max_height", [0.12, 0.2])
def test_the_notes_of_a_law_are_those_of_its_own_loads(max_height):
    """Here the law ends before the branches of the target, at whose loads it is computed too."""
    template = mf.Surface.square_lattice(max_height, radius=0.526, material=mf.Material(1.36))
    model = mf.Interacting()
    design = mf.design(mf.LinearLaw(6.87), template, model)
    assert design.law.rescaled_load[-1] < design.fits[0][0].load_range[1]
    again = mf.friction_law(design.surface, model, load=design.law.load)
    assert said(design.law) == said(again)
