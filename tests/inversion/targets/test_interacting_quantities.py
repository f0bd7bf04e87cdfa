"""Targets of stiffness, tangential stiffness and conductance under models other than `Independent`."""

import numpy as np
import pytest

import metafem as mf
from tests.inversion.targets.test_quantities import LOADS, QUANTITIES, known, predicted, template
from validation.scenes.quantities import exact_stiffness

BLOCK = mf.Block(20.0, 20.0, 7.2)

MODELS = {
    "order 1": mf.Interacting(1),
    "order 3": mf.Interacting(),
    "layer": mf.Interacting(substrate=mf.BondedLayer()),
    "mean field": mf.MeanField(),
}

# A law of a known surface is found if its misfit is at most this.
FOUND = 2e-3


def rms(found, wanted):
    return np.sqrt(np.mean((found / wanted - 1.0) ** 2))


@pytest.mark.parametrize("of", QUANTITIES)
@pytest.mark.parametrize("name", MODELS)
def test_laws_of_known_surfaces_are_found(name, of):
    model, sites = MODELS[name], template(block=BLOCK)
    wanted = predicted(known(1, block=BLOCK), of, model)
    design = mf.design(mf.SampledLaw(LOADS, wanted, of=of), sites, model, rng=3)
    assert design.misfit <= FOUND
    assert design.law.model == model
    assert rms(predicted(design.surface, of, model), wanted) == pytest.approx(design.misfit, rel=1e-6)


def test_the_stiffness_of_the_energy_is_that_of_the_target():
    model, wanted = mf.Interacting(1), exact_stiffness(mf.Interacting(1), known(2), LOADS)
    design = mf.design(mf.SampledLaw(LOADS, wanted, of="stiffness"), template(), model)
    assert rms(exact_stiffness(model, design.surface, LOADS), wanted) <= FOUND


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_few_asperities_of_unknown_sites_are_found(seed):
    rng, model = np.random.default_rng(seed), mf.Interacting()
    some = rng.permutation(64)[: rng.integers(10, 40)]
    few = known(seed).only(some)
    target = mf.SampledLaw(LOADS, predicted(few, "stiffness", model), of="stiffness")
    # the sites differ, and the stiffness depends on them
    assert mf.design(target, template(), model, rng=seed).misfit <= 5e-3


def test_models_without_gradients_use_those_of_another():
    surface, loads, model = known(), LOADS[::4], mf.Automatic(1e-2)
    wanted = model.curve(surface, loads).stiffness
    design = mf.design(mf.SampledLaw(loads, wanted, of="stiffness"), template(), model)
    assert design.misfit <= FOUND
    assert rms(model.curve(design.surface, loads).stiffness, wanted) == pytest.approx(design.misfit, rel=1e-6)
    assert (
        str(design.notes[0]) == "the first heights were found under the model half-space, which has gradients"
    )


@pytest.mark.slow
def test_resolved_contacts_meet_a_stiffness():
    """The stiffness of cells in contact jumps when a cell opens or closes, here by up to 1 %."""
    surface, loads, model = nine(), np.array([0.02, 0.05]), mf.BoundaryElements(0.02)
    wanted = model.curve(surface, loads).stiffness
    target = mf.SampledLaw(loads, wanted, of="stiffness")
    assert mf.design(target, surface.replaced(height=np.full(9, 0.12)), model).misfit <= 1e-2


def nine():
    height = 0.06 + 0.06 * np.random.default_rng(0).random(9)
    return mf.Surface.square_lattice(height, (3, 3), radius=0.526, material=mf.Material(1.36))


def test_other_kinds_of_targets_and_options():
    model, target = mf.Interacting(), mf.PowerLaw(0.45, (0.05, 0.2), of="stiffness")
    stiffness = predicted(known(), "stiffness", model)
    points = mf.OperatingPoints(LOADS[[1, 5, 11]], stiffness[[1, 5, 11]], of="stiffness")
    assert mf.design(points, template(), model).misfit < 1e-6
    band = mf.design(mf.Band(LOADS, 0.97 * stiffness, 1.03 * stiffness, of="stiffness"), template(), model)
    assert band.misfit == 0.0
    stepped = mf.design(target, template(), model, mf.Limits(0.12, height_step=0.006))
    assert stepped.misfit < 0.01
    pinned = mf.design(target, template(), model, mf.Limits(0.12, pinned={0: 0.1, 3: None}))
    assert pinned.misfit <= FOUND
    assert pinned.surface.height[pinned.sites == 0] == [0.1]


@pytest.mark.slow
def test_two_tools():
    model = mf.Interacting(1)
    wanted = predicted(known().replaced(radius=0.3), "stiffness", model)
    target = mf.SampledLaw(LOADS, wanted, of="stiffness")
    assert mf.design(target, template(), model, tools=[0.3, 0.526]).misfit <= 5e-3


def test_a_periodic_cell():
    model = mf.Interacting(1)
    cell = template(cell=mf.PeriodicCell(12.0, 12.0))
    wanted = predicted(cell.replaced(height=known().height), "conductance", model)
    assert mf.design(mf.SampledLaw(LOADS, wanted, of="conductance"), cell, model).misfit <= FOUND
