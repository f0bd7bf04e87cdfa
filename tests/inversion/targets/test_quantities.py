"""Targets of stiffness and conductance with each option of a design, and under models that interact."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.core.inversion.test_quantities import (
    LAYER,
    LOADS,
    QUANTITIES,
    assert_found,
    known,
    predicted,
    rms,
    template,
)

POWER = mf.PowerLaw(0.45, (0.05, 0.2), of="stiffness")
STEPS, PINNED = mf.Limits(0.12, height_step=0.006), mf.Limits(0.12, pinned={0: 0.1, 3: None})


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting()], ids=repr)
def test_other_kinds_of_targets_and_options(model):
    wanted, some = predicted(known(), "stiffness", model), [1, 5, 11]
    points = mf.OperatingPoints(LOADS[some], wanted[some], of="stiffness")
    assert mf.design(points, template(), model).misfit < 1e-6
    band = mf.design(mf.Band(LOADS, 0.97 * wanted, 1.03 * wanted, of="stiffness"), template(), model)
    assert band.misfit == 0.0
    power = POWER if model.couples else mf.PowerLaw(0.55, (0.05, 0.2), of="stiffness")
    stepped = mf.design(power, template(), model, STEPS)
    assert stepped.misfit < 0.01
    assert_allclose(stepped.surface.gap / 0.006, np.rint(stepped.surface.gap / 0.006), atol=1e-9)
    pinned = mf.design(power, template(), model, PINNED)
    assert pinned.misfit < 5e-3
    assert pinned.surface.height[pinned.sites == 0] == [0.1]


@pytest.mark.parametrize("of", QUANTITIES)
def test_laws_of_known_surfaces_are_found(of):
    for model in (mf.Independent(), mf.Interacting(1), mf.Interacting(), LAYER):
        assert_found(of, model, 2)


@pytest.mark.parametrize("seed", [0, 5])
def test_few_asperities_of_unknown_sites_are_found(seed):
    rng, model = np.random.default_rng(seed), mf.Interacting()
    few = known(seed).only(rng.permutation(64)[: rng.integers(10, 40)])
    target = mf.SampledLaw(LOADS, predicted(few, "stiffness", model), of="stiffness")
    # the sites differ, and the stiffness depends on them
    assert mf.design(target, template(), model, rng=seed).misfit <= 5e-3


def test_models_without_gradients_use_those_of_another():
    surface, loads, model = known(), LOADS[::4], mf.Automatic(1e-2)
    wanted = model.curve(surface, loads).stiffness
    design = mf.design(mf.SampledLaw(loads, wanted, of="stiffness"), template(), model)
    assert rms(model.curve(design.surface, loads).stiffness, wanted) <= 2e-3
    assert "under the model half-space" in str(design.notes[0])


@pytest.mark.nightly
def test_resolved_contacts_meet_a_stiffness():
    """The stiffness of cells in contact jumps when a cell opens or closes, here by up to 1 %."""
    loads, model = np.array([0.02, 0.05]), mf.BoundaryElements(0.02)
    height = 0.06 + 0.06 * np.random.default_rng(0).random(9)
    surface = mf.Surface.square_lattice(height, (3, 3), radius=0.526, material=mf.Material(1.36))
    target = mf.SampledLaw(loads, model.curve(surface, loads).stiffness, of="stiffness")
    assert mf.design(target, surface.replaced(height=np.full(9, 0.12)), model).misfit <= 1e-2


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(1)], ids=repr)
def test_tools_reach_a_stiffness(model):
    wanted = predicted(known().replaced(radius=0.3), "stiffness", model)
    target = mf.SampledLaw(LOADS, wanted, of="stiffness")
    assert mf.design(target, template(), model, tools=[0.3, 0.526]).misfit <= 5e-3


def test_plastic_contacts_and_periodic_cells_conduct():
    cell = mf.PeriodicCell(12.0, 12.0)
    for model, more in ((mf.Independent(mf.KogutEtsion(10.0)), {}), (mf.Interacting(1), {"cell": cell})):
        target = mf.SampledLaw(LOADS, predicted(known(**more), "conductance", model), of="conductance")
        assert mf.design(target, template(**more), model).misfit <= 5e-3


def test_a_plot_draws_the_quantity():
    design = mf.design(POWER, template())
    ax = design.plot()
    assert ax.get_ylabel() == "stiffness  k/E* [mm]"
    expected = mf.friction_law(design.surface, load=design.law.load).rescaled_stiffness
    assert_allclose(ax.lines[0].get_ydata()[-100:], expected, rtol=1e-12)
    with pytest.raises(mf.InvalidInput, match="friction"):
        mf.studies.manufacturing(design.surface, 0.003, design=design, load_range=(0.01, 0.1))
