"""Refused values of the models, and of what they compute."""

from functools import partial

import numpy as np
import pytest

import metafem as mf
from metafem.caps.shapes import sphere_profile
from metafem.models._resources import require_memory
from metafem.models.boundary_elements.cells import Scene
from metafem.models.boundary_elements.solve import require_extent
from tests.models.scenes import lattice, scene
from tests.refusals import faults
from validation.scenes.periodic import THREE

RHO = np.linspace(0.0, 0.165, 30)
NARROW = mf.Elastic(mf.Profile([RHO, sphere_profile(RHO, 0.526)]))
FLAT, SOME = lattice(np.full(4, 0.1)), lattice(0.12 - 0.002 * np.arange(9))
LAYER, JKR, PLASTIC = mf.BondedLayer(), mf.JKR(9e-6), mf.KogutEtsion(0.1)
ONE = mf.Surface([[0.2, -0.1]], [0.1], 0.526, mf.Material(1.36), cell=mf.PeriodicCell(1.5, 1.5))


class Sticky(mf.Elastic):
    """A law whose branches no model knows."""

    adhesive = True


class Known(mf.Hertz):
    """A law without a profile."""

    largest_order = 1


def state(surface=SOME, model=None, **given):
    return partial(mf.equilibrium, surface, model or mf.Independent(), **given)


def law(model, surface=SOME, **given):
    return partial(mf.friction_law, surface, model, **given)


def capped(cap):
    return partial(FLAT.replaced, cap=cap)


def wide_contact():
    """A contact of cells that is wider than the profile."""
    require_extent(Scene(FLAT, 0.01, mf.HalfSpace(), NARROW), np.full(1, 1500.0))


def scattered():
    """Many sites of a periodic cell that are no grid."""
    height = np.full(2116, 0.1)
    sites = lattice(height).position + 0.1 * np.random.default_rng(6).random((2116, 2))
    return scene(sites, height, 0.526).replaced(cell=mf.PeriodicCell(73.0, 73.0))


REFUSALS = [
    (lambda: mf.Independent(contact=4), "contact", "4"),
    (lambda: mf.Automatic(0.0), "tolerance", "0"),
    (lambda: mf.Automatic(substrate=3), "substrate", "3"),
    (lambda: mf.Interacting(contact=4), "contact", "4"),
    (lambda: mf.Interacting(2), "order", "2"),
    (lambda: mf.Interacting(contact=Known()), "order = 3", "Known"),
    (lambda: mf.Interacting(contact=JKR), "order = 3", "JKR"),
    (lambda: mf.Interacting(substrate=mf.HalfSpace), "substrate", "HalfSpace"),
    (lambda: mf.Interacting(pedestal=1), "pedestal", "1"),
    (lambda: mf.BoundaryElements(0.0), "cell", "0"),
    (lambda: mf.BoundaryElements(0.01, 3), "substrate", "3"),
    (lambda: mf.BoundaryElements(0.01, contact=Sticky(mf.Power(4.0))), "contact", "Sticky"),
    (law(mf.Independent(Sticky(mf.Power(4.0))), load=[0.1]), "contact", "Sticky"),
    (state(), "load, approach and separation", "none"),
    (state(load=1e-100), "load", "1e-100"),
    (law(mf.Independent(), load=[0.1, 1e-100]), "load", "1e-100"),
    (law(mf.Interacting(1), load=[1e-300]), "load", "1e-300"),
    (state(load=1.0, approach=0.1), "'load'", "'approach'"),
    (state(load=1.0, surface=3), "surface", "3"),
    (partial(mf.equilibrium, SOME, "independent", load=1.0), "model", "independent"),
    (lambda: mf.Independent().curve(SOME), "load", "approach"),
    (law(mf.Interacting(1, contact=JKR), separation=[0.1]), "separation", "adhesive"),
    (law(mf.Interacting(1, contact=JKR), load=[0.0], unloading=True), "load", "0"),
    (law(mf.Interacting(1, contact=JKR), load=[-1.0, 1.0]), "load", "-1"),
    (law(mf.Independent(), load=[-1.0, 1.0], unloading=True), "load", "-1"),
    (law(mf.Automatic(), load=[1.0], unloading=True), "unloading", "True"),
    (law(mf.Independent(), load=[1.0], unloading=1), "unloading", "1"),
    (law(mf.Independent(mf.JKR(10.0)), load=[0.01]), "adhesion_energy", "10"),
    (state(ONE, mf.Interacting(1, contact=mf.JKR(0.2)), load=0.02), "adhesion_energy", "0.2"),
    (state(FLAT, mf.Interacting(contact=NARROW), load=0.5), "asperity", "Profile("),
    (
        state(scene([[0, 0]], [0.5], 5.0, thickness=0.3), mf.Interacting(3, LAYER), approach=0.4),
        "layer",
        "0.3",
    ),
    (state(ONE, mf.Interacting(), load=3.0), "cell", "1.5"),
    (state(THREE, mf.Interacting(substrate=mf.fe.Block3D()), load=0.1), "Block3D", "cell"),
    (lambda: mf.equilibrium(scattered(), mf.Interacting(), load=5.0), "cell", "2116"),
    (lambda: mf.PeriodicCell(-1.0, 2.0), "width", "-1"),
    (lambda: THREE.replaced(cell=(3.0, 3.0)), "cell", "(3.0, 3.0)"),
    (lambda: THREE.replaced(cell=mf.PeriodicCell(0.3, 3.0)), "cell.width", "0.3"),
    (lambda: THREE.replaced(cell=mf.PeriodicCell(3.0, 1.0)), "cell.length", "1"),
    (lambda: THREE.tilted(0.01, 0.0), "tilted", "cell"),
    (state(SOME.replaced(cap=mf.Power(2.0)), mf.Interacting(pedestal=True), load=0.1), "pedestal", "Power("),
    (state(SOME.replaced(cap=mf.Power(4)), load=0.1), "cap", "Power("),
    (state(SOME, mf.BoundaryElements(0.1), load=0.05), "cell", "0.1"),
    (state(SOME, mf.BoundaryElements(1e-6), load=0.05), "memory", "GiB"),
    (lambda: require_memory(1e18, "a scene"), "a scene", "GiB"),
    (wide_contact, "radius", "0.2185"),
    (state(ONE, mf.BoundaryElements(0.02), load=2.0), "periodic cell", "Interacting"),
    (lambda: mf.equilibrium(SOME, mf.Interacting(), load=0.1).field, "field", "Interacting("),
    (law(mf.Interacting(1, contact=PLASTIC), load=[5e-4], unloading=True), "unloading", "True"),
    (law(mf.Independent(PLASTIC), load=[5e-4], unloading=True), "unloading", "True"),
    (capped("sphere"), "cap", "'sphere'"),
    (capped([mf.Sphere()]), "cap", "1"),
    (capped([mf.Sphere(), 2, mf.Sphere(), mf.Sphere()]), "cap[1]", "2"),
    (lambda: mf.Power(40.0), "exponent", "40"),
    (lambda: mf.Profile([[0.0, 0.1, 0.2], [0.0, 0.02, 0.01]]), "f", "0.02"),
]


@pytest.mark.parametrize(("call", "key", "value"), REFUSALS)
def test_refusals(call, key, value):
    assert faults([(call, key, value)]) == []
