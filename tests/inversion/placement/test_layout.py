"""Designs whose heights take the places that suit interaction, or a tilt."""

import math

import numpy as np

import metafem as mf
from metafem.inversion import DesignStatus
from metafem.inversion.placement.layout import NO_EFFECT
from metafem.notes import information

LAYER = mf.Interacting(substrate=mf.BondedLayer())
POWER, LIMITS = mf.PowerLaw(1.2, (0.1, 0.4)), mf.Limits(0.27)
TILT = math.radians(0.1)

SMALL = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
SMALL_POWER = mf.PowerLaw(1.1, (0.03, 0.1))


def test_heights_that_follow_the_law_need_less_refinement(template):
    dealt, placed = (mf.design(POWER, template, LAYER, LIMITS, layout=how) for how in (None, mf.Layout()))
    alone = mf.design(POWER, template, limits=LIMITS)
    assert placed.parameters["layout_after"] < 0.2 * placed.parameters["layout_before"]
    assert placed.status is DesignStatus.REFINED
    moved = [np.abs(np.sort(d.surface.height) - np.sort(alone.surface.height)).max() for d in (dealt, placed)]
    assert moved[1] < 0.3 * moved[0]
    assert (placed.layout, dealt.layout) == (mf.Layout(), None)


def test_following_the_law_means_nothing_without_interaction(template):
    placed = mf.design(POWER, template, limits=LIMITS, layout=mf.Layout())
    assert information(NO_EFFECT) in placed.notes
    np.testing.assert_array_equal(
        placed.surface.height, mf.design(POWER, template, limits=LIMITS).surface.height
    )


def test_the_best_radius_is_arranged():
    layout = mf.Layout(tilt=TILT)
    found = mf.design(
        SMALL_POWER, SMALL, limits=LIMITS, layout=layout, tools=[0.4, 0.526], common_radius=True
    )
    assert found.parameters["layout_after"] < found.parameters["layout_before"]
    assert found.layout == mf.Layout(tilt=TILT)
    assert (found.surface.radius == found.parameters["radius"]).all()
