"""Targets of stiffness, tangential stiffness and conductance under models other than `Independent`."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.inversion.quantities.quantity import measured
from tests.inversion.targets.test_quantities import LOADS, QUANTITIES, known, predicted

BLOCK = mf.Block(20.0, 20.0, 7.2)

MODELS = {
    "order 1": mf.Interacting(1),
    "order 3": mf.Interacting(),
    "layer": mf.Interacting(substrate=mf.BondedLayer()),
    "mean field": mf.MeanField(),
}


@pytest.mark.parametrize("of", QUANTITIES)
@pytest.mark.parametrize("name", MODELS)
def test_measured_models_have_the_quantity_as_their_area(name, of):
    surface, model = known(block=BLOCK), MODELS[name]
    expected = predicted(surface, of, model)
    found = measured(model, of, surface)
    assert_allclose(found.curve(surface, LOADS).area, expected, rtol=1e-12)
    # the dense systems of the sensitivities are solved once more
    assert_allclose(found.sensitivity(surface, LOADS).curve.area, expected, rtol=1e-10)


# The error of the gradients relative to the largest of each load. Differences lose 1e-10/1e-6 of the
# quantity; order 3 leaves out changes of its terms.
@pytest.mark.parametrize(
    ("model", "tolerance"),
    [
        (mf.Interacting(1), 1e-6),
        (mf.Interacting(), 1e-3),
        (mf.Interacting(pedestal=True), 1e-3),
        (MODELS["layer"], 1e-3),
        (mf.Interacting(contact=mf.PowerCap(4)), 1e-2),
        (mf.MeanField(), 1e-6),
    ],
)
@pytest.mark.parametrize("of", QUANTITIES)
def test_gradients_are_those_of_the_quantity(of, model, tolerance):
    surface, step = known(block=BLOCK), 1e-6
    solver = measured(model, of, surface)
    gradient = solver.sensitivity(surface, LOADS[::4]).gradient
    for i in (0, 20, 63):
        moved = surface.height + step * np.eye(64)[i], surface.height - step * np.eye(64)[i]
        high, low = (solver.sensitivity(surface, LOADS[::4], height).curve.area for height in moved)
        error = np.abs((high - low) / (2.0 * step) - gradient[:, i])
        assert (error <= tolerance * np.abs(gradient).max(axis=1)).all()
