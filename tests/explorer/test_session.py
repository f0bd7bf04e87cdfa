"""States of a page and their history."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from metafem.errors import InvalidInput
from metafem.explorer.session import MOST_STATES, Session, State

FIRST = State("a = 1", {"wanted.csv": "load_N\n1\n"}, newtons=True, models=("layer",), load=0.2, pinned="{}")


def restored(session):
    """What the browser would hand back."""
    states = [state.to_json() for state in session.states]
    return Session.restored({"first": session.first, "at": session.first + session.at, "states": states})


def test_a_state_survives_the_browser():
    assert State.from_json(FIRST.to_json()) == FIRST


@pytest.mark.parametrize(
    "text",
    [
        "", "[", "[]", "{}", '{"text": 1}', '{"text": "", "other": 1}', '{"text": "", "tables": [1]}',
        '{"text": "", "load": NaN}', '{"text": "", "load": -1.0}', '{"text": "", "models": [1]}', "[" * 10**5,
        '{"text": "", "models": 3}', '{"text": "", "newtons": 1}', '{"text": "", "tables": {"a": 1}}',
        '{"text": "", "pinned": {}}',
    ],
)  # fmt: skip
def test_a_damaged_state_is_refused(text):
    with pytest.raises(InvalidInput, match="the state of the page is damaged"):
        State.from_json(text)


@given(st.lists(st.sampled_from(["undo", "redo", "a", "b", "c"]), max_size=30))
def test_the_history_is_that_of_an_editor(steps):
    session, done, undone = Session((FIRST,)), [FIRST], []
    for step in steps:
        if step == "undo":
            session = session.moved(-1)
            if len(done) > 1:
                undone.append(done.pop())
        elif step == "redo":
            session = session.moved(1)
            if undone:
                done.append(undone.pop())
        elif step != done[-1].text:
            session = session.after(replace(FIRST, text=step))
            done, undone = [*done, replace(FIRST, text=step)], []
        assert session.state == done[-1]
    assert restored(session).states == session.states
    assert restored(session).state == session.state


def test_the_pinned_state_stays_when_the_history_goes_back():
    pinned = replace(FIRST, text="b", pinned=FIRST.to_json())
    session = Session((FIRST,)).after(replace(FIRST, text="b")).after(pinned)
    assert session.states == (FIRST, pinned)  # no step of its own
    assert session.moved(-1).state == replace(FIRST, pinned=pinned.pinned)
    assert session.moved(-1).moved(1).state == pinned


def test_display_settings_are_no_step_of_the_history():
    session = Session((FIRST,)).after(replace(FIRST, text="b")).moved(-1)
    shown = replace(FIRST, newtons=False, load=0.3, models=())
    assert session.after(shown) == Session((shown, replace(FIRST, text="b")))
    assert len(session.after(replace(shown, measured="0.1,0.2")).states) == 2


def test_the_oldest_states_are_dropped():
    session = Session((FIRST,))
    for number in range(MOST_STATES + 5):
        session = session.after(replace(FIRST, text=str(number)))
    assert len(session.states) == MOST_STATES
    assert session.first == 6
    assert restored(session).state == session.state
    assert session.states[0].text == "5"


def test_a_page_without_a_history_begins_anew():
    assert Session.restored({"states": []}) is None
    assert Session.restored("") is None


@pytest.mark.parametrize(
    "record",
    [
        {"states": ["{}"], "first": 0, "at": 0}, {"states": [FIRST.to_json()], "first": 0, "at": 1},
        {"states": "a", "first": 0, "at": 0}, {"states": [FIRST.to_json()], "at": 0}, {"states": [None]},
    ],
)  # fmt: skip
def test_a_damaged_history_is_refused(record):
    with pytest.raises(InvalidInput, match="damaged"):
        Session.restored(json.loads(json.dumps(record)))
