"""Values of a new part that collide, and the values that are offered in their place."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem.explorer.workshop.new_part import new_part
from metafem.explorer.workshop.part_fields import FIRST, Collision, told
from tests.core.explorer.test_files import POINTS, assert_made, target_of


@pytest.mark.parametrize(
    ("field", "typed", "count"),
    [
        ("coefficient", {"coefficient": "20"}, 1),
        ("coefficient", {"coefficient": "0.9"}, 1),
        ("coefficient", {"height": "120"}, 2),
        ("height", {"height": "600"}, 2),
        ("asperities", {"size": "5 5 2"}, 2),
        ("law", {"law": POINTS, "height": "100"}, 2),
        ("law", {"law": POINTS, "asperities": "3 3"}, 1),
    ],
)
def test_a_collision_names_the_field_and_offers_values_that_work(field, typed, count):
    with pytest.raises(Collision) as caught:
        new_part(FIRST | typed)
    assert caught.value.field == field
    assert len(caught.value.offers) == count
    for offer in caught.value.offers:
        assert told(offer).startswith("Use ")
        assert_made(new_part(FIRST | typed | offer))


def times(low, high):
    """Factors from low to high, evenly on a logarithmic scale."""
    return st.floats(0.0, 1.0).map(lambda part: f"{low * (high / low) ** part:.4g}")


TYPED = {
    "size": st.tuples(times(3.0, 60.0), times(3.0, 60.0), times(1.0, 10.0)).map(" × ".join),
    "asperities": st.sampled_from(["1 × 3", "2 × 2", "3 × 5", "1 × 64", "12 × 9"]),
    "coefficient": times(0.05, 30.0),
    "height": times(5.0, 2000.0),
    "radius": times(20.0, 5000.0),
    "modulus": times(0.01, 1000.0),
    "strength": times(0.01, 100.0),
    "law": st.sampled_from(["", POINTS, target_of("bilinear")]),
}


@settings(max_examples=8)
@given(st.fixed_dictionaries({}, optional=TYPED))
def test_any_values_make_a_part_or_are_offered_some_that_do(typed):
    offers = [{}]
    try:
        new_part(FIRST | typed)
    except Collision as error:
        offers = error.offers
    assert offers
    for offer in offers:
        assert_made(new_part(FIRST | typed | offer))
