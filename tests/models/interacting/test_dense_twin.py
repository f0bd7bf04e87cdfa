"""The dense twin against the energy of its contacts."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from tests.models.interacting.dense_twin import Twin
from tests.models.scenes import scene


def sharpened(rho):
    return rho**2 / 1.1 + rho**4


LAWS = [
    mf.Hertz(),
    mf.PowerCap(1.5),
    mf.PowerCap(4),
    mf.SphericalCap(),
    mf.AxisymmetricCap(sharpened, 0.45),
]


def energy(twin, load, approach):
    """Complementary energy of loads: U* by the Legendre transform of the integral of the load over d."""
    law, radius = twin.law, twin.radius
    gx, gy, laplacian = twin.fields
    curvature = 0.5 * laplacian @ load
    low, high = np.zeros_like(load), np.full_like(load, 0.44)
    for _ in range(60):  # the radius at the load alone, and that with the curvature
        middle = 0.5 * (low + high)
        short = law.load(middle, radius) < load
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    own = 0.5 * (low + high)
    a = twin.disturbed_radius(load, own, curvature)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x = 0.5 * (nodes + 1.0)
    # U = int P dd over the contact radius, smooth in its fourth root; P dd/da = P P'/(2 a)
    inside = a * x[:, None] ** 4
    rate = np.stack([twin.load_slope(s, curvature) / (2.0 * s) for s in inside])
    part = law.load(inside, radius, curvature) * rate * 4.0 * a * x[:, None] ** 3
    elastic = load * law.indentation(a, radius, curvature) - 0.5 * weights @ part
    slope = (gx @ load) ** 2 + (gy @ load) ** 2
    work = 0.5 * load @ twin.point @ load - load @ (approach - twin.gap)
    return float((elastic - 2.0 / 3.0 * own**3 * slope).sum() + work)


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_the_equations_are_the_gradient_of_the_energy(law):
    twin = Twin(scene(), law, substrate=mf.BondedLayer())
    z = np.array([0.02, 0.03, 0.01, 0.025, 0.03, 0.015])
    approach = 0.06
    error, load, _, matrix = twin.equations(z, approach)
    for i in range(len(z)):
        step = np.zeros(len(z))
        step[i] = 1e-3 * load[i]
        near, far = (
            (energy(twin, load + s, approach) - energy(twin, load - s, approach)) / (2.0 * s[i])
            for s in (step, 2.0 * step)
        )
        assert (4.0 * near - far) / 3.0 == pytest.approx(error[i], rel=1e-6, abs=1e-8)
    # the matrix leaves out the second derivative of T, multiplied by the square of the slopes
    step = 1e-6
    for i in range(len(z)):
        moved = z + step * (np.arange(len(z)) == i), z - step * (np.arange(len(z)) == i)
        found = (twin.equations(moved[0], approach)[0] - twin.equations(moved[1], approach)[0]) / (2.0 * step)
        assert_allclose(found, matrix[:, i], atol=2e-3)
