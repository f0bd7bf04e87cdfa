"""The comparison of the design that is shown with the one that is pinned."""

from dataclasses import replace

import numpy as np
import pytest

from metafem.explorer.answer import answered, pinned_answer
from metafem.explorer.law.comparison import comparison
from metafem.explorer.session import State
from metafem.explorer.surface.surface_data import difference
from metafem.explorer.text.document import Document
from metafem.explorer.text.link import from_link, to_link
from metafem.files import demo_text

DEMO = State(demo_text("operating-points"))


def compared(**values):
    """The answer to a state with other values, with the demo as A."""
    changed = {key.replace("__", "."): value for key, value in values.items()}
    text = Document(DEMO.text).with_values(changed)
    return answered(State(text, pinned=DEMO.to_json()), 1)


def test_a_link_keeps_the_pinned_state():
    state = compared(limits__height_sd="2 um").state
    assert from_link(to_link(state)) == state


def test_a_design_that_is_compared_with_itself_differs_nowhere():
    answer = compared()
    rows = comparison(answer)
    assert [name for name, before, now in rows if before != now] == []
    assert {name: now for name, _, now in rows}["Largest load"] == "0.971 N"
    found = difference(answer.design, pinned_answer(answer.state.pinned).design)
    assert {each for each in found if each is not None} == {0.0}
    assert found.count(None) == 64 - answer.design.surface.count


def test_the_table_and_the_map_show_what_has_changed():
    answer = compared(limits__height_sd="1.8 um", limits__offset="10 um")
    rows = {name: (before, now) for name, before, now in comparison(answer)}
    before, now = (float(each.split()[0]) for each in rows["Scatter of the law of made surfaces"])
    assert now == pytest.approx(2.0 * before, abs=0.02)  # by linear response, with two digits
    before, now = (float(each.split()[0]) for each in rows["Volume of the caps"])
    assert now > before
    found = difference(answer.design, pinned_answer(answer.state.pinned).design)
    assert np.unique([each for each in found if each is not None]) == pytest.approx(10.0)


def test_surfaces_with_other_sites_have_no_difference_of_heights():
    answer = compared(lattice__pitch="1.6 mm")
    assert difference(answer.design, pinned_answer(answer.state.pinned).design) is None
    assert difference(answer.design, None) is None


@pytest.mark.parametrize("pinned", ["", "no state", State("[target]").to_json()])
def test_without_a_pinned_design_there_is_no_table(pinned):
    assert pinned_answer(pinned) is None
    assert comparison(replace(compared(), state=replace(DEMO, pinned=pinned))) == []
