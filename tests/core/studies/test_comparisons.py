"""Studies of a small design: what they hold, and what they must agree with."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.studies import summary


@pytest.fixture(scope="module")
def interaction(design):
    return mf.studies.interaction(design, assignments=7)


def test_interaction_as_placed_is_the_law_of_the_models(design, interaction):
    np.testing.assert_array_equal(interaction["load"], design.law.load)
    for name, substrate in (("half-space", mf.HalfSpace()), ("layer", mf.BondedLayer())):
        model = mf.Interacting(substrate=substrate)
        found = interaction.sel(substrate=name)
        laws = [mf.friction_law(design.surface, m, load=found["load"]) for m in (mf.Independent(), model)]
        np.testing.assert_allclose(found.area_change, laws[1].area / laws[0].area - 1.0, atol=1e-10)
        np.testing.assert_allclose(found.sinking, laws[1].approach - laws[0].approach, atol=1e-12)


def test_random_assignments_repeat_and_differ(design, interaction):
    again = mf.studies.interaction(design, assignments=7)
    other = mf.studies.interaction(design, assignments=7, rng=1)
    assert again.identical(interaction)
    assert (again.attrs["seed"], again.attrs["draws"]) == ("0", 7)
    assert not other.assignment_rms.equals(interaction.assignment_rms)


def test_fidelity_states_what_is_left_out(design):
    radius, height = np.linspace(0.4, 0.6, 6), np.full(6, 0.12)
    bare = design.template.replaced(radius=radius, height=height, block=None)
    found = mf.studies.fidelity(replace(design, surface=bare, sites=np.arange(6)))
    assert list(found.model.values) == ["independent", "half-space"]
    assert "no block" in found.attrs["notes"]


def test_the_summary_of_an_interaction_holds_each_substrate(interaction):
    rows, change = summary(interaction).rows, 100.0 * interaction.area_change.values
    assert [row[0] for row in rows] == ["half-space", "layer"]
    sinking, placed = 1000.0 * interaction.sinking.values[:, -1], 100.0 * interaction.assignment_rms.values
    for k, row in enumerate(rows):
        moments = [np.sqrt((change[k] ** 2).mean()), np.abs(change[k]).max(), sinking[k]]
        expected = [*moments, np.median(placed[k]), placed[k].max()]
        shown = [abs(float(cell)) for cell in (*row[1:3], *row[6:])]
        np.testing.assert_allclose(shown, expected, atol=0.0051)
