"""Designs whose heights take the places that suit interaction, or a tilt."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.candidate import Candidate
from metafem.inversion.placement.layout import LAW_LOADS, TILT_LOADS, aims_of, arranged
from metafem.inversion.problem import Problem
from metafem.inversion.search.target_law import TargetLaw

LAYER = mf.Interacting(substrate=mf.BondedLayer())
POWER, LIMITS = mf.PowerLaw(1.2, (0.1, 0.4)), mf.Limits(0.27)
TILT = math.radians(0.1)
LOAD = np.linspace(0.1, 0.4, 8)


def rms(surface, model, wanted):
    return math.sqrt(((model.curve(surface, LOAD).area / wanted - 1.0) ** 2).mean())


def tilting(surface, model, load=LOAD):
    return float(np.linalg.norm(mf.InsensitiveToTilt(load, TILT).residual(surface, model)))


def test_sites_are_those_of_the_places(template):
    target = mf.OperatingPoints([0.144, 0.336], [0.84, 1.68])
    placed = mf.design(target, template, limits=LIMITS, layout=mf.Layout(tilt=TILT), rng=4)
    np.testing.assert_array_equal(template.position[placed.sites], placed.surface.position)
    dealt = mf.design(target, template, limits=LIMITS, rng=4)
    np.testing.assert_array_equal(np.sort(placed.surface.height), np.sort(dealt.surface.height))
    assert placed.misfit == pytest.approx(dealt.misfit, abs=1e-12)


def test_slow_models_are_arranged_under_the_interacting_one(rough):
    law = TargetLaw.fixed(LOAD, mf.Independent().curve(rough, LOAD).area)
    model = mf.BoundaryElements(0.01, substrate=mf.BondedLayer())
    problem = Problem.checked(POWER, rough, model, LIMITS, mf.Layout())
    given = Candidate(rough.height, rough.radius, {}, law, sites=np.arange(rough.count))
    found = arranged(problem, given, np.random.default_rng(0))
    assert "under the model layer" in found.notes[0].text
    after = rms(found.surface(rough), LAYER, law.base)
    assert after == pytest.approx(found.parameters["layout_after"], rel=1e-9)


def test_many_loads_are_thinned_between_their_ends(rough):
    load = np.linspace(0.01, 0.5, 61)
    law = TargetLaw.fixed(load, mf.Independent().curve(rough, load).area)
    aims = aims_of(mf.Layout(tilt=TILT), rough, LAYER, law)
    for (_, part, _), most in zip(aims, (LAW_LOADS, TILT_LOADS), strict=True):
        assert len(part.rescaled_load) == most
        assert part.rescaled_load[[0, -1]].tolist() == load[[0, -1]].tolist()


def test_a_target_law_that_falls_gives_way_to_that_of_independent_asperities(rough):
    law = TargetLaw.fixed(LOAD, np.linspace(2.0, 1.0, len(LOAD)))
    aims = aims_of(mf.Layout(), rough, LAYER, law)
    np.testing.assert_array_equal(aims[0][1].rescaled_friction, mf.Independent().curve(rough, LOAD).area)
