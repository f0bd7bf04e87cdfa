"""Arranged designs under interaction, with a choice of radii, and on more sites than asperities."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from tests.core.inversion.test_layout import LAYER, LIMITS, POWER, TILT, tilting


def test_heights_that_follow_the_law_need_less_refinement(template):
    dealt, placed = (mf.design(POWER, template, LAYER, LIMITS, layout=how) for how in (None, mf.Layout()))
    alone = mf.design(POWER, template, limits=LIMITS)
    assert placed.parameters["layout_after"] < 0.2 * placed.parameters["layout_before"]
    assert placed.status is DesignStatus.REFINED
    moved = [np.abs(np.sort(d.surface.height) - np.sort(alone.surface.height)).max() for d in (dealt, placed)]
    assert moved[1] < moved[0]
    assert (placed.layout, dealt.layout) == (mf.Layout(), None)


@pytest.mark.parametrize("model", [mf.Independent(), LAYER], ids=repr)
def test_a_tilt_changes_the_law_of_an_arranged_design_less(template, model):
    dealt = [tilting(mf.design(POWER, template, model, LIMITS, seed).surface, model) for seed in range(2)]
    placed = mf.design(POWER, template, model, LIMITS, layout=mf.Layout(False, TILT))
    assert tilting(placed.surface, model) < 0.4 * np.mean(dealt)
    assert any("tilt of 0.1 deg" in str(note) for note in placed.notes)


def test_the_best_radius_is_arranged():
    small = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
    options = {"layout": mf.Layout(tilt=TILT), "tools": [0.4, 0.526], "common_radius": True}
    found = mf.design(mf.PowerLaw(1.1, (0.03, 0.1)), small, limits=LIMITS, **options)
    assert found.parameters["layout_after"] < found.parameters["layout_before"]
    assert (found.surface.radius == found.parameters["radius"]).all()


def test_many_places_are_drawn():
    height = np.random.default_rng(0).exponential(0.03, 144)
    large = mf.Surface.square_lattice(height, (12, 12), radius=0.526, material=mf.Material(1.0))
    result = mf.arrange(large, mf.FollowLaw([0.3, 0.6]), mf.Interacting(order=1))
    assert result.after < 0.3 * result.before


def test_empty_places_are_taken_where_they_help():
    """Two asperities as near as they can be move as far apart as they can."""
    row = np.column_stack([1.5 * np.arange(6), np.zeros(6)])
    pair = mf.Surface(row[2:4], [0.1, 0.11], 0.526, mf.Material(1.36))
    result = mf.arrange(pair, mf.FollowLaw([0.02, 0.04]), position=row)
    assert np.abs(np.diff(result.sites)) == [5]
    assert result.after < 0.3 * result.before
