"""Targets of stiffness, tangential stiffness and conductance against laws of known surfaces."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.inversion.quantities.quantity import measured

LOADS = np.linspace(0.02, 0.3, 12)
QUANTITIES = ("stiffness", "tangential_stiffness", "conductance")


def template(ratio=0.5, **more):
    return mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36, ratio), **more)


def known(seed=0, **more):
    rng = np.random.default_rng(seed)
    return template(**more).replaced(height=0.12 * rng.beta(2.0, 2.0, 64))


def predicted(surface, of, model=None):
    """Return the rescaled quantity [mm] by the predictions, which do not know the inversion."""
    modulus = surface.material.composite_modulus
    newtons = modulus * LOADS
    if of == "stiffness":
        return mf.friction_law(surface, model, load=newtons).rescaled_stiffness
    if of == "conductance":
        return mf.conductance(surface, model, load=newtons, resistivity=1.0).rescaled_conductance
    return mf.tangential_stiffness(surface, model, load=newtons) / modulus


@pytest.mark.parametrize("of", QUANTITIES)
@pytest.mark.parametrize("ratio", [0.3, 0.5])
def test_measured_contacts_have_the_quantity_as_their_area(of, ratio):
    surface = known(ratio=ratio)
    model = measured(mf.Independent(), of, surface)
    assert_allclose(model.curve(surface, LOADS).area, predicted(surface, of), rtol=1e-12)


def test_caps_that_differ_have_the_quantity_as_their_area():
    caps = [mf.Power(4) if i % 2 else mf.Sphere() for i in range(64)]
    surface, model = known(cap=caps), mf.Independent(mf.Elastic())
    found = measured(model, "stiffness", surface).curve(surface, LOADS).area
    assert_allclose(found, predicted(surface, "stiffness", model), rtol=1e-12)


def test_gradients_are_those_of_the_quantity():
    surface, step = known(), 1e-7
    model = measured(mf.Independent(), "stiffness", surface)
    found = model.sensitivity(surface, LOADS).gradient
    for i in (0, 20, 63):
        moved = surface.height + step * np.eye(64)[i], surface.height - step * np.eye(64)[i]
        high, low = (predicted(surface.replaced(height=h), "stiffness") for h in moved)
        expected = (high - low) / (2.0 * step)
        # differences lose 1e-10/1e-7 of the quantity, which rises as a root where contacts begin
        assert_allclose(found[:, i], expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("of", QUANTITIES)
@pytest.mark.parametrize("seed", range(3))
def test_laws_of_known_surfaces_are_found(of, seed):
    design = mf.design(mf.SampledLaw(LOADS, predicted(known(seed), of), of=of), template())
    assert design.misfit <= 5e-3
    assert design.law.model == mf.Independent()
    wanted, found = predicted(known(seed), of), predicted(design.surface, of)
    assert np.sqrt(np.mean((found / wanted - 1.0) ** 2)) == pytest.approx(design.misfit, rel=1e-9)
    # the law of the design is its friction law
    assert_allclose(design.law.area, mf.friction_law(design.surface, load=design.law.load).area, rtol=1e-12)


def test_quantities_cannot_exceed_their_bounds():
    """64 equal contacts have the highest stiffness, one contact the lowest."""
    highest = 64 * 2.0 * np.cbrt(0.75 * 0.526 * LOADS / 64)
    with pytest.raises(mf.Infeasible, match=r"at least 0\.3333"):
        mf.design(mf.PowerLaw(0.25, (0.05, 0.2), of="stiffness"), template())
    with pytest.raises(mf.Infeasible):
        mf.design(mf.OperatingPoints(LOADS, 1.01 * highest, of="stiffness"), template())
