"""Elastic-plastic laws: the published jumps, the blends that close them, and the elastic limit."""

from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem import reference as published

RADIUS = 0.526
MATERIALS = [mf.Material(1.36, nu) for nu in (0.0, 0.3, 0.5)]
LAWS = [mf.KogutEtsion(0.1), mf.JacksonGreen(0.03)]


def test_the_sizes_of_the_blends():
    """Those that the docstrings of the laws state."""

    def sizes(law, nu):
        return law.for_material(mf.Material(1.36, nu)).blends()[:, 2:]

    for nu in (0.0, 0.3, 0.5):
        found = sizes(mf.KogutEtsion(0.1), nu)
        assert_allclose([*found[0], *found[1], found[2][1]], [0.029, 0.075, 0.017, 0.015, 0.042], atol=5e-4)
    for softness, area in ((0.0015, 0.015), (0.03, 0.028)):
        assert_allclose(sizes(mf.JacksonGreen(softness * 1.36), 0.3)[0][1], area, atol=5e-4)


@pytest.mark.parametrize("law", LAWS, ids=repr)
def test_stiffness_and_area_slope_are_the_derivatives_and_continuous(law):
    bound = law.for_material(MATERIALS[2])
    d = np.geomspace(1e-8, 0.5, 2000) * RADIUS
    a = bound.contact_radius(d, RADIUS)
    assert_allclose(bound.indentation(a, RADIUS), d, rtol=1e-13)

    def derivative(function, step=1e-5):
        high, low = (function(bound.contact_radius(d * (1.0 + s), RADIUS)) for s in (step, -step))
        return (high - low) / (2.0 * step * d)

    # second order of the step, and the changes of curvature at the ends of the blends
    assert_allclose(derivative(lambda a: bound.load(a, RADIUS)), bound.stiffness(a, RADIUS), rtol=1e-6)
    assert_allclose(derivative(bound.area), bound.area_slope(a, RADIUS), rtol=1e-6)
    for edge in bound.breaks(RADIUS):
        sides = edge * (1.0 + 1e-9 * np.array([-1.0, 1.0]))
        for name in ("indentation", "load", "stiffness", "area_slope"):
            low, high = getattr(bound, name)(sides, RADIUS)
            assert low == pytest.approx(high, rel=1e-7)


def test_a_strong_material_is_elastic():
    for law in (mf.KogutEtsion(1e6), mf.JacksonGreen(1e6), mf.JacksonGreen(1e50)):
        bound, hertz = law.for_material(mf.Material(1.36)), mf.Hertz()
        d = np.geomspace(1e-9, 0.5, 50)
        a = hertz.contact_radius(d, RADIUS)
        assert_allclose(bound.contact_radius(d, RADIUS), a, rtol=1e-9)
        for name in ("load", "stiffness", "area_slope"):
            assert_allclose(getattr(bound, name)(a, RADIUS), getattr(hertz, name)(a, RADIUS), rtol=1e-9)


def test_outside_the_blends_the_laws_are_the_published_formulas():
    """The strength is 1 % of E*; at w* = 200 the contact of Kogut and Etsion is fully plastic, P = H A."""
    for nu in (0.0, 0.3, 0.5):
        factors = 0.454 + 0.41 * nu, 1.295 * np.exp(0.736 * nu)
        formulas = (
            partial(published.kogut_etsion, poisson_ratio=nu),
            partial(published.jackson_green, poisson_ratio=nu, strain=0.01),
        )
        for law, factor, formula in zip(
            (mf.KogutEtsion(0.0136), mf.JacksonGreen(0.0136)), factors, formulas, strict=True
        ):
            bound, start = law.for_material(mf.Material(1.36, nu)), (0.005 * np.pi * factor) ** 2
            for w in (1e-6, 0.5, 1.0, 4.0, 50.0, 200.0):
                a = bound.contact_radius(w * start * RADIUS, RADIUS)
                scaled = bound.load(a, RADIUS) / (4.0 / 3.0 * start**1.5), bound.area(a) / (np.pi * start)
                assert_allclose(np.divide(scaled, RADIUS**2), formula(w), rtol=1e-12)
            assert bound.contact_radius(-0.1, RADIUS) == 0.0
            assert bound.stiffness(0.0, RADIUS) == bound.area_slope(0.0, RADIUS) == 0.0


def test_a_law_belongs_to_its_first_material():
    law = mf.KogutEtsion(0.1)
    bound = law.for_material(MATERIALS[1])
    assert bound.for_material(MATERIALS[2]) is bound
    assert bound != law
    assert repr(bound) == repr(law) == "KogutEtsion(hardness=0.1)"
    names = str(law), str(mf.JacksonGreen(0.03))
    assert names == ("Kogut-Etsion, H = 0.1 MPa", "Jackson-Green, S_y = 0.03 MPa")


def test_the_notes_state_plastic_contacts_and_the_blends():
    law = mf.KogutEtsion(0.1).for_material(MATERIALS[1])
    d = law.yield_indentation(RADIUS) * np.array([-1.0, 0.9, 1.5, 7.0])
    assert law.notes(d[:2], RADIUS) == ()
    (note,) = law.notes(d, RADIUS)
    assert not note.warns
    for part in ("2 of 4", "7 w_c", "2.9 %", "7.5 %", "from 1 to 2", "from 4.8 to 7.5"):  # not 110 w_c
        assert part in note.text
    soft = mf.JacksonGreen(0.1).for_material(MATERIALS[1])
    assert soft.notes(0.5 * soft.yield_indentation(np.ones(2)), np.ones(2)) == ()
    _, warning = soft.notes(2.0 * soft.yield_indentation(np.ones(2)), np.ones(2))
    assert warning.warns
    assert "0.0735" in warning.text
