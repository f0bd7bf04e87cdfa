"""Messages name fields as the page does."""

import re

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.answer import answered, specification_of
from metafem.explorer.session import State
from metafem.explorer.text.fields import with_field
from metafem.explorer.text.names import label_of, title_of
from metafem.explorer.workshop.form import form
from metafem.files import demo_text, section_forms

TEXTS = [demo_text(name) for name in ("operating-points", "linear", "bilinear")]

# A key of a specification, its index, or quotation marks and brackets of its notation.
CODE = re.compile(r"[a-z]{2,}_[a-z]|\b[a-z]+\.[a-z]|\[[a-z0-9]|for example (\"|'|\[)")

WRONG = ("", "-1", "12 12", ".8", "abc", "1e9 mm", "100 um", "0 mm", "5 N", "0.1, 0.2", "[", "300 um; 2 um")


def test_form_and_messages_use_the_same_names():
    for section in form():
        assert section["title"] == title_of(section["name"])
        for field in (field for keys in section["keys"].values() for field in keys):
            assert field["label"] == label_of(field["key"])


def offers_end(text, offers, most=2):
    """Return whether no offer is left after two steps: a value that is mended can need another one."""
    for key, value in offers.items():
        text = with_field(text, key, value)
    try:
        return bool(specification_of(State(text)))
    except InvalidInput:
        offers = answered(State(text), 1).offers
        return not offers or (most > 1 and offers_end(text, offers, most - 1))


@pytest.mark.parametrize("text", TEXTS)
def test_no_message_of_a_field_speaks_code(text):
    before = answered(State(text), 0)
    keys = [
        f"{form.name}.{key.name}"
        for form in section_forms()
        for key in form.keys.get("", ())
        if "." not in form.name
    ]
    told = offered = 0
    for key in keys:
        for typed in WRONG:
            wrong = with_field(text, key, typed)
            answer = answered(State(wrong), 1, before, draft=True)
            for words in (*answer.reasons.values(), answer.refused):
                assert not CODE.search(words), (key, typed, words)
                told += bool(words)
            offered += bool(answer.offers)
            assert not answer.offers or offers_end(wrong, answer.offers), (key, typed)
    assert told > 100
    assert offered > 20


@pytest.mark.parametrize(
    ("key", "typed", "words"),
    [
        ("limits.offset", "500 um", "“largest height” = 270 um and “offset” = 500 um together exceed"),
        ("part.alignment_height", "100 um", "; leave out “alignment height”: the part"),
        ("lattice.shape", "0 x 3", "Entry 1 = 0 must be a whole number of at least 1."),
        ("block.width", "3 mm", "the asperity at x = -5.25 mm, y = -5.25 mm has a cap"),
        ("limits.min_height", "12", "Needs a unit; write for example 10 um."),
        ("limits.min_height", "290 um", "Must be below “largest height” = 270 um."),
    ],
)
def test_problems_are_said_in_the_words_of_the_page(key, typed, words):
    answer = answered(State(with_field(TEXTS[0], key, typed)), 1)
    assert words in "".join(answer.reasons.values())
