"""The mean field with any contact law."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

import metafem as mf
from metafem.caps.shapes import sphere_profile
from metafem.models.mean_field import nominal_area
from tests.models.scenes import lattice, scene

RHO = np.linspace(0.0, 0.4, 20)
LAWS = [
    mf.PowerCap(4),
    mf.AxisymmetricCap([RHO, sphere_profile(RHO, 0.526)]),
    mf.JacksonGreen(yield_strength=0.01).for_material(mf.Material(1.36)),
]
# Mean of 1/(pi r) over pairs of points of a unit square.
C = 0.946402008818677
APPROACHES = np.concatenate([[-0.1, 0.0], np.geomspace(1e-9, 0.15, 4)])


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_the_base_sinks_in_proportion_to_the_load(law):
    alone, sunk = mf.Independent(contact=law), mf.MeanField(law)
    surface = scene()
    load = np.geomspace(1e-6, 0.02, 4)
    found, expected = (model.curve(surface, load) for model in (sunk, alone))
    assert_allclose(found.area, expected.area, rtol=0.0)
    sinking = C / np.sqrt(nominal_area(surface)) * found.load
    assert_allclose(found.approach, expected.approach + sinking, rtol=1e-13)
    assert found.last.model == sunk
    at = sunk.curve(surface, approach=APPROACHES)
    assert at.converged
    assert (at.load[:2] == 0.0).all()
    assert_allclose(sunk.curve(surface, at.load[2:]).approach, APPROACHES[2:], rtol=1e-10)
    assert_allclose(*(model.sensitivity(surface, load).gradient for model in (sunk, alone)), rtol=0.0)


def test_the_mean_displacement_is_that_of_the_density_of_distances():
    """Points of a unit square are r apart with the density 2 r (pi - 4 r + r^2) up to r = 1, then another."""

    def beyond(r):
        root = np.sqrt(r**2 - 1.0)
        return 8.0 * root - 2.0 * (r**2 + 2.0 - np.pi) - 8.0 * np.arctan(root)

    near, far = 2.0 * (np.pi - 2.0 + 1.0 / 3.0), quad(beyond, 1.0, np.sqrt(2.0))[0]
    assert (near + far) / np.pi == pytest.approx(C, rel=1e-10)


def test_the_nominal_area_is_that_of_the_cells():
    assert nominal_area(lattice(np.full(9, 0.1))) == pytest.approx((3 * 1.5) ** 2, rel=1e-12)
