"""Derivatives of contact laws by the shape of the cap at a given contact radius, against mpmath."""

import mpmath
import numpy as np
import pytest

import metafem as mf

RADIUS = 0.526
QUARTER = [0, mpmath.pi / 2]


def depth_of(slope):
    """D of a cap with the slope f'(rho), a function of the contact radius."""
    return lambda s: s * mpmath.quad(lambda t: slope(s * mpmath.sin(t)), QUARTER)


def exact(slope, a):
    """D, D', D'', P and M of a cap with the slope f'(rho) at the contact radius a, by quadrature.

    The integrals of D and of s^2 D up to a are those of f' U and of f' (U^3 / 3 + rho^2 U) over rho, with
    U^2 = a^2 - rho^2.
    """
    depth = depth_of(slope)
    rho, u = (lambda t: a * mpmath.sin(t)), (lambda t: a * mpmath.cos(t))
    first = mpmath.quad(lambda t: slope(rho(t)) * u(t) ** 2, QUARTER)
    second = mpmath.quad(lambda t: slope(rho(t)) * (u(t) ** 4 / 3 + rho(t) ** 2 * u(t) ** 2), QUARTER)
    return [
        depth(a),
        mpmath.diff(depth, a),
        mpmath.diff(depth, a, 2),
        2 * (a * depth(a) - first),
        mpmath.mpf(4) / 3 * (a**3 * depth(a) - 3 * second),
    ]


def power(by, n, c):
    """The slope of a power cap as a function of rho and of the parameter."""
    value = {"radius": RADIUS, "exponent": n, "coefficient": c}

    def slope(rho, x):
        given = {**value, by: x}
        r, m, k = given["radius"], given["exponent"], given["coefficient"]
        return k * m * (rho / r) ** (m - 1)

    return slope, value[by]


def assert_rates(rates, slope, at, a, tolerance=1e-10):
    with mpmath.workdps(30):
        step = mpmath.mpf(10) ** -8
        up, down = (exact(lambda rho, s=s: slope(rho, at + s * step), mpmath.mpf(a)) for s in (1, -1))
        expected = [float((u - d) / (2 * step)) for u, d in zip(up, down, strict=True)]
    np.testing.assert_allclose([float(part[0]) for part in rates], expected, rtol=tolerance, atol=1e-14)


def test_power_caps():
    for by in ("radius", "exponent", "coefficient"):
        surface = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, mf.Material(1.0), cap=mf.Power(1.5, 0.3))
        rates = mf.Elastic().shape_rates(by, np.array([0.17]), surface)
        assert_rates(rates, *power(by, 1.5, 0.3), 0.17)


@pytest.mark.parametrize(
    ("contact", "slope"),
    [(mf.Hertz(), lambda rho, r: rho / r), (mf.Elastic(), lambda rho, r: rho / mpmath.sqrt(r**2 - rho**2))],
    ids=["paraboloid", "sphere"],
)
def test_spheres_and_paraboloids(contact, slope):
    surface = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, mf.Material(1.0))
    assert_rates(contact.shape_rates("radius", np.array([0.17]), surface), slope, mpmath.mpf(RADIUS), 0.17)


def test_at_given_load_the_indentation_changes_by_the_mean_of_the_change_of_d():
    for n in (1.2, 4.0):
        # dd/ds at given P is the mean of dD/ds over the contact radius: 1/(n + 1) of dD/dc for power caps
        surface = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, mf.Material(1.0), cap=mf.Power(n, 0.3))
        a = np.array([0.05])
        rates = mf.Elastic().shape_rates("coefficient", a, surface)
        np.testing.assert_allclose(
            rates.indentation - rates.load / (2.0 * a), rates.indentation / (n + 1.0), rtol=1e-13
        )


def test_caps_without_the_parameter_have_no_derivative():
    caps = [mf.Sphere(), mf.Power(3.0), mf.Paraboloid(), mf.Profile(lambda rho: rho**2, 0.5)]
    surface = mf.Surface.square_lattice(0.1, (2, 2), radius=RADIUS, material=mf.Material(1.0), cap=caps)
    a = np.full((3, 4), 0.1)
    for part in mf.Elastic().shape_rates("exponent", a, surface):
        assert part[:, 1].all()
        assert not part[:, [0, 2, 3]].any()
    for part in mf.Elastic().shape_rates("radius", a, surface):
        assert part[:, :3].all()
        assert not part[:, 3].any()
