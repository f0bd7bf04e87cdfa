"""Caps that differ from asperity to asperity, against the laws of their kinds."""

import numpy as np
import pytest

import metafem as mf
from metafem.models.interacting.influence import coupling_between

CAPS = (mf.Power(4.0), mf.Sphere(), mf.Power(1.5, 0.3), mf.Paraboloid())
LAWS = (mf.PowerCap(4.0), mf.SphericalCap(), mf.PowerCap(1.5, 0.3), mf.Hertz())
LOADS = np.array([0.005, 0.02, 0.06, 0.15])
INTERACTING = [
    mf.Interacting(1, contact=mf.Elastic()),
    mf.Interacting(3, contact=mf.Elastic()),
    mf.Interacting(3, substrate=mf.BondedLayer(), contact=mf.Elastic()),
]
EVERY = [mf.Independent(mf.Elastic()), mf.MeanField(mf.Elastic()), *INTERACTING]


def surface(count=9, cap=CAPS, seed=0):
    rng = np.random.default_rng(seed)
    height, radius = rng.uniform(0.08, 0.1, count), rng.uniform(0.3, 0.8, count)
    caps = [cap[i % len(cap)] for i in range(count)] if isinstance(cap, tuple) else cap
    shape = (round(count**0.5),) * 2
    block = mf.Block(20.0, 20.0, 7.2)
    return mf.Surface.square_lattice(
        height, shape, 1.5, radius=radius, material=mf.Material(1.0), block=block, cap=caps
    )


def own(values, size, method):
    """The values of a method of each cap's own law."""
    return np.array([getattr(LAWS[i % 4], method)(v, r) for i, (v, r) in enumerate(zip(values, size))])  # noqa: B905


@pytest.mark.parametrize("separation", [0.09, 0.06])
def test_independent_caps_have_the_loads_and_areas_of_their_own_laws(separation):
    part = surface()
    state = mf.equilibrium(part, mf.Independent(mf.Elastic()), separation=separation)
    radius = own(part.height - separation, part.radius, "contact_radius")
    np.testing.assert_allclose(state.asperity_area, np.pi * radius**2, rtol=1e-12)
    np.testing.assert_allclose(state.asperity_load, own(radius, part.radius, "load"), rtol=1e-12)


@pytest.mark.parametrize("load", [0.01, 0.1])
def test_order_1_satisfies_its_equations_with_the_laws_of_the_caps(load):
    part = surface()
    state = mf.equilibrium(part, INTERACTING[0], load=load)
    coupling, regular = coupling_between(part, mf.HalfSpace(), 1)
    closed = state.asperity_area > 0.0
    a = np.sqrt(state.asperity_area / np.pi)
    d = own(a, part.radius, "indentation")
    sunk = coupling.influence.T @ state.asperity_load + regular * state.asperity_load
    error = d + sunk - (part.height - state.separation)
    assert np.abs(error[closed]).max() <= 1e-12 * d.max()
    np.testing.assert_allclose(state.asperity_load, own(a, part.radius, "load"), rtol=1e-11, atol=1e-15)


@pytest.mark.parametrize("model", EVERY, ids=lambda model: model.name)
@pytest.mark.parametrize(("cap", "law"), list(zip(CAPS, LAWS, strict=True)), ids=repr)
def test_a_common_cap_has_the_law_of_its_kind(model, cap, law):
    part = surface(4, cap)
    found = mf.friction_law(part, model, load=LOADS).area
    plain = part.replaced(cap=mf.Sphere())
    np.testing.assert_array_equal(found, mf.friction_law(plain, with_law(model, law), load=LOADS).area)


def with_law(model, law):
    if isinstance(model, mf.Interacting):
        return mf.Interacting(model.order, model.substrate, law)
    return type(model)(law)


@pytest.mark.parametrize("model", EVERY, ids=lambda model: model.name)
def test_equal_caps_under_two_names_are_one_cap(model):
    same = surface(9, (mf.Paraboloid(), mf.Power(2.0, 0.5)))
    plain = mf.friction_law(surface(9, mf.Paraboloid()), model, load=LOADS)
    np.testing.assert_allclose(mf.friction_law(same, model, load=LOADS).area, plain.area, rtol=1e-11)


