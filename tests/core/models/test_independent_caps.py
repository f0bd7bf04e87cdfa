"""Independent asperities whose contacts are no paraboloids."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.contact.by_profile import law_of
from metafem.contact.caps import PowerCap
from tests.models.scenes import HEIGHT, RADIUS, lattice, scene

HERTZ = mf.Hertz()
LOADS = np.geomspace(1e-6, 0.3, 25)


@dataclass(frozen=True)
class Own:
    """A law of one's own: Hertz's, with another name and no kernel."""

    law: mf.Hertz = HERTZ

    def __getattr__(self, name):
        return getattr(self.law, name)


def test_the_law_of_a_paraboloid_is_that_of_hertz():
    for law in (PowerCap(2, 0.5), Own()):
        model, hertz = mf.Independent(contact=law), mf.Independent()
        surface, rows = scene(), HEIGHT + 0.01 * np.arange(3)[:, None] * np.sin(np.arange(6))
        for found, expected in (
            (model.curve(surface, LOADS), hertz.curve(surface, LOADS)),
            (model.curve(surface, approach=LOADS), hertz.curve(surface, approach=LOADS)),
        ):
            for name in ("approach", "load", "area", "stiffness"):
                assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-12)
            assert_allclose(found.last.load, expected.last.load, rtol=1e-11)
            assert_allclose(found.last.indentation, expected.last.indentation, rtol=1e-11)
        shuffled = LOADS[::-1]
        assert_allclose(
            model.curves(rows, RADIUS, shuffled), hertz.curves(rows, RADIUS, shuffled), rtol=1e-12
        )
        assert_allclose(model.areas(surface, LOADS, rows), hertz.areas(surface, LOADS, rows), rtol=1e-12)
        sensitivities = (one.sensitivity(surface, LOADS, rows[1]).gradient for one in (model, hertz))
        assert_allclose(*sensitivities, rtol=1e-10, atol=1e-12)


def test_a_spherical_contact_far_beyond_its_radius_keeps_its_load():
    """The load under an approach of some radii is found again, and more than four radii are refused."""
    surface = scene(np.zeros((1, 2)), [0.5], 0.01)
    model = mf.Independent(contact=law_of(mf.Sphere()))
    state = mf.equilibrium(surface, model, approach=0.039)
    again = mf.equilibrium(surface, model, load=state.load)
    assert again.approach == pytest.approx(0.039, rel=1e-12)
    for beyond in ({"approach": 0.041}, {"load": 1.1 * state.load}):
        with pytest.raises(mf.InvalidInput, match="lighter loads"):
            mf.equilibrium(surface, model, **beyond)


def test_loads_beyond_what_a_law_can_carry_do_not_converge():
    class Limited(PowerCap):
        def load(self, contact_radius, radius, curvature=0.0):
            return np.minimum(super().load(contact_radius, radius, curvature), 0.01)

        def stiffness(self, contact_radius, radius, curvature=0.0):
            return 0.0 * np.asarray(contact_radius)

    with pytest.raises(mf.NotConverged):
        mf.equilibrium(lattice([0.1]), mf.Independent(contact=Limited(4.0)), load=1.0)
