"""Equality, hashes and reprs of what metafem returns."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem._values import percent
from metafem.notes import counted

LIMITS = mf.Limits(0.16, offset=0.084)


@pytest.fixture
def result(template):
    return mf.design(mf.OperatingPoints([0.1, 0.2, 0.4], [0.8, 1.5, 2.9]), template, limits=LIMITS)


def test_equality_compares_every_bit(rough):
    same = rough.replaced()
    assert same == rough
    assert hash(same) == hash(rough)
    height = rough.height.copy()
    height[3] = np.nextafter(height[3], 1.0)
    assert rough.replaced(height=height) != rough
    assert rough.replaced(block=None) != rough
    assert rough != "a surface"


def test_equal_laws_and_states(rough):
    law, again = (mf.friction_law(rough, load=[0.1, 0.2]) for _ in range(2))
    assert law == again
    assert law != mf.friction_law(rough, mf.Interacting(), load=[0.1, 0.2])
    state, other = (mf.equilibrium(rough, load=p) for p in (0.1, 0.2))
    assert state == mf.equilibrium(rough, load=0.1)
    assert state != other
    assert len({law, again}) == 1


def test_a_design_counts_its_warnings(result):
    noted = replace(result, notes=(mf.Note("too close"), mf.Note("too wide")))
    assert "notes       2 warnings" in repr(noted)


def test_notes_of_large_results_are_counted_once_they_are_read():
    surface = mf.Surface.square_lattice(0.1, (34, 34), radius=0.526, material=mf.Material(1.36))
    state, law = mf.equilibrium(surface, load=1.0), mf.friction_law(surface, load=[1.0])
    for value in (state, law):
        assert "notes not estimated yet" in repr(value)
        said = counted(value.notes)
        assert repr(value).endswith(f", {said}>")


def test_a_design_and_its_copies_are_equal_and_read_only(result):
    for again in (copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        assert again == result
        assert not again.sites.flags.writeable
        assert not again.parameters["levels"].flags.writeable
    with pytest.raises(TypeError, match="does not support item assignment"):
        result.parameters["levels"] = 0.0
    for array in (result.sites, result.parameters["levels"], result.parameters["counts"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_percent_has_no_positive_exponent():
    numbers = [(0.0123, ".2g"), (0.999, ".2g"), (1.234, ".2g"), (12.0, "+.2g"), (1e-12, ".2g")]
    found = [percent(fraction, form) for fraction, form in numbers]
    assert found == ["1.2 %", "100 %", "123 %", "+1200 %", "1e-10 %"]
