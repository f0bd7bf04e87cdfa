"""The specification of a new part from a few values."""

import tomllib

import pytest
import rtoml
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem.explorer.answer import answered
from metafem.explorer.certainty.figures import Standing, figures
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.workshop.new_part import new_part
from metafem.explorer.workshop.part_fields import FIRST, Collision, filled, told
from metafem.files import demo_text, parsed, planned


def target_of(demo):
    """The target of a demo, as the dialog keeps it."""
    return rtoml.dumps({"target": tomllib.loads(demo_text(demo))["target"]})


def made(text):
    """The design of a specification whose part can be made, with a base that stays clear."""
    found = answered(State(text), 1)
    assert found.problems == {}
    assert found.refusal == ""
    design = found.design
    assert (
        planned(design.surface, design.template, found.specification.part).surface.count
        == design.surface.count + 4
    )
    assert design.law.separation[-1] > 0.0
    return design


def refused(**typed):
    with pytest.raises(Collision) as caught:
        new_part(FIRST | typed)
    return caught.value


def test_the_first_values_make_a_part_that_fills_its_block():
    design = made(new_part(FIRST))
    assert design.surface.count == 64
    # the alignment caps are a pitch outside the corners: 0.398 mm high, the radius of their base is 0.51 mm
    assert design.template.position.max() + 2.1 + 0.51 == pytest.approx(10.0, abs=0.04)
    assert design.law.friction_coefficient[50] == pytest.approx(1.5, rel=0.01)


@pytest.mark.parametrize("law", ["operating-points", "linear", "bilinear"])
def test_a_law_that_is_kept_stays_as_it_is(law):
    text = new_part(FIRST | {"law": target_of(law), "asperities": "9 × 9"})
    assert Document(text).value("target") == tomllib.loads(demo_text(law))["target"]
    assert made(text).template.count == 81


@pytest.mark.parametrize(
    "typed", ["30,5x30,5x7,2", "30,5 × 30,5 × 7,2 mm", "30.5; 30.5; 7.2", "3,05 cm, 3,05 cm, 7,2"]
)
def test_decimal_commas_are_read_as_in_the_other_fields(typed):
    block = Document(new_part(FIRST | {"size": typed})).section("block")
    assert list(block.values()) == ["30.5 mm", "30.5 mm", "7.2 mm"]


def test_a_comma_that_may_separate_thousands_is_refused():
    assert refused(radius="1,526").field == "radius"


@pytest.mark.parametrize("typed", ["6x8", "6 × 8", "6 8", "6, 8", "6 X 8", " 6 * 8 "])
def test_rows_and_columns_are_read_however_they_are_separated(typed):
    assert Document(new_part(FIRST | {"asperities": typed})).value("lattice.shape") == [6, 8]


def test_a_number_has_the_unit_of_its_field_or_its_own():
    plain = new_part(FIRST)
    assert (
        new_part(FIRST | {"radius": "0,526 mm", "modulus": "1360 kPa", "size": "2 cm x 20 mm x 7,2"}) == plain
    )
    assert new_part(FIRST | {"height": "270 um", "ratio": ".85"}) == plain


@pytest.mark.parametrize(
    ("field", "typed"),
    [
        ("size", "20 × 20"), ("size", "20 × 20 × 7 N"), ("asperities", "8"), ("asperities", "1 × 1"),
        ("asperities", "2.5 × 8"), ("asperities", "1000 × 1000"), ("radius", ""), ("radius", "-5"),
        ("radius", "5 N"), ("modulus", "soft"), ("ratio", "0"), ("coefficient", "1.5 N"), ("height", "1e999"),
    ],
)  # fmt: skip
def test_what_is_no_value_is_named_with_one_that_works(field, typed):
    error = refused(**{field: typed})
    assert error.field == field
    made(new_part(FIRST | {field: typed} | error.offers[0]))


