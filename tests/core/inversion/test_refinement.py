"""Heights that are refined under a model with interaction."""

import numpy as np

import metafem as mf
from metafem.inversion.adjustment.refinement import shift
from metafem.inversion.refinement import EXACT
from metafem.inversion.candidate import Candidate
from metafem.inversion.problem import Problem
from metafem.inversion.search.target_law import TargetLaw
from tests.models.scenes import PEDESTAL

MODELS = [mf.Interacting(), mf.Interacting(substrate=mf.BondedLayer()), PEDESTAL]


def lattice(max_height, shape):
    block = mf.Block(20, 20, 7.2)
    return mf.Surface.square_lattice(max_height, shape, radius=0.526, material=mf.Material(1.36), block=block)


def test_points_that_four_asperities_meet_are_met_on_any_number_of_sites():
    """Summits are added on empty sites where the friction must be raised, and only there."""
    for shape in [(2, 2), (3, 3)]:
        for model in MODELS:
            target = mf.OperatingPoints([0.02, 0.05], [0.16, 0.33])
            design = mf.design(target, lattice(0.3, shape), model, mf.Limits(0.3))
            assert design.misfit <= EXACT
            assert design.status is mf.DesignStatus.EXACT


def shifted(height, model):
    count = len(height)
    template = mf.Surface.square_lattice(0.3, (1, count), radius=0.526, material=mf.Material(1.36))
    law = TargetLaw.fixed(np.array([0.1]), np.array([1.0]))
    start = Candidate(height, np.full(count, 0.526), {}, law, sites=np.arange(count))
    problem = Problem.checked(mf.OperatingPoints([0.1], [1.0]), template, model, mf.Limits(0.3))
    return start.surface(template).replaced(height=shift(problem, start)(height))


def test_the_second_of_two_asperities_is_touched_at_the_same_load():
    for cap in [mf.Elastic(mf.Power(4)), mf.Elastic(mf.Sphere())]:
        height, model = np.array([0.28, 0.25]), mf.Interacting(order=1, contact=cap)
        first = cap.load(cap.contact_radius(0.03, 0.526), 0.526)
        found = model.sensitivity(shifted(height, model), np.array([first]))
        np.testing.assert_allclose(found.indentation[0], [0.03, 0.0], rtol=1e-9, atol=1e-12)


def test_many_asperities_are_touched_at_nearly_the_same_loads():
    model, load = mf.Interacting(contact=mf.Elastic(mf.Power(4))), np.linspace(0.01, 0.2, 40)
    height = 0.28 - np.sort(np.random.default_rng(0).exponential(0.03, 12))
    surface = shifted(height, model)
    alone = mf.Independent(contact=mf.Elastic(mf.Power(4))).curve(surface.replaced(height=height), load).area
    left, shift = (
        np.abs(model.curve(surface.replaced(height=h), load).area / alone - 1.0).max()
        for h in (height, surface.height)
    )
    assert shift < 0.5 * left
