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
TARGETS = (
    mf.OperatingPoints([0.1, 0.2, 0.4], [0.8, 1.5, 2.9]),
    mf.LinearLaw(6.87),
    mf.BilinearLaw((7.15, 12.52), 0.038),
    mf.SampledLaw([0.05, 0.1, 0.2], [0.4, 0.8, 1.7]),
    mf.PowerLaw(1.1, (0.05, 0.2)),
    mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26)),
)


@pytest.fixture
def result(template):
    return mf.design(TARGETS[0], template, limits=LIMITS)


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: type(target).__name__)
def test_a_loaded_design_equals_the_saved_one(target, template, tmp_path):
    design = mf.design(target, template, limits=LIMITS)
    mf.save(design, tmp_path / "result")
    again = mf.load(tmp_path / "result")
    assert again == design
    assert hash(again) == hash(design)
    assert again is not design


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
    assert law != mf.friction_law(rough, mf.MeanField(), load=[0.1, 0.2])
    state, other = (mf.equilibrium(rough, load=p) for p in (0.1, 0.2))
    assert state == mf.equilibrium(rough, load=0.1)
    assert state != other
    assert mf.FollowLaw([0.1]) == mf.FollowLaw([0.1]) != mf.FollowLaw([0.2])
    assert len({law, again}) == 1


def test_a_design_prints_in_ten_lines(result):
    lines = repr(result).splitlines()
    assert len(lines) == 10
    text = repr(result)
    for part in (
        "law through 3 operating points",
        "exact",
        "largest difference from the target",
        "41 on 64 sites; one more asperity in contact would exceed the target",
        "0.526 mm",
        "Independent()",
    ):
        assert part in text


def test_a_design_states_the_number_of_notes_and_warnings(result):
    noted = (mf.Note("too close"), mf.Note("too wide"))
    assert "notes       2 warnings" in repr(replace(result, notes=noted))


def test_long_arrays_are_not_printed(rough):
    law = mf.friction_law(rough)
    state = mf.equilibrium(rough, load=0.1)
    sampled = mf.SampledLaw(law.rescaled_load, law.area)
    for value in (rough, law, state, sampled):
        assert len(repr(value)) < 300
        assert "\n" not in repr(value)
    assert "<100 numbers, " in repr(sampled)


@pytest.mark.slow
def test_a_million_asperities_or_loads_print_their_ends(rough):
    """Their notes would take seconds to estimate; the picture holds no mark for each."""
    lattice = mf.Surface.square_lattice(0.1, (1000, 1000), radius=0.526, material=mf.Material(1.36))
    heights = 0.1 + 0.02 * np.random.default_rng(0).random(lattice.count)
    surface = lattice.replaced(height=heights)
    state = mf.equilibrium(surface, load=100.0)
    law = mf.friction_law(rough, load=np.linspace(1e-3, 0.5, 10**6))
    for value in (surface, state, law):
        assert "1,000,000 " in repr(value)
        assert len(repr(value)) < 300
        assert len(value._repr_html_()) < 40_000
    assert callable(state.__dict__["_notes"])
    assert callable(law.__dict__["_notes"])


def test_notes_of_large_results_are_counted_once_they_are_read():
    surface = mf.Surface.square_lattice(0.1, (34, 34), radius=0.526, material=mf.Material(1.36))
    state, law = mf.equilibrium(surface, load=1.0), mf.friction_law(surface, load=[1.0])
    for value in (state, law):
        assert "notes not estimated yet" in repr(value)
        value.notes  # noqa: B018 - estimated when it is read
        assert repr(value).endswith(f", {counted(value.notes)}>")


def test_parameters_and_sites_of_a_design_are_read_only(result):
    with pytest.raises(TypeError, match="does not support item assignment"):
        result.parameters["levels"] = 0.0
    for array in (result.sites, result.parameters["levels"], result.parameters["counts"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
def test_copies_of_a_design_are_equal_and_read_only(copied, result):
    again = copied(result)
    assert again == result
    assert not again.sites.flags.writeable
    assert not again.parameters["levels"].flags.writeable


@pytest.mark.parametrize(
    ("fraction", "form", "text"),
    [
        (0.0123, ".2g", "1.2 %"),
        (0.999, ".2g", "100 %"),
        (1.234, ".2g", "123 %"),
        (12.0, "+.2g", "+1200 %"),
        (1e-12, ".2g", "1e-10 %"),
    ],
)
def test_percent_has_no_positive_exponent(fraction, form, text):
    assert percent(fraction, form) == text
