"""Models and contact laws of the options of a command."""

import pytest

import metafem as mf
from metafem.cli.group import CONTACTS as COMMAND_CONTACTS
from metafem.files.specification.options import chosen_model, contact_named, contacts, form


def test_laws_of_the_command_are_those_of_the_files():
    assert tuple(form(kind) for kind in contacts()) == COMMAND_CONTACTS


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", r'contact law "" is unknown \(known: hertz, sphere, power'),
        ("powr 4", r'contact law "powr" is unknown; did you mean power\?'),
        ("sphere 3", r'"sphere": 3 is not one of its values \(sphere\)'),
        ("power", r'"power": exponent is missing; .* \(power EXPONENT \[COEFFICIENT\]\)'),
        ("power four", "\"power four\": exponent = 'four' must be a number"),
        ("power 4 -1", '"power 4 -1": coefficient = -1 must be greater than 0'),
        ("profile", r'"profile": needs either rho and f or file \(profile FILE\)'),
        ("profile none.csv", "none.csv: no such file"),
    ],
)
def test_errors_in_words_name_the_value_and_the_form(text, words):
    with pytest.raises(mf.InvalidInput, match=words):
        contact_named(text)


def test_options_replace_the_model_and_the_law_each_alone():
    folder = mf.Independent(contact=mf.SphericalCap())
    assert chosen_model(folder, None, None) is folder
    assert chosen_model(folder, None, "hertz") == mf.Independent()
    assert chosen_model(folder, "independent", None) == folder
    assert chosen_model(mf.MeanField(), "independent", "power 3") == mf.Independent(contact=mf.PowerCap(3))
