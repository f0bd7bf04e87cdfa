"""Interacting asperities of any elastic law, against the dense twin and their own derivatives."""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.error import slope_effects
from tests.models.interacting.dense_twin import Twin
from tests.models.scenes import HEIGHT, Read, lattice, scene


def steeper(rho):
    return rho**2 / 1.1 + rho**4


LAWS = [
    mf.Elastic(mf.Power(1.5)),
    mf.Elastic(mf.Power(4)),
    mf.Elastic(mf.Sphere()),
    mf.Elastic(mf.Profile(steeper, 0.45)),
]
SUBSTRATES = [mf.HalfSpace(), mf.BondedLayer()]
# All contacts of the scene are steeper here than those whose tilt is bounded.
LOADS = np.array([0.01, 0.1])


@pytest.mark.parametrize("law", [mf.Hertz(), *LAWS], ids=repr)
def test_loads_and_areas_are_those_of_the_twin(law):
    for block in ({}, {"thickness": 1.0, "poisson_ratio": 0.3}):
        for order, substrate in product((1, 3), SUBSTRATES):
            # summits at one height: shallow contacts of a quartic cap are flatter than the least slope
            heights = HEIGHT if law == mf.Hertz() else np.array([0.1, 0.101, 0.1, 0.102, 0.101, 0.1])
            surface = scene(height=heights, **block)
            model, twin = mf.Interacting(order, substrate, law), Twin(surface, law, order, substrate)
            for load in LOADS:  # one at a time, as only the last load of a curve is solved to 1e-12
                curve = model.curve(surface, np.array([load]))
                assert curve.converged
                approach, p, area, residual = twin.solve(load=load)
                assert residual <= 1e-12
                # the offset of T is of the order of the moment of the flattest contact
                rtol = 1e-10 if order == 1 or law != mf.Elastic(mf.Power(4)) else 1e-5
                assert curve.approach[0] == pytest.approx(approach, rel=rtol)
                assert curve.area[0] == pytest.approx(area.sum(), rel=rtol)
                assert_allclose(curve.last.load, p, rtol=10 * rtol)
                again = model.curve(surface, approach=curve.approach)
                assert_allclose(again.load, load, rtol=1e-11)


def test_a_power_of_two_is_hertz():
    for order in (1, 3):
        surface, other = scene(), mf.Interacting(order, contact=Read(mf.Power(2.0)))
        model = mf.Interacting(order)
        found, expected = (one.curve(surface, LOADS) for one in (other, model))
        for name in ("approach", "load", "area"):
            assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-12)
        assert_allclose(found.stiffness, expected.stiffness, rtol=1e-9)
        gradients = (one.sensitivity(surface, LOADS).gradient for one in (other, model))
        assert_allclose(*gradients, rtol=1e-9, atol=1e-12)


# Loads and areas A0 of resolved contacts on a 3 x 3 lattice of quartic caps, with 90 cells per radius; bounds
# of the error of A0, and its value without the effect of the slopes of the neighbours' fields. The largest
# a/L is 0.27 and 0.35.
QUARTICS = [(1.3083, 4.4245, 0.0006, 0.0021), (4.7163, 7.3054, 0.002, 0.0058)]


@pytest.mark.parametrize(("load", "resolved", "error", "without"), QUARTICS)
def test_areas_of_quartic_caps_are_those_of_resolved_contacts(load, resolved, error, without):
    surface, law = lattice(0.5 * np.ones(9)), mf.Elastic(mf.Power(4))
    curve = mf.Interacting(contact=law).curve(surface, np.array([load]))
    assert 0.0 < curve.area[0] / resolved - 1.0 < error
    slope, _ = slope_effects(law, surface, curve.last.area, mf.HalfSpace())
    assert curve.area[0] * (1.0 + slope) / resolved - 1.0 == pytest.approx(without, rel=0.05)  # as printed
