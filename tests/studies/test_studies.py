"""Studies of a small design: what they hold, and what they must agree with."""

from dataclasses import replace
from functools import partial
from importlib import import_module

import numpy as np
import pytest

import metafem as mf
from metafem.studies import summary
from metafem.studies.cap_contact import CapContact, caps_of, solve_caps
from metafem.studies.fidelity import _law_of_caps

# Radius of the cylinder with the base area of the block [mm].
SIDE = 20.0 / np.sqrt(np.pi)


@pytest.fixture(scope="module")
def design():
    material, block = mf.Material(1.36), mf.Block(20.0, 20.0, 7.2)
    template = mf.Surface.square_lattice(0.12, (2, 3), radius=0.526, material=material, block=block)
    return mf.design(mf.OperatingPoints([0.01, 0.03], [0.1, 0.26]), template)


@pytest.fixture(scope="module")
def interaction(design):
    return mf.studies.interaction(design, placements=7)


def test_interaction_as_placed_is_the_law_of_the_models(design, interaction):
    np.testing.assert_array_equal(interaction["load"], design.law.load)
    for name, substrate in (("half-space", mf.HalfSpace()), ("layer", mf.BondedLayer())):
        for order in (1, 3):
            model = mf.Interacting(order=order, substrate=substrate)
            found = interaction.sel(substrate=name, order=order)
            laws = [mf.friction_law(design.surface, m, load=found["load"]) for m in (mf.Independent(), model)]
            np.testing.assert_allclose(found.area_change, laws[1].area / laws[0].area - 1.0, atol=1e-10)
            np.testing.assert_allclose(found.sinking, laws[1].approach - laws[0].approach, atol=1e-12)


def test_comparisons_state_their_provenance_and_units(design, interaction):
    # the true block takes long
    template = design.template.replaced(block=None)
    fidelity = mf.studies.fidelity(mf.design(design.target, template), elements=False)
    assert interaction.attrs["seed"] == "0"
    assert interaction.attrs["draws"] == 7
    assert fidelity.attrs["seed"] == ""
    for found in (interaction, fidelity):
        assert found.attrs["metafem"]
        assert len(found.attrs["inputs"]) == 32
        assert found["load"].dims == ("rescaled_load",)
        for name in ("rescaled_load", "load", *found.data_vars):
            assert found[name].attrs["units"]


def test_random_placements_repeat_and_differ(design, interaction):
    again = mf.studies.interaction(design, placements=7)
    other = mf.studies.interaction(design, placements=7, rng=1)
    assert again.identical(interaction)
    assert not other.placement_rms.equals(interaction.placement_rms)


def test_random_placements_do_not_undo_the_sites_of_the_design():
    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.36))
    placed = mf.design(mf.LinearLaw(9.0), template, limits=mf.Limits(0.12, offset=0.05))
    sorted_heights = placed.surface.replaced(height=np.sort(placed.surface.height)[::-1])
    ordered = mf.studies.interaction(replace(placed, surface=sorted_heights), placements=1)
    change = ordered.area_change.sel(substrate="half-space", order=3).values[4::5]  # every fifth load
    first = mf.studies.interaction(placed, placements=1).placement_rms.values[0, 0]
    assert first != pytest.approx(np.sqrt((change**2).mean()), rel=1e-6)


def test_unequal_radii_are_placed_with_their_heights(design, interaction):
    # radii that differ by rounding alone are computed as unequal ones
    radius = np.full(design.surface.count, 0.526)
    radius[0] *= 1.0 + 1e-14
    uneven = replace(design, surface=design.surface.replaced(radius=radius))
    found = mf.studies.interaction(uneven, placements=7)
    np.testing.assert_allclose(found.placement_rms, interaction.placement_rms, rtol=1e-8)


