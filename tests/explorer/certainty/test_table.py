"""The figures and the notes as HTML."""

from metafem.explorer.certainty.figures import Standing
from metafem.explorer.certainty.table import figure_table, note_list
from metafem.notes import Note, information

ROW = {
    "name": "a < b",
    "value": "2 %",
    "bound": "at most 1 %",
    "standing": Standing.WARNING,
    "sentence": "It is 2 %.",
}


def test_a_figure_has_its_state_in_words_and_its_texts_are_no_markup():
    found = figure_table({"words": "", "rows": [ROW], "band": "± 1 SD"})
    assert found.count("<tr data-standing=") == 1
    assert '<span class="chip warn"><span aria-hidden="true">▲</span>warning</span>' in found
    assert "a &lt; b" in found
    assert "It is 2\u00a0%." in found
    assert "Band of the law: ± 1 SD." in found


def test_notes_are_counted_by_their_kind():
    notes = [Note("a"), information("b <"), information("c")]
    count, texts = note_list(notes)
    assert count == "1 warning, 2 notes on the design"
    assert '<p class="note"><strong>Note:</strong> b &lt;</p>' in texts
    assert note_list(notes[:1])[0] == "1 warning on the design"
    assert note_list([])[1] == ""
