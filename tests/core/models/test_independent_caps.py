"""Independent asperities whose contacts are no paraboloids."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.scenes import HEIGHT, Read, lattice, scene

HERTZ = mf.Hertz()
LOADS = np.geomspace(1e-6, 0.3, 25)


@dataclass(frozen=True)
class Own:
    """A law of one's own: Hertz's, with another name and no kernel."""

    law: mf.Hertz = HERTZ

    def __getattr__(self, name):
        return getattr(self.law, name)


@pytest.mark.parametrize("order", [0, 1, 3])
def test_the_law_of_a_paraboloid_is_that_of_hertz(order):
    def model(law):
        return mf.Interacting(order, contact=law) if order else mf.Independent(law)

    surface, rows, hertz = scene(), HEIGHT + 0.01 * np.arange(3)[:, None] * np.sin(np.arange(6)), model(HERTZ)
    for one in (model(Read(mf.Power(2.0))), *([] if order else [model(Own())])):
        for given in ({"load": LOADS}, {"approach": LOADS}):
            found, expected = (each.curve(surface, **given) for each in (one, hertz))
            for name in ("approach", "load", "area"):
                assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-12)
            assert_allclose(found.stiffness, expected.stiffness, rtol=1e-9)
            assert_allclose(found.last.load, expected.last.load, rtol=1e-11)
        assert_allclose(one.areas(surface, LOADS, rows), hertz.areas(surface, LOADS, rows), rtol=1e-12)
        gradients = (each.sensitivity(surface, LOADS, rows[1]).gradient for each in (one, hertz))
        assert_allclose(*gradients, rtol=1e-9, atol=1e-12)


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
