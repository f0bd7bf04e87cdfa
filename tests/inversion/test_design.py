"""Designs of all three kinds: exact where they can be, refused with a reason where they cannot."""

import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf
from metafem._kernels import continuation, independent
from metafem.inversion import DesignStatus
from tests.models.scenes import said

LIMITS = mf.Limits(max_height=0.12, offset=0.05)
LATTICE = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
TALL = mf.Limits(0.27)


def after(third, second=1.68):
    """Return three operating points with some frictions of the last two."""
    return mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, second, third])


POINTS = after(4.12)


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
