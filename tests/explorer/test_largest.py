"""The largest slope of a line without a range of loads."""

import pytest

from metafem.explorer.answer import answered, specification_of
from metafem.explorer.largest import largest_line
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.files import demo_text
from metafem.models import Independent

TEXT = demo_text("operating-points")


def largest(kind, **values):
    text = Document(TEXT).with_kind("target", kind, values)
    return largest_line(specification_of(State(text)), Independent())


def test_the_largest_slope_is_about_the_same_from_any_slope_above_it():
    slopes = [largest("linear", slope=slope)[0].slope for slope in (18.0, 40.0, 400.0)]
    assert slopes == pytest.approx([slopes[0]] * 3, rel=0.03)
    text = Document(TEXT).with_kind("target", "linear", {"slope": 1.1 * max(slopes)})
    assert answered(State(text), 1).design.misfit > 0.1


def test_other_targets_have_none():
    assert largest("linear", slope=1.0) is None  # below the smallest slope
    assert largest("linear", slope=7.0, load_range=["0.1 mm^2", "0.4 mm^2"]) is None
    assert largest("bilinear", slopes=[5.0, 9.0], crossover_load="0.1 mm^2") is None
