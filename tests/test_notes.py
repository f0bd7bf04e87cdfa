"""Notes: a text and its level."""

import metafem as mf
from metafem.notes import from_lines, information, to_lines


def test_a_note_is_its_text_and_warns_by_default():
    assert (str(mf.Note("so")), mf.Note("so").warns, information("so").warns) == ("so", True, False)


def test_notes_read_back_from_lines():
    notes = (mf.Note("a: b"), information("c"))
    assert from_lines(to_lines(notes)) == notes
    assert from_lines("") == ()