def test_caps_of_several_radii_that_follow_hertz_are_independent_asperities(design):
    radii = np.array([0.3, 0.526, 0.8])
    surface = design.template.replaced(
        height=[0.12, 0.11, 0.1, 0.09, 0.08, 0.07], radius=radii[[0, 1, 2, 0, 1, 1]]
    )
    caps = {radius: CapContact(radius, (0.1, 0.1), (0.1, 0.2), np.zeros((1, 1, 2))) for radius in radii[:2]}
    load = np.array([0.005, 0.02])
    area, separation = _law_of_caps(surface, caps, load)
    alone = mf.Independent().curve(surface, load)
    np.testing.assert_allclose(area, alone.area, rtol=1e-9)
    np.testing.assert_allclose(separation, 0.12 - alone.approach, atol=1e-12)


def test_fidelity_states_what_is_left_out(design):
    surface = design.template.replaced(radius=np.linspace(0.4, 0.6, 6), block=None)
    bare = surface.replaced(height=np.full(6, 0.12))
    with pytest.raises(
        mf.InvalidInput, match="have 6 different radii; finite elements of caps are limited to 4 radii"
    ):
        caps_of(bare, np.full(6, 0.01))
    found = mf.studies.fidelity(replace(design, surface=bare, sites=np.arange(6)))
    assert list(found.model.values) == ["independent", "half-space"]
    assert "the surface has no block" in found.attrs["notes"]
    assert "fe is left out: the summits in contact have 6 different radii" in found.attrs["notes"]


@pytest.mark.slow
def test_each_radius_has_its_own_table(design):
    # of one height each, for which a table needs a third of the finite elements
    surface = design.template.replaced(
        height=[0.12, 0.12, 0.11, 0.11, 0.12, 0.06], radius=[0.3, 0.3, 0.8, 0.8, 0.3, 0.5]
    )
    indentation = np.array([0.02, 0.01, 0.02, 0.01, 0.02, -0.04])
    caps = caps_of(surface, indentation)
    assert list(caps) == [0.3, 0.8]
    found, load = solve_caps(surface, caps, indentation[:, None])
    for i in (0, 2):
        single = mf.fe.press(
            found[i, 0], surface.radius[i], height=surface.height[i], thickness=7.2, block_radius=SIDE
        )
        error = 30.0 * caps[surface.radius[i]].error
        assert load[i, 0] == pytest.approx(single.rescaled_load, rel=error)
        assert single.indentation == pytest.approx(0.02, rel=error)
    assert found[5] == load[5] == 0.0


@pytest.fixture(scope="module")
def fidelity(design, tmp_path_factory):
    """The laws under all models, on a block of large cells, and the table of its caps by finite elements."""
    kept, module = [], import_module("metafem.studies.fidelity")
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setattr("metafem.fe.block3d.cache.cache_folder", lambda: folder)
        patch.setattr("metafem.fe.Block3D", partial(mf.fe.Block3D, cell=0.5, edge_cell=0.05))
        patch.setattr(module, "caps_of", lambda *given: kept.append(caps_of(*given)) or kept[0])
        return mf.studies.fidelity(design), kept[0][0.526]


@pytest.mark.slow
def test_tabulated_caps_are_those_of_the_finite_elements(fidelity):
    _, contact = fidelity
    h, a = np.mean(contact.height), 0.08
    single = mf.fe.press(a, 0.526, height=h, thickness=7.2, block_radius=SIDE)
    radius, load = contact.solve(np.array([h, h]), np.array([single.indentation, -0.01]))
    # an order above the error that the table finds of itself, at another place
    assert contact.error < 1e-3
    np.testing.assert_allclose(radius, [a, 0.0], rtol=10.0 * contact.error)
    np.testing.assert_allclose(load, [single.rescaled_load, 0.0], rtol=30.0 * contact.error)


@pytest.mark.slow
def test_fidelity_holds_all_models(fidelity):
    found, _ = fidelity
    assert list(found.model.values) == ["independent", "half-space", "layer", "block", "fe"]
    # the block lies between layer and half-space; each model sinks less than the half-space does
    sinking = found.sinking.isel(rescaled_load=-1)
    assert sinking.sel(model="layer") < sinking.sel(model="block") < sinking.sel(model="half-space")
    # small strain and the cap's shape: a load more than Hertz's at the same radius, so less area
    assert -0.05 < found.area_change.sel(model="fe").isel(rescaled_load=-1) < 0.0
    assert len(summary(found).rows) == 5
