"""Heights whose contacts enter at the loads of independent asperities."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.adjustment.entries import shift
from metafem.inversion.candidate import Candidate
from metafem.inversion.problem import Problem
from metafem.inversion.search.target_law import TargetLaw

RADIUS = 0.526


def shifted(height, model):
    count = len(height)
    template = mf.Surface.square_lattice(0.3, (1, count), radius=RADIUS, material=mf.Material(1.36))
    law = TargetLaw.fixed(np.array([0.1]), np.array([1.0]))
    start = Candidate(height, np.full(count, RADIUS), {}, law, sites=np.arange(count))
    problem = Problem.checked(mf.OperatingPoints([0.1], [1.0]), template, model, mf.Limits(0.3))
    return start.surface(template).replaced(height=shift(problem, start)(height))


@pytest.mark.parametrize("cap", [mf.PowerCap(4), mf.SphericalCap(), mf.Hertz()], ids=repr)
def test_the_second_of_two_asperities_is_touched_at_the_same_load(cap):
    height, model = np.array([0.28, 0.25]), mf.Interacting(order=1, contact=cap)
    first = cap.load(cap.contact_radius(0.03, RADIUS), RADIUS)
    found = model.sensitivity(shifted(height, model), np.array([first]))
    np.testing.assert_allclose(found.indentation[0], [0.03, 0.0], rtol=1e-9, atol=1e-12)


def test_many_asperities_are_touched_at_nearly_the_same_loads():
    model = mf.Interacting(contact=mf.PowerCap(4))
    height = 0.28 - np.sort(np.random.default_rng(0).exponential(0.03, 12))
    surface = shifted(height, model)
    sizes = []
    for heights in (surface.height, height):
        load = np.linspace(0.01, 0.2, 40)
        coupled = model.curve(surface.replaced(height=heights), load).area
        sizes.append(np.abs(coupled / mf.Independent(contact=mf.PowerCap(4)).curve(
            surface.replaced(height=height), load).area - 1.0).max())  # fmt: skip
    assert sizes[0] < 0.5 * sizes[1]
