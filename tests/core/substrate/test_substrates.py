"""Half-space and bonded layer against quadrature, printed values and limits."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

import metafem as mf

RATIOS = (0.0, 0.3, 0.45, 0.5)


def deficit_oracle(x, poisson_ratio):
    """1 - M as it is printed, in many digits."""
    kappa = 3 - 4 * mpmath.mpf(poisson_ratio)
    upper = 2 * kappa * mpmath.sinh(2 * x) - 4 * x
    return 1 - upper / (2 * kappa * mpmath.cosh(2 * x) + 4 * x**2 + 1 + kappa**2)


def layer_oracle(s, poisson_ratio):
    """g, g' and g'' of `metafem._kernels.layer` by mpmath's quadrature of the Hankel integral."""
    with mpmath.workdps(30):

        def integral(bessel):
            def integrand(x):
                return deficit_oracle(x, poisson_ratio) * bessel(x)

            return -float(mpmath.quad(integrand, [0, 4, 12, 30], maxdegree=5, method="gauss-legendre"))

        return (
            integral(lambda x: mpmath.besselj(0, x * s)),
            integral(lambda x: -x * mpmath.besselj(1, x * s)),
            integral(lambda x: x**2 * (mpmath.besselj(2, x * s) - mpmath.besselj(0, x * s)) / 2),
        )


def test_layer_agrees_with_the_hankel_integral():
    for poisson_ratio, s in ((0.5, 0.21), (0.5, 3.7), (0.3, 1.06), (0.0, 0.83)):
        layer = mf.BondedLayer(thickness=1.0, poisson_ratio=poisson_ratio)
        computed = np.array(layer.regular_derivatives(np.array([s]))).ravel() * np.pi
        half_space = np.array([1 / s, 1 / s**2, 2 / s**3])
        error = np.abs(computed - layer_oracle(s, poisson_ratio)) / half_space
        assert (error < 1e-12).all()


def test_table_is_continuous_and_ends_below_its_bound():
    for poisson_ratio in RATIOS:
        layer = mf.BondedLayer(1.0, poisson_ratio)
        joints = np.arange(1, 385) / 8
        left, right = (layer.regular_derivatives(joints * factor) for factor in (1 - 1e-15, 1 + 1e-15))
        for power, (a, b) in enumerate(zip(left, right, strict=True)):
            assert (np.abs(a - b) * joints ** (power + 1)).max() < 1e-9


def test_self_terms_of_the_layer():
    """Integrals of the deficit and of its second moment, printed to three decimals."""
    for poisson_ratio, influence, curvature in (
        (0.5, 1.770, 3.831),
        (0.45, 1.625, 3.346),
        (0.3, 1.377, 2.510),
    ):
        layer = mf.BondedLayer(7.2, poisson_ratio)
        assert -layer.self_influence * np.pi * 7.2 == pytest.approx(influence, abs=5e-4)
        assert layer.self_curvature * 2 * np.pi * 7.2**3 == pytest.approx(curvature, abs=1e-3)
        assert layer.self_influence == pytest.approx(float(layer.regular(0.0)), rel=1e-12)
        curvature_at_zero = float(layer.regular_derivatives(np.array([0.0]))[2][0])
        assert layer.self_curvature == pytest.approx(curvature_at_zero, rel=1e-12)


@given(st.sampled_from(RATIOS), st.floats(0.3, 1e6), st.floats(1e-3, 100.0))
def test_derivatives_agree_with_differences(poisson_ratio, thickness, distance):
    layer = mf.BondedLayer(thickness, poisson_ratio)
    step = 1e-4 * min(distance, thickness)
    (a, a1, _), (_, b1, b2), (c, c1, _) = (
        layer.influence(distance + shift, derivatives=True) for shift in (-step, 0.0, step)
    )
    scale = 1.0 / (np.pi * distance)
    truncation = 100.0 * (step / min(distance, thickness)) ** 2
    assert abs((c - a) / (2 * step) - b1) < (truncation + 1e-10) * scale / min(distance, thickness)
    assert abs((c1 - a1) / (2 * step) - b2) < (truncation + 1e-5) * scale / min(distance, thickness) ** 2


def test_layer_reads_its_values_from_the_surface():
    surface = mf.Surface(
        [[0, 0], [1, 0]], 0.1 * np.ones(2), 0.5, mf.Material(1, 0.45), block=mf.Block(20, 20, 7.2)
    )
    assert mf.BondedLayer().for_surface(surface) == mf.BondedLayer(7.2, 0.45)
    matrix = mf.BondedLayer().influence_matrix(surface)
    assert matrix[0, 1] == matrix[1, 0] == mf.BondedLayer(7.2, 0.45).influence(1.0)
    assert matrix[0, 0] == mf.BondedLayer(7.2, 0.45).self_influence


def test_gradient_points_away_from_the_source():
    surface = mf.Surface([[0, 0], [3, 4]], [0.1, 0.1], 0.5, mf.Material(1))
    gx, gy, laplacian = mf.HalfSpace().influence_derivatives(surface)
    assert_allclose([gx[0, 1], gy[0, 1]], np.array([3, 4]) / (np.pi * 125), rtol=1e-14)
    assert_allclose(gx, -gx.T, rtol=0)
    assert_allclose(laplacian, [[0, 1 / (np.pi * 125)], [1 / (np.pi * 125), 0]], rtol=1e-14)
