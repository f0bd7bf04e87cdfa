"""Fields of a specification, and what a person types into them."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.explorer.text.document import Document
from metafem.explorer.text.fields import shown, typed_value, with_field
from metafem.files import demo_text, parsed, section_forms

LINEAR = demo_text("linear")
MULTILINEAR = Document(LINEAR).with_kind("target", "multilinear")
ADHESIVE = Document(LINEAR).with_kind("contact", "jkr")
TEXTS = [demo_text("operating-points"), MULTILINEAR, ADHESIVE]


def keys_of(text):
    """Return the dotted keys that a specification of these kinds can have, with their forms."""
    found = []
    for form in section_forms():
        kind = Document(text).value(f"{form.name}.kind") if form.kinds else ""
        found += [
            (f"{form.name}.{key.name}", key) for key in form.keys.get(kind, ()) if key.value != "section"
        ]
    return found


def problems(text):
    try:
        parsed(text)
    except mf.InvalidInput as error:
        return {problem.key.partition("[")[0]: str(problem) for problem in error.problems}
    return {}


@pytest.mark.parametrize("text", TEXTS)
def test_setting_what_is_shown_changes_nothing(text):
    for key, _ in keys_of(text):
        assert with_field(text, key, shown(Document(text).value(key))) == text


@pytest.mark.parametrize("text", TEXTS)
def test_every_key_takes_its_example(text):
    for key, form in keys_of(text):
        new = with_field(text, key, shown(form.example))
        assert Document(new).value(key) == form.example == typed_value(form, shown(form.example))


@pytest.mark.parametrize(
    ("key", "typed", "words"),
    [
        ("limits.min_height", "12", 'limits.min_height = "12" needs a unit; write for example "10 um"'),
        ("limits.max_height", "120 kg", 'has the unit "kg", which does not measure in mm'),
        ("limits.max_height", "", 'is missing; write for example max_height = "120 um"'),
        ("lattice.pitch", "1,500 mm", "write decimals with a point"),  # or one and a half thousand
        ("lattice.shape", "8", "write for example shape = [8, 8]"),
        ("lattice.shape", "8 x y", "must be a whole number"),
        ("lattice.shape", "six x 8", "'six'"),
        ("material.poisson_ratio", "half", "must be a number"),
        ("material.poisson_ratio", "0.5\nx = 1", "must be a number"),
        ("material.poisson_ratio", "0.7", "0.5"),
        ("layout.follow_law", "maybe", "must be true or false"),
        ("layout.seed", "-1", "must be at least 0"),
        ("model.kind", "rigid", "is unknown"),
        ("target.load_range", "0.1 N", "load_range"),
        ("part.formats", "stl, dwg", "dwg"),
    ],
)
def test_what_is_wrong_is_said_by_the_parser_at_the_key(key, typed, words):
    found = problems(with_field(LINEAR, key, typed))
    assert list(found) == [key]
    assert words in found[key]


@pytest.mark.parametrize(
    ("text", "key", "typed", "value"),
    [
        (LINEAR, "lattice.shape", "7 x 8", [7, 8]),
        (LINEAR, "lattice.shape", "7x8", [7, 8]),
        (LINEAR, "lattice.shape", "[8, 6]", [8, 6]),
        (LINEAR, "target.slope", "7", 7),
        (LINEAR, "target.slope", "7.", 7.0),
        (LINEAR, "material.poisson_ratio", " .45 ", 0.45),
        (LINEAR, "layout.follow_law", "true", True),
        (LINEAR, "target.load_range", "0.1 N, 0.4 N", ["0.1 N", "0.4 N"]),
        (LINEAR, "target.load_range", '"0.1 N"; "0.4 N"', ["0.1 N", "0.4 N"]),
        (LINEAR, "part.formats", "stl, 3mf", ["stl", "3mf"]),
        (LINEAR, "target.load_range", "", None),
        (MULTILINEAR, "target.slopes", "9, 8.5, 7", [9, 8.5, 7]),
        (
            MULTILINEAR,
            "target.crossover_loads",
            "[0.07 mm^2, 0.1 mm^2], 0.15 mm^2",
            [["0.07 mm^2", "0.1 mm^2"], "0.15 mm^2"],
        ),
        (ADHESIVE, "contact.cap.kind", "power", "power"),
    ],
)
def test_what_is_typed_becomes_a_value(text, key, typed, value):
    new = with_field(text, key, typed)
    assert Document(new).value(key) == value
    assert not problems(new)


def test_another_choice_of_keys_replaces_the_first():
    new = with_field(LINEAR, "material.young_modulus", "1 MPa")
    assert "composite_modulus" not in tomllib.loads(new)["material"]
    assert not problems(new)


def test_a_key_that_the_kind_does_not_have_is_refused():
    with pytest.raises(mf.InvalidInput, match="no key"):
        with_field(LINEAR, "contact.cap.exponent", "3")
    with pytest.raises(mf.InvalidInput, match="no key"):
        with_field(LINEAR, "limits.depth", "3 um")


@pytest.mark.parametrize("examples", [8, pytest.param(40, marks=pytest.mark.slow)])
def test_whatever_is_typed_is_kept_or_named(examples):
    drawn = given(st.sampled_from(TEXTS), st.data(), st.text(max_size=12))
    settings(max_examples=examples)(drawn(assert_kept_or_named))()


def assert_kept_or_named(text, data, typed):
    every = [key for key, _ in keys_of(text)] + ["target.kind", "contact.kind"]
    key = data.draw(st.sampled_from(every))
    try:
        new = with_field(text, key, typed)
    except mf.InvalidInput as error:
        assert str(error)  # noqa: PT017 - such as a character that TOML does not have
        return
    for found in problems(new):
        assert found.split(".")[0] == key.split(".")[0] or found == ""


@pytest.mark.parametrize(
    ("key", "typed", "value"),
    [
        ("lattice.pitch", "1,5 mm", "1.5 mm"),
        ("lattice.pitch", "0,525 mm", "0.525 mm"),
        ("lattice.radius", ",5 mm", ",5 mm"),
        ("material.poisson_ratio", "0,45", 0.45),
        ("lattice.shape", "12 12", [12, 12]),
        ("lattice.shape", "8 x 12", [8, 12]),
        ("target.crossover_loads", "0,05 mm^2; 0,2 mm^2", ["0.05 mm^2", "0.2 mm^2"]),
        ("target.crossover_loads", "0.05 mm^2,0.2 mm^2", ["0.05 mm^2", "0.2 mm^2"]),
    ],
)
def test_decimal_commas_and_spaces_between_whole_numbers_are_read(key, typed, value):
    assert Document(with_field(MULTILINEAR, key, typed)).value(key) == value


@pytest.mark.parametrize(
    ("key", "typed", "value"),
    [
        ("limits.max_height", "130", "130 um"),
        ("limits.max_height", "0,13 mm", "0.13 mm"),
        ("limits.max_height", "130,5", "130.5 um"),
        ("limits.max_height", ".5", "0.5 um"),
        ("limits.max_height", "1,300", "1,300"),  # or one thousand three hundred
        ("limits.max_height", "13x", "13x"),
        ("material.composite_modulus", "1,4", "1.4 MPa"),
        ("target.load_range", "0.1, 0.4", ["0.1 mm^2", "0.4 mm^2"]),
        ("target.load_range", "0,1; 0,4 mm^2", ["0.1 mm^2", "0.4 mm^2"]),
        ("target.load_range", "0,1, 0,4", ["0.1 mm^2", "0.4 mm^2"]),
        ("target.load_range", "0,1 N, 0,4 N", ["0.1 N", "0.4 N"]),
        ("target.crossover_loads", "[0.07, 0.1], 0,15", [["0.07 mm^2", "0.1 mm^2"], "0.15 mm^2"]),
        ("friction.shear_strength", "0.3, 0.35", ["0.3 MPa", "0.35 MPa"]),
        ("limits.min_height", "12", "12"),  # which had no unit before
    ],
)
def test_a_number_without_a_unit_has_the_unit_of_the_value_before(key, typed, value):
    assert Document(with_field(MULTILINEAR, key, typed)).value(key) == value


def test_units_that_differ_are_not_assumed():
    text = with_field(MULTILINEAR, "target.load_range", "0.1 N, 0.4 mm^2")
    assert Document(with_field(text, "target.load_range", "0.1, 0.4")).value("target.load_range") == [
        "0.1",
        "0.4",
    ]
