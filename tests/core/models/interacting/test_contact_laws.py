"""Interacting asperities of any elastic law, against their equations in numpy and resolved contacts."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.models.error import slope_effects
from tests.models.scenes import lattice, scene
from validation.methods import third_order
from validation.methods.equation_errors import equation_error

SUBSTRATES = [mf.HalfSpace(), mf.BondedLayer()]


def steeper(rho):
    return rho**2 / 1.1 + rho**4


LAWS = [
    mf.Hertz(),
    mf.Elastic(mf.Power(1.5)),
    mf.Elastic(mf.Sphere()),
    mf.Elastic(mf.Profile(steeper, 0.45)),
    mf.Elastic(mf.Power(4)),
]
MODELS = [
    *(mf.Interacting(order, on, law) for law in LAWS for on in SUBSTRATES for order in (1, 3)),
    mf.Independent(mf.JKR(9e-6)),
    mf.Interacting(1, mf.BondedLayer(), mf.KogutEtsion(3.0)),
    mf.Interacting(3, contact=mf.Elastic(mf.Sphere()), pedestal=True),
]


def test_solutions_obey_the_equations_and_changed_ones_do_not():
    """The equations in plain numpy, with the laws themselves; some asperities stay open."""
    for model, block in product(MODELS, ({}, {"thickness": 1.0, "poisson_ratio": 0.3})):
        surface = scene(**block)
        for load in (0.01, 0.1):  # one at a time, as only the last load of a curve is solved to 1e-12
            curve = model.curve(surface, np.array([load]))
            error = equation_error(surface, model, curve)
            if np.isnan(error):  # a quartic cap at order 3, whose tilt is limited where it is flat
                continue
            assert error < 1e-9, (model, load)
            # a shift of the plane by 1e-6 mm is an error of the order of the change
            shifted = replace(curve, approach=curve.approach + 1e-6)
            assert equation_error(surface, model, shifted) > 1e-7
            again = model.curve(surface, approach=curve.approach)
            assert_allclose(again.load, load, rtol=1e-11)


def test_third_order_of_power_caps_is_that_of_another_solver():
    """Nine closed contacts; shallow contacts of a quartic cap are flatter than the least slope."""
    for exponent, rtol in ((1.5, 1e-10), (4.0, 1e-5)):
        surface = lattice(0.1 + 0.002 * np.arange(9))
        model = mf.Interacting(contact=mf.Elastic(mf.Power(exponent)))
        curve = model.curve(surface, np.array([0.2]))
        on, caps = third_order.fields(surface.position), third_order.Caps(surface.radius, exponent)
        approach, radius = third_order.solved(caps, on, surface.gap, 0.2)
        assert curve.approach[0] == pytest.approx(approach, rel=rtol)
        assert_allclose(curve.last.area, np.pi * radius**2, rtol=10 * rtol)


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
