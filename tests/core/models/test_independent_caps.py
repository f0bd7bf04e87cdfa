"""Independent asperities whose contacts are no paraboloids."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.scenes import HEIGHT, RADIUS, Read, lattice, scene

HERTZ = mf.Hertz()
LOADS = np.geomspace(1e-6, 0.3, 25)


@dataclass(frozen=True)
class Own:
    """A law of one's own: Hertz's, with another name and no kernel."""

    law: mf.Hertz = HERTZ

    def __getattr__(self, name):
        return getattr(self.law, name)


def test_the_law_of_a_paraboloid_is_that_of_hertz():
    for law in (Read(mf.Power(2.0)), Own()):
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


def test_a_sphere_is_pressed_up_to_its_equator_and_not_beyond():
    """Its contact ends at 0.9994 R, where D is 4.05 R; at a = R load and indentation have no limit."""
    surface = scene(np.zeros((1, 2)), [0.5], 0.4)
    model = mf.Independent(contact=mf.Elastic(mf.Sphere()))
    end = float(model.contact.largest_indentation(0.4))
    state = mf.equilibrium(surface, model, approach=end)
    assert state.asperity_area == pytest.approx(np.pi * (0.9994 * 0.4) ** 2, rel=1e-12)
    assert mf.equilibrium(surface, model, load=state.load).approach == pytest.approx(end, rel=1e-12)
    with pytest.raises(mf.InvalidInput, match="larger range"):
        mf.equilibrium(surface, model, approach=40.0)


def test_loads_beyond_what_a_law_can_carry_do_not_converge():
    class Limited(Read):
        def load(self, contact_radius, radius):
            return np.minimum(super().load(contact_radius, radius), 0.01)

        def stiffness(self, contact_radius, radius):
            return 0.0 * np.asarray(contact_radius)

    with pytest.raises(mf.NotConverged):
        mf.equilibrium(lattice([0.1]), mf.Independent(contact=Limited(mf.Power(4.0))), load=1.0)
