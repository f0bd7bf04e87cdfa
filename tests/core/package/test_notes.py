"""Notes: a text, its level and its numbers."""

import metafem as mf
from metafem.notes import from_lines, information, to_lines


def test_a_note_is_its_text_warns_by_default_and_reads_back():
    assert (str(mf.Note("so")), mf.Note("so").warns, information("so").warns) == ("so", True, False)
    notes = (mf.Note("a: b"), information("c"))
    assert from_lines(to_lines(notes)) == notes
    assert from_lines("") == ()


def test_a_note_carries_its_numbers_and_those_it_has_not_are_left_out():
    surface = mf.Surface.square_lattice(0.1, (1, 2), radius=0.526, material=mf.Material(1.36))
    (note,) = mf.equilibrium(surface, separation=-0.01).notes
    assert f"from a load of {note.value:.4g} N on: at {note.bound:.4g} N" in note.text
    numbers = {"quantity": note.quantity, "value": note.value, "bound": note.bound}
    assert note.to_json() == {"level": "warning", "text": note.text, **numbers}
    assert information("c").to_json() == {"level": "information", "text": "c"}


def test_notes_with_one_text_are_equal_whatever_the_digits_of_their_numbers():
    one, other = (mf.Note("a/R = 0.70", quantity="a/R", value=value) for value in (0.7001, 0.7002))
    assert dict.fromkeys((one, other)) == {one: None}