@pytest.mark.parametrize(
    ("typed", "field", "offers"),
    [
        ({"coefficient": "20"}, "coefficient", ["Use friction coefficient μ 3.13"]),
        ({"coefficient": "0.9"}, "coefficient", ["Use friction coefficient μ 1.33"]),
        (
            {"height": "120"}, "coefficient",
            ["Use friction coefficient μ 2", "Use largest height of the summits 212 µm"],
        ),
        (
            {"height": "600"}, "height",
            ["Use largest height of the summits 499 µm", "Use radius of curvature 632 µm"],
        ),
        ({"size": "5 5 2"}, "asperities", ["Use asperities 3 × 3", "Use block 9.3 × 9.3 × 2 mm"]),
        (
            {"law": target_of("operating-points"), "height": "100"}, "law",
            ["Use largest height of the summits 165 µm", "Use friction coefficient μ 2.19"],
        ),
        ({"law": target_of("operating-points"), "asperities": "3 3"}, "law", ["Use a friction coefficient"]),
    ],
)  # fmt: skip
def test_a_collision_names_the_field_and_offers_values_that_work(typed, field, offers):
    error = refused(**typed)
    assert error.field == field
    assert [told(offer) for offer in error.offers] == offers
    for offer in error.offers:
        made(new_part(FIRST | typed | offer))


def test_the_fields_are_those_of_the_part_that_is_shown():
    typed = {**FIRST, "size": "30.5 × 20 × 6", "asperities": "9 × 6", "height": "200", "error": "1.5"}
    text = new_part(typed | {"coefficient": "2"})
    assert filled(parsed(text)) == {**typed, "coefficient": "2"}
    assert Document(text).value("limits.height_sd") == "1.5 um"
    assert filled(parsed(demo_text("linear"))).keys() == FIRST.keys()


def test_a_value_for_each_asperity_is_left_to_the_first_one():
    coated = Document(new_part(FIRST | {"asperities": "2 × 2"}))
    strengths = ["0.3 MPa", "0.4 MPa", "0.3 MPa", "0.4 MPa"]
    text = coated.with_values({"friction.shear_strength": strengths})
    assert filled(parsed(text))["strength"] == FIRST["strength"]


def test_the_offset_is_raised_until_the_base_stays_clear():
    text = new_part(FIRST | {"coefficient": "2", "height": "120"})
    assert Document(text).value("limits.offset") == "4 um"
    found = answered(State(text), 1)
    base = next(each for each in figures(found) if each.name.startswith("load at which the plane touches"))
    assert base.standing is Standing.GOOD
    lower = Document(text).with_values({"limits.offset": "3 um"})
    assert parsed(lower).design().law.separation[-1] < 0.0


def times(low, high):
    """Factors from low to high, evenly on a logarithmic scale."""
    return st.floats(0.0, 1.0).map(lambda part: low * (high / low) ** part)


@settings(max_examples=8)
@given(
    typed=st.fixed_dictionaries(
        {},
        optional={
            "size": st.tuples(times(3.0, 60.0), times(3.0, 60.0), times(1.0, 10.0)),
            "asperities": st.sampled_from([(1, 3), (2, 2), (3, 5), (1, 64), (12, 9)]),
            "coefficient": times(0.05, 30.0),
            "height": times(5.0, 2000.0),
            "radius": times(20.0, 5000.0),
            "modulus": times(0.01, 1000.0),
            "strength": times(0.01, 100.0),
        },
    ),
    law=st.sampled_from(["", "", "operating-points", "bilinear"]),
)
def test_any_values_make_a_part_or_are_offered_some_that_do(typed, law):
    texts = {
        name: " × ".join(f"{each:.4g}" for each in (value if isinstance(value, tuple) else (value,)))
        for name, value in typed.items()
    }
    whole = FIRST | texts | {"law": law and target_of(law)}
    offers = [{}]
    try:
        new_part(whole)
    except Collision as error:
        offers = error.offers
    assert offers
    for offer in offers:
        made(new_part(whole | offer))