@pytest.mark.parametrize("model", EVERY, ids=lambda model: model.name)
def test_sensitivities_to_heights_are_derivatives_of_the_law(model):
    part, step = surface(), 1e-6
    found = model.sensitivity(part, LOADS).gradient
    for i in range(0, 9, 2):
        areas = [
            model.curve(part.replaced(height=part.height + sign * step * (np.arange(9) == i)), LOADS).area
            for sign in (1.0, -1.0)
        ]
        slope = (areas[0] - areas[1]) / (2.0 * step)
        np.testing.assert_allclose(found[:, i], slope, atol=3e-7 * np.abs(found).max())


@pytest.mark.slow
@pytest.mark.parametrize("height", [0.0, 0.01])
def test_order_3_agrees_with_resolved_contacts(height):
    rng = np.random.default_rng(1)
    cap = [CAPS[i % 4] for i in range(9)]
    part = mf.Surface.square_lattice(
        0.1 - height * rng.random(9), (3, 3), 1.2, radius=0.526, material=mf.Material(1.0), cap=cap
    )
    coarse, fine = (
        mf.friction_law(part, mf.BoundaryElements(cell, contact=mf.Elastic()), load=[0.05, 0.1])
        for cell in (0.01, 0.005)
    )
    law = mf.friction_law(part, INTERACTING[1], load=[0.05, 0.1])
    area = fine.area + (fine.area - coarse.area) / 3.0
    np.testing.assert_allclose(law.area, area, rtol=2e-3)


@pytest.mark.parametrize("coupled", [False, True])
def test_adhesive_caps_keep_their_own_laws(coupled):
    law = mf.JKR(9e-6, mf.Elastic())
    model = mf.Interacting(1, contact=law) if coupled else mf.Independent(law)
    part = surface(4)
    state = mf.equilibrium(part, model, load=0.03)
    a = np.sqrt(state.asperity_area / np.pi)
    loads = [
        float(mf.JKR(9e-6, LAWS[i]).for_material(part.material).load(a[i], part.radius[i]))
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
    with pytest.raises(
        mf.InvalidInput, match=r"cap = Power\(exponent=4\.0.*no finite curvature.*Elastic\(\)"
    ):
        mf.equilibrium(part.replaced(cap=[*caps[:3], mf.Power(4)]), load=0.1)


def test_a_law_of_other_caps_is_reported():
    part = mf.Surface.square_lattice(0.1, (2, 2), radius=0.5, material=mf.Material(1.0))
    notes = mf.friction_law(part, mf.Independent(mf.PowerCap(4)), load=[0.01]).notes
    assert any("does not describe the caps of the surface" in str(note) for note in notes)
    fitting = mf.friction_law(part.replaced(cap=mf.Power(4)), mf.Independent(mf.PowerCap(4)), load=[0.01])
    assert not any("does not describe" in str(note) for note in fitting.notes)


@pytest.mark.parametrize(
    ("cap", "words"),
    [
        ("sphere", r"cap = 'sphere' must be a cap such as metafem\.Sphere\(\)"),
        (mf.Power, "must be a cap"),
        ([mf.Sphere()], r"cap has 1 caps for 4 asperities"),
        ([mf.Sphere(), 2, mf.Sphere(), mf.Sphere()], r"cap\[1\] = 2 must be a cap"),
    ],
)
def test_wrong_caps_are_named(cap, words):
    with pytest.raises(mf.InvalidInput, match=words):
        mf.Surface.square_lattice(0.1, (2, 2), radius=0.5, material=mf.Material(1.0), cap=cap)


@pytest.mark.parametrize("exponent", [1.0, 0.5, 40.0])
def test_pointed_and_flat_exponents_are_refused(exponent):
    with pytest.raises(mf.InvalidInput, match="exponent"):
        mf.Power(exponent)


def test_hollow_profiles_are_refused():
    with pytest.raises(mf.InvalidInput, match=r"f = .* must begin with 0 and increase"):
        mf.Profile([[0.0, 0.1, 0.2], [0.0, 0.02, 0.01]])


def test_shuffled_asperities_keep_their_caps():
    part = surface()
    mixed = part.shuffled(3)
    pairs = {(float(h), repr(part.cap.one(i))) for i, h in enumerate(part.height)}
    assert pairs == {(float(h), repr(mixed.cap.one(i))) for i, h in enumerate(mixed.height)}
