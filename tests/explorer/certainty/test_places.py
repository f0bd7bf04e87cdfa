"""Warnings at the places of the page to which they belong."""

from dataclasses import replace

from metafem.explorer.answer import answered
from metafem.explorer.certainty.places import warnings_by_place
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.notes import Note
from metafem.prediction.validity import WIDTH

TEXT = demo_text("operating-points")


def test_a_part_that_can_be_made_has_no_problem():
    answer = answered(State(TEXT), 1)
    assert answer.no_part == ""
    assert answer.part is answer.part  # planned once
    assert "take" not in warnings_by_place(answer)


def test_a_summit_at_the_base_plane_is_told_at_the_surface_and_at_the_files():
    answer = answered(State(TEXT), 1)
    height = answer.design.surface.height.copy()
    height[7] = 0.0
    answer = replace(
        answer, design=replace(answer.design, surface=answer.design.surface.replaced(height=height))
    )
    words = answer.no_part
    assert words.startswith("no part can be made: the asperity at x = 5.25 mm, y = -5.25 mm has")
    assert "has the height 0 mm; a cap of radius 0.526 mm needs a height above 0" in words
    places = warnings_by_place(answer)
    assert words in places["surface"]
    assert places["take"] == [words]


def test_an_earlier_surface_has_no_warnings_of_the_present_specification():
    warned = answered(State(TEXT.replace('height_sd = "0.9 um"', 'height_sd = "9 um"')), 1)
    assert warnings_by_place(warned)
    refused = answered(State(TEXT.replace('"1.68 mm^2"', '"3.9 mm^2"')), 2, warned)
    assert refused.refusal
    assert refused.design is warned.design
    assert warnings_by_place(refused) == {}


def test_a_note_is_told_where_its_remedies_are_and_not_by_its_words():
    answer = answered(State(TEXT), 1)
    notes = (
        Note("the caps of the summits", remedies=("load_range",)),
        Note("no word of a part", remedies=("pitch", "model")),
        Note("no remedy"),
        Note("the figure has it", quantity=WIDTH, remedies=("radius",)),
    )
    before = warnings_by_place(answer)
    noted = replace(answer, design=replace(answer.design, notes=notes))
    places = warnings_by_place(noted)
    new = {
        name: [text for text in texts if text not in before.get(name, [])] for name, texts in places.items()
    }
    assert new["law"] == ["the caps of the summits", "no remedy"]
    assert new["target.load_range"] == ["the caps of the summits"]
    assert new["surface"] == new["lattice.pitch"] == new["model.kind"] == ["no word of a part"]
    assert "lattice.radius" not in new
