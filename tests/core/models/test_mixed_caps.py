"""Caps that differ from asperity to asperity, against the laws of their kinds."""

from dataclasses import replace

import numpy as np

import metafem as mf
from tests.core.models.test_sensitivity import LOADS, scene

CAPS = (mf.Power(4.0), mf.Sphere(), mf.Power(1.5, 0.3), mf.Paraboloid())
LAWS = (mf.Elastic(mf.Power(4.0)), mf.Elastic(mf.Sphere()), mf.Elastic(mf.Power(1.5, 0.3)), mf.Hertz())
INTERACTING = [
    mf.Interacting(1, contact=mf.Elastic()),
    mf.Interacting(3, contact=mf.Elastic()),
    mf.Interacting(3, substrate=mf.BondedLayer(), contact=mf.Elastic()),
]
EVERY = [mf.Independent(mf.Elastic()), *INTERACTING]


def own(values, size, method):
    """The values of a method of each cap's own law."""
    return np.array([getattr(LAWS[i % 4], method)(v, r) for i, (v, r) in enumerate(zip(values, size))])  # noqa: B905


def test_independent_caps_have_the_loads_and_areas_of_their_own_laws():
    for separation in (0.09, 0.06):
        part = scene(CAPS)
        state = mf.equilibrium(part, mf.Independent(mf.Elastic()), separation=separation)
        radius = own(part.height - separation, part.radius, "contact_radius")
        np.testing.assert_allclose(state.asperity_area, np.pi * radius**2, rtol=1e-12)
        np.testing.assert_allclose(state.asperity_load, 1.36 * own(radius, part.radius, "load"), rtol=1e-12)


def test_a_common_cap_has_the_law_of_its_kind():
    for cap, law in zip(CAPS, LAWS, strict=True):
        part = scene(cap, 4)
        plain = part.replaced(cap=mf.Sphere())
        for model in EVERY:
            found, expected = (
                mf.friction_law(*pair, load=LOADS).area
                for pair in ((part, model), (plain, replace(model, contact=law)))
            )
            np.testing.assert_array_equal(found, expected)


def test_equal_caps_under_two_names_are_one_cap():
    for model in EVERY:
        same = scene((mf.Paraboloid(), mf.Power(2.0, 0.5)))
        plain = mf.friction_law(scene(mf.Paraboloid()), model, load=LOADS)
        np.testing.assert_allclose(mf.friction_law(same, model, load=LOADS).area, plain.area, rtol=1e-11)


def test_adhesive_caps_keep_their_own_laws():
    for coupled in (False, True):
        law = mf.JKR(9e-6, mf.Elastic())
        model = mf.Interacting(1, contact=law) if coupled else mf.Independent(law)
        part = scene(CAPS, 4)
        state = mf.equilibrium(part, model, load=0.03)
        a = np.sqrt(state.asperity_area / np.pi)
        loads = [
            1.36 * float(mf.JKR(9e-6, LAWS[i]).for_material(part.material).load(a[i], part.radius[i]))
            if a[i] > 0.0
            else 0.0
            for i in range(4)
        ]
        np.testing.assert_allclose(state.asperity_load, loads, rtol=1e-11, atol=1e-16)
        assert state.residual < 1e-9


def test_hertz_takes_every_cap_by_the_curvature_of_its_summit():
    caps = [mf.Sphere(), mf.Paraboloid(), mf.Power(2.0, 0.25), mf.Profile(lambda r: r**2 / 0.6, 0.3)]
    part = mf.Surface.square_lattice(0.1, (2, 2), radius=0.5, material=mf.Material(1.0), cap=caps)
    state = mf.equilibrium(part, approach=0.004)
    np.testing.assert_allclose(state.asperity_area, np.pi * 0.004 * np.array([0.5, 0.5, 1.0, 0.3]), rtol=1e-9)
