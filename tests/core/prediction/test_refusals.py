"""Wrong input of the predictions is refused by its name and value."""

from functools import partial

import numpy as np

import metafem as mf
from tests.refusals import faults

RING = mf.Surface.square_lattice([0.1, 0.11, 0.12, 0.13], (2, 2), radius=0.526, material=mf.Material(1.36))
PLASTIC, STICKY = mf.Independent(mf.KogutEtsion(0.05)), mf.Independent(mf.JKR(9e-6))
RUBBED = RING.replaced(friction=mf.Friction(0.4))
law = partial(mf.friction_law, RING)


class Curves:
    """A model of a user that has curves alone."""

    name = "curves"

    def curve(self, surface, load=None, *, approach=None):
        return mf.Independent().curve(surface, load, approach=approach)


# Two of the words that an error must hold: the argument and the given value, or what limits it.
REFUSALS = [
    (lambda: mf.friction_law(3), "surface", "3"),
    (lambda: law(load=[0.1], separation=[0.1]), "load", "separation"),
    (lambda: law(load=[-0.1, 0.2]), "load", "-0.1"),
    (lambda: law(load=[]), "load", "empty"),
    (lambda: law(separation=[np.nan]), "separation", "nan"),
    (lambda: law(STICKY, separation=[0.1]), "separation", "load"),
    (lambda: law(load=[0.1], unloading=1), "unloading", "1"),
    (lambda: law(Curves(), load=[0.1], unloading=True), "unloading", "curves"),
    (lambda: law(load=[0.1]).friction_force, "friction", "Friction"),
    (lambda: law(load=[0.1]).friction_coefficient, "friction", "Friction"),
    (lambda: law().fit((5.0, 6.0)), "load_range", "(5, 6)"),
    (lambda: law().fit((0.4, 0.1)), "load_range", "(0.4, 0.1)"),
    (lambda: law().fit((1.0,)), "load_range", "(1,)"),
    (lambda: law().fit(), "load_range", "load"),
    (lambda: law(load=[0.1]).plot(units="kN"), "units", "kN"),
    (lambda: mf.equilibrium(RING, load=0.1, approach=0.1), "load", "approach"),
    (lambda: mf.equilibrium(RING, load=-1.0), "load", "-1"),
    (lambda: mf.equilibrium(RING, load=0.1).field, "field", "Independent()"),
    (lambda: mf.Interacting(contact=mf.KogutEtsion(0.05)), "order", "3"),
    (lambda: mf.onset(RUBBED, load=0.0), "load", "0"),
    (lambda: mf.onset(RING, load=0.1), "friction", "Friction"),
    (lambda: mf.Tolerances(height_sd=-0.001), "height_sd", "-0.001"),
    (lambda: mf.Tolerances(angle=0.8), "angle", "0.8"),
    (lambda: mf.Tolerances(radius_sd=0.06).perturbed(RING, 1, np.random.default_rng(0)), "radius_sd", "0.06"),
]


def test_wrong_input_is_refused_with_its_name_and_value():
    assert faults(REFUSALS) == []
