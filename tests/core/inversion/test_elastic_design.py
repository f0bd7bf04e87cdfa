"""The list of decisions: an elastic law, another radius, another material, a plastic law."""

import math

import pytest

import metafem as mf

POINTS = mf.OperatingPoints([0.144, 0.336], [0.84, 1.68])
LIMITS = mf.Limits(0.27)


def index(design, hardness):
    surface = design.surface
    return 1.36 / hardness * math.sqrt(surface.height.std() / surface.radius.mean())


def test_hard_materials_keep_the_elastic_law(template):
    plain = mf.design(POINTS, template, limits=LIMITS)
    found = mf.design_for_hardness(POINTS, template, 10.0, limits=LIMITS)
    assert (found.surface.height == plain.surface.height).all()
    psi = found.parameters["plasticity_index"]
    assert psi == pytest.approx(index(plain, 10.0), rel=1e-12)
    assert found.parameters["largest_modulus_ratio"] == pytest.approx(0.6 / psi * 1.36 / 10.0, rel=1e-12)
    note = found.notes[0]
    assert not note.warns
    assert found.notes[1:] == plain.notes


def test_another_radius_is_taken_before_a_plastic_law(template):
    options = {"limits": LIMITS, "tools": [0.4, 1.2], "common_radius": True}
    plain = mf.design(mf.LinearLaw(6.87), template, **options)
    # the heights of the larger radius differ less
    hardness = index(plain, 0.64)
    found = mf.design_for_hardness(mf.LinearLaw(6.87), template, hardness, **options)
    assert plain.surface.radius[0] != found.surface.radius[0]
    assert not found.notes[0].warns
    assert found.parameters["plasticity_index"] == pytest.approx(index(found, hardness), rel=1e-12)
    assert found.parameters["plasticity_index"] < 0.6


def test_a_plastic_law_is_taken_where_nothing_stays_elastic(template):
    target = mf.SampledLaw([0.05, 0.1, 0.2], [0.6, 1.1, 1.9])
    plain = mf.design(target, template, limits=LIMITS)
    hardness = index(plain, 0.7)
    found = mf.design_for_hardness(target, template, hardness, limits=LIMITS)
    assert found.law.model == mf.Independent(mf.KogutEtsion(hardness))
    note = found.notes[0]
    assert note.warns
    largest = 0.6 / math.sqrt(plain.surface.height.std() / 0.526)
    assert f"below {largest:.3g} " in note.text
    assert found.misfit < 0.01
    coupled = mf.design_for_hardness(target, template, hardness, mf.Interacting(), limits=LIMITS)
    assert coupled.law.model == mf.Interacting(order=1, contact=mf.KogutEtsion(hardness))
