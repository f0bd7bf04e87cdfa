"""Onset of sliding on the page and in data."""

import pytest

import metafem as mf
from metafem.report.sections.sliding import sliding_section


def surface(count, friction=None):
    return mf.Surface.square_lattice(
        0.1, (1, count), radius=0.526, material=mf.Material(1.36), friction=friction
    )


def test_words_and_data_state_the_law_at_full_sliding():
    part = surface(2, mf.Friction(0.404))
    found = mf.onset(part, load=0.02)
    data = mf.report.onset_data(found)
    law = mf.friction_law(part, load=[0.02])
    assert data["friction_force_N"][-1] == pytest.approx(law.friction_force[0], rel=1e-12)
    assert data["sliding_displacement_mm"] == data["displacement_mm"][-1]
    assert "the first of 2 contacts slides" in mf.report.onset_words(found)
    assert "the only contact slides" in mf.report.onset_words(
        mf.onset(surface(1, mf.Friction(0.404)), load=0.02)
    )


def test_the_page_draws_the_onset_only_with_a_friction():
    target = mf.OperatingPoints([0.05], [0.4])
    limits = mf.Limits(0.12)
    bare = mf.design(target, surface(16), limits=limits)
    assert sliding_section(bare) is None
    design = mf.design(target, surface(16, mf.Friction(0.404)), limits=limits)
    text = mf.report.page(design)
    assert "Onset of sliding" in text
    assert "tangential displacement" in text
