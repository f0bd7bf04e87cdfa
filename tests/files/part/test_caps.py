import numpy as np
import pytest

import metafem as mf
from metafem.files import PartOptions, planned
from metafem.files.part.caps import alignment_positions, with_alignment
from metafem.files.units import quantity

MATERIAL = mf.Material(1.36)


def surface(height=0.1, shape=(2, 3), pitch=1.5, block=(8.0, 7.0, 3.0)):
    return mf.Surface.square_lattice(
        height, shape, pitch, radius=0.526, material=MATERIAL, block=mf.Block(*block) if block else None
    )


def test_alignment_stands_one_pitch_outside_the_corners():
    places = alignment_positions(surface(shape=(2, 3)))
    assert {tuple(place) for place in places} == {(x, y) for x in (-3.0, 3.0) for y in (-2.25, 2.25)}


def test_alignment_asperities_are_the_tallest():
    with pytest.raises(mf.InvalidInput, match="must exceed the tallest summit"):
        with_alignment(surface(0.2), surface(), 0.2)


@pytest.mark.parametrize("height", [0.1, 0.2, 0.527, 3.0])
def test_an_impossible_height_of_the_alignment_is_refused_with_a_possible_one(height):
    with pytest.raises(mf.InvalidInput) as refused:
        with_alignment(surface(0.2), surface(), height)
    assert with_alignment(surface(0.2), surface(), quantity("height", refused.value.example[1:-1], "mm"))
    lowest = surface(0.526)  # no height is above these summits
    with pytest.raises(mf.InvalidInput) as refused:
        with_alignment(lowest, lowest, height)
    assert refused.value.example == ""


def test_one_site_has_no_pitch():
    with pytest.raises(mf.InvalidInput, match="at least two sites"):
        alignment_positions(surface(shape=(1, 1)))


def test_the_holes_of_the_alignment_are_made_by_the_smallest_tool_that_is_large_enough():
    part = surface(0.1).replaced(radius=np.array([0.3, 0.526, 0.8, 0.8, 0.3, 0.526]))
    for top, tool in ((0.25, 0.3), (0.4, 0.526), (0.6, 0.8)):
        assert with_alignment(part, surface(), top).radius[-4:].tolist() == [tool] * 4
    with pytest.raises(mf.InvalidInput, match=r"part\.alignment_height = 0\.9 mm exceeds the largest radius"):
        with_alignment(part, surface(), 0.9)


@pytest.mark.parametrize(("part", "alignment", "message"), [
    (surface([0.1, 0.1, 0.0, 0.1, 0.1, 0.1]), None, r"asperity 2 at \(1.5, -0.75\) mm has the height 0 mm"),
    (surface([0.1, 0.1, 0.1, -0.1, 0.1, 0.1]), None, "asperity 3 .* height -0.1 mm"),
    (surface([0.1, 0.6, 0.1, 0.1, 0.1, 0.1]), None, "asperity 1 .* height 0.6 mm"),
    (surface(pitch=0.6), None, "asperity 0 .* and asperity 1 .* overlap"),
    (surface(pitch=4.0), None, "asperity 0 .* leaves the block"),
    (surface(block=(6.8, 7, 3)), 0.4, "alignment asperity 0 .* leaves the block"),
])  # fmt: skip
def test_what_cannot_be_made_is_refused_by_asperity(part, alignment, message):
    with pytest.raises(mf.InvalidInput, match=message):
        planned(part, part, PartOptions(alignment))


TABLE = mf.Profile([[0.0, 0.1, 0.2, 0.3], [0.0, 0.01, 0.04, 0.09]])


@pytest.mark.parametrize(("part", "cap", "alignment", "message"), [
    (surface(0.1), TABLE, None, r"asperity 0 .* height 0\.1 mm; .* at most 0\.09 mm, where its profile ends"),
    (surface(0.05), TABLE, 0.1, r"part\.alignment_height = 0\.1 mm exceeds 0\.09 mm, where the profile"),
    (surface(0.08, pitch=0.5), TABLE, None, "asperity 0 .* and asperity 1 .* overlap"),
    (surface(pitch=0.8), mf.Power(4), None, r"overlap: their caps have base radii of 0\.413"),
])  # fmt: skip
def test_caps_of_other_profiles_are_refused_by_their_own_feet(part, cap, alignment, message):
    with pytest.raises(mf.InvalidInput, match=message):
        planned(part.replaced(cap=cap), part, PartOptions(alignment))


def test_caps_of_other_profiles_may_be_higher_than_their_radius():
    part = surface(0.6)
    blunt = part.replaced(cap=mf.Power(4, 2.0))
    assert planned(blunt, blunt, PartOptions(chord_error=1e-3)).asperities == 6
