"""Targets of stiffness, tangential stiffness and conductance against laws of known surfaces."""

import numpy as np
import pytest
from metafem.inversion.quantities.quantity import measured
from numpy.testing import assert_allclose

import metafem as mf

LOADS = np.linspace(0.02, 0.3, 12)
QUANTITIES = ("stiffness", "tangential_stiffness", "conductance")
BLOCK, LAYER = mf.Block(20.0, 20.0, 7.2), mf.Interacting(substrate=mf.BondedLayer())


def template(ratio=0.5, **more):
    return mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36, ratio), **more)


def known(seed=0, **more):
    return template(**more).replaced(height=0.12 * np.random.default_rng(seed).beta(2.0, 2.0, 64))


def predicted(surface, of, model=None):
    """Return the rescaled quantity [mm] by the predictions, which do not know the inversion."""
    newtons = 1.36 * LOADS
    if of == "stiffness":
        return mf.friction_law(surface, model, load=newtons).rescaled_stiffness
    if of == "conductance":
        return mf.conductance(surface, model, load=newtons, resistivity=1.0).rescaled_conductance
    return mf.tangential_stiffness(surface, model, load=newtons) / 1.36


def rms(found, wanted):
    return np.sqrt(np.mean((found / wanted - 1.0) ** 2))


def test_measured_models_have_the_quantity_as_their_area():
    for model in [mf.Independent(), mf.Interacting(1), mf.Interacting(), LAYER]:
        surface = known(ratio=0.3, block=BLOCK)
        for of in QUANTITIES:
            expected, found = predicted(surface, of, model), measured(model, of, surface)
            assert_allclose(found.curve(surface, LOADS).area, expected, rtol=1e-12)
            # the dense systems of the sensitivities are solved once more
            assert_allclose(found.sensitivity(surface, LOADS).curve.area, expected, rtol=1e-10)


def test_caps_that_differ_have_the_quantity_as_their_area():
    caps = [mf.Power(4) if i % 2 else mf.Sphere() for i in range(64)]
    surface, model = known(cap=caps), mf.Independent(mf.Elastic())
    found = measured(model, "stiffness", surface).curve(surface, LOADS).area
    assert_allclose(found, predicted(surface, "stiffness", model), rtol=1e-12)


# The error of the gradients relative to the largest of each load. Differences lose 1e-10/1e-6 of the
# quantity, which rises as a root where contacts begin; order 3 leaves out changes of its terms.
def test_gradients_are_those_of_the_quantity():
    for model, tolerance in [
        (mf.Independent(), 1e-3),
        (mf.Interacting(1), 1e-6),
        (mf.Interacting(pedestal=True), 1e-3),
        (LAYER, 1e-3),
        (mf.Interacting(contact=mf.PowerCap(4)), 1e-2),
    ]:
        surface, step = known(block=BLOCK), 1e-6
        for of in QUANTITIES:
            solver = measured(model, of, surface)
            gradient = solver.sensitivity(surface, LOADS[::4]).gradient
            for i in (0, 20, 63):
                moved = surface.height + step * np.eye(64)[i], surface.height - step * np.eye(64)[i]
                high, low = (solver.sensitivity(surface, LOADS[::4], height).curve.area for height in moved)
                error = np.abs((high - low) / (2.0 * step) - gradient[:, i])
                assert (error <= tolerance * np.abs(gradient).max(axis=1)).all()


@pytest.mark.parametrize(
    ("of", "model"),
    [(QUANTITIES[1], mf.Independent()), (QUANTITIES[0], LAYER)],
)
def test_laws_of_known_surfaces_are_found(of, model):
    assert_found(of, model, 1)


def assert_found(of, model, seed):
    wanted = predicted(known(seed, block=BLOCK), of, model)
    design = mf.design(mf.SampledLaw(LOADS, wanted, of=of), template(block=BLOCK), model, rng=3)
    assert design.misfit <= 5e-3
    assert rms(predicted(design.surface, of, model), wanted) == pytest.approx(design.misfit, rel=1e-6)
    # the law of the design is its friction law
    assert design.law.model == model
    law = mf.friction_law(design.surface, model, load=design.law.load)
    assert_allclose(design.law.area, law.area, rtol=1e-12)


def test_the_highest_stiffness_is_that_of_equal_contacts():
    highest, flat = 64 * 2.0 * np.cbrt(0.75 * 0.526 * LOADS / 64), template()
    with pytest.raises(mf.Infeasible):
        mf.design(mf.OperatingPoints(LOADS, 1.01 * highest, of="stiffness"), flat)
    assert_allclose(measured(mf.Independent(), "stiffness", flat).curve(flat, LOADS).area, highest)
