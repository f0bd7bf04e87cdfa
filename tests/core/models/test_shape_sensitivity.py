"""Sensitivities of A0 to heights, radii, exponents and coefficients against extrapolated differences."""

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest

import metafem as mf
from metafem.models.interacting import elastic as interacting
from tests.models.scenes import LAWS, said, with_law

MIXED = (
    mf.Power(4.0),
    mf.Sphere(),
    mf.Power(1.5, 0.3),
    mf.Paraboloid(),
    mf.Power(2.0),
    mf.Profile(lambda rho: rho**2 / 1.1 + rho**4, 0.6),
)
LOADS = np.array([0.005, 0.02, 0.06, 0.15])
OWN, COATED = mf.Elastic(), mf.Friction(np.linspace(0.2, 0.4, 9), 0.8)
PARAMETERS = ["height", "radius", "exponent", "coefficient"]
MODELS = [
    mf.Independent(OWN),
    mf.Interacting(1, contact=OWN),
    mf.Interacting(3, mf.BondedLayer(), OWN),
]


def scene(cap, count=9, pitch=1.5, **given):
    rng = np.random.default_rng(4)
    caps = [cap[i % len(cap)] for i in range(count)] if isinstance(cap, tuple) else cap
    side = round(count**0.5)
    height, radius = rng.uniform(0.08, 0.1, count), rng.uniform(0.3, 0.8, count)
    block = mf.Block(20.0, 20.0, 3.0)
    return mf.Surface.square_lattice(
        height, (side, side), pitch, radius=radius, material=mf.Material(1.36), block=block, cap=caps, **given
    )


def changed(surface, by, i, share):
    """The surface with a parameter of asperity i changed by a share of its size, and the size."""
    if by == "height":
        height = surface.height.copy()
        height[i] += 1e-4 * share
        return surface.replaced(height=height), 1e-4
    if by == "radius":
        radius = surface.radius.copy()
        radius[i] *= 1.0 + share
        return surface.replaced(radius=radius), surface.radius[i]
    caps = [surface.cap.one(k) for k in range(surface.count)]
    if by not in caps[i].parameters:
        return surface, 1.0
    size = getattr(caps[i], by)
    caps[i] = replace(caps[i], **{by: size * (1.0 + share)})
    return surface.replaced(cap=caps), size


def difference(surface, model, by, i, load, step=2e-3):
    """The derivative by central differences of three steps, extrapolated to order 6."""
    slopes = []
    for share in (step, step / 2.0, step / 4.0):
        (up, size), (down, _) = (changed(surface, by, i, sign * share) for sign in (1.0, -1.0))
        slopes.append(
            (model.curve(up, load).rescaled_friction - model.curve(down, load).area) / (2.0 * share * size),
        )
    first, second = ((4.0 * fine - coarse) / 3.0 for coarse, fine in pairwise(slopes))
    return (16.0 * second - first) / 15.0


def assert_derivatives(surface, model, by, load=LOADS, some=None, tolerance=1e-7, step=2e-3):
    found = model.sensitivity(surface, load, by=by)
    np.testing.assert_allclose(found.curve.area, model.curve(surface, load).area, rtol=1e-9)
    scale = np.abs(found.gradient).max(axis=1)
    assert (scale > 0.0).all()
    for i in range(surface.count) if some is None else some:
        error = np.abs(found.gradient[:, i] - difference(surface, model, by, i, load, step))
        assert (error <= tolerance * scale).all(), (i, error / scale)


def test_coated_asperities_have_the_derivatives_of_their_friction():
    for by, model in product(PARAMETERS, MODELS):
        assert_derivatives(scene(MIXED, friction=COATED), model, by)


def test_every_model_has_the_derivatives_of_its_law():
    for cap in (mf.Power(4.0), mf.Power(1.5, 0.3), mf.Power(2.0), mf.Sphere()):
        surface = scene(cap)
        for by in ("height", *surface.cap.parameters):
            for model in (MODELS[0], mf.Interacting(3, contact=OWN)):
                assert_derivatives(surface, model, by, some=(0, 4))


def test_pedestals_of_spheres_change_with_the_radius():
    for order, contact, by in ((1, OWN, "radius"), (3, mf.Hertz(), "height"), (3, mf.Hertz(), "radius")):
        model = mf.Interacting(order, mf.BondedLayer(), contact, pedestal=True)
        assert_derivatives(scene(mf.Sphere(), friction=COATED), model, by, some=(0, 4))


def test_adhesive_contacts_have_the_derivatives_of_their_friction():
    jkr = LAWS["jkr"](1.0, 1.0)
    coupled = mf.Interacting(1, contact=jkr), mf.Interacting(3, mf.BondedLayer(), jkr, pedestal=True)
    for model in (*with_law("jkr"), *coupled):
        assert_derivatives(scene(mf.Sphere(), friction=COATED), model, "height", some=(0, 4))


def test_hertz_depends_on_the_curvature_of_the_summits():
    caps = (mf.Power(2.0, 0.3), mf.Sphere(), mf.Paraboloid(), mf.Profile(lambda rho: rho**2 / 1.1, 0.6))
    for model, by in product(
        (mf.Independent(), mf.Interacting(1), mf.Interacting(3)), ("height", "radius", "coefficient")
    ):
        assert_derivatives(scene(caps), model, by, some=range(4))


def test_laws_of_the_model_have_derivatives_by_heights_and_radii():
    for name, by in product(("quartic", "sphere", "kogut-etsion", "jackson-green"), ("height", "radius")):
        law = LAWS[name](1.0, 1.0)
        # elastic-plastic laws consist of cubics with jumps of the second derivative
        step = 2e-3 if law.largest_order == 3 or by == "height" else 2e-5
        for model in with_law(name):
            assert_derivatives(scene(mf.Sphere(), friction=COATED), model, by, some=(0, 4), step=step)


def test_laws_that_do_not_use_the_radius_do_not_depend_on_it():
    for model in (*with_law("profile"), *with_law("tabulated")):
        assert not model.sensitivity(scene(mf.Sphere()), LOADS, by="radius").gradient.any()


def test_a_power_law_of_the_model_has_the_derivatives_of_power_caps():
    for by in ("exponent", "coefficient"):
        caps, plain = scene(mf.Power(3.0, 0.4)), scene(mf.Sphere())
        for own, law in (
            (mf.Independent(OWN), mf.Independent(mf.PowerCap(3.0, 0.4))),
            (mf.Interacting(3, contact=OWN), mf.Interacting(3, contact=mf.PowerCap(3.0, 0.4))),
        ):
            found, wanted = law.sensitivity(plain, LOADS, by=by), own.sensitivity(caps, LOADS, by=by)
            np.testing.assert_array_equal(found.gradient, wanted.gradient)


def test_a_periodic_cell_has_the_derivatives_of_its_law():
    surface = scene(MIXED, cell=mf.PeriodicCell(4.5, 4.5))
    for by in ("height", "radius"):
        assert_derivatives(surface, mf.Interacting(3, contact=OWN), by, some=range(0, 9, 2))


@pytest.mark.parametrize(("order", "by"), [(1, "radius"), (3, "exponent")])
def test_fast_sums_have_the_derivatives_of_dense_matrices(order, by, monkeypatch):
    friction = mf.Friction(np.linspace(0.2, 0.4, 49))
    surface, model = scene(MIXED, 49, friction=friction), mf.Interacting(order, mf.BondedLayer(), OWN)
    dense = model.sensitivity(surface, LOADS[1:], by=by).gradient
    monkeypatch.setattr(interacting, "LATTICE_LIMIT", 10)
    monkeypatch.setattr(interacting, "DENSE_LIMIT", 10)
    found = model.sensitivity(surface, LOADS[1:], by=by)
    assert "fast sums" in said(found.curve.last) or "lattice" in said(found.curve.last)
    np.testing.assert_allclose(found.gradient, dense, rtol=0.0, atol=3e-8 * np.abs(dense).max())
