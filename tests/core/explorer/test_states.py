"""States of a page: their history, links, and files that are loaded."""

import re
from dataclasses import replace

import pytest

from metafem.errors import InvalidInput
from metafem.explorer import history as module
from metafem.explorer.editor import loaded, table_names, texts_of
from metafem.explorer.history import MOST_STATES, Session, State, from_link, to_link
from metafem.explorer.start import first_state
from metafem.files import demo_text, read_spec, save
from tests.explorer.scenes import SAMPLED, WANTED, files

FIRST = State("a = 1", {"wanted.csv": "load_N\n1\n"}, "1,2\n", "m.csv", False, 0.2)


def named(text):
    return replace(FIRST, text=text)


def test_the_history_is_that_of_an_editor():
    session = Session((FIRST,)).after(named("b")).after(named("c"))
    texts = []
    for steps in (-1, -1, -1, 1):
        session = session.moved(steps)
        texts.append(session.state.text)
    assert texts == ["b", "a = 1", "a = 1", "b"]
    session = session.after(named("d"))
    assert [each.text for each in session.states] == ["a = 1", "b", "d"]
    assert session.moved(1) == session
    for number in range(MOST_STATES):
        session = session.after(named(str(number)))
    assert (len(session.states), session.states[0].text) == (MOST_STATES, "0")


def test_display_settings_are_no_step():
    session = Session((FIRST,)).after(named("b")).moved(-1)
    shown = replace(FIRST, newtons=True, load=0.3)
    assert session.after(shown) == Session((shown, named("b")))
    assert len(session.after(replace(shown, measured="0.1,0.2")).states) == 2


def test_a_state_comes_back_from_its_link_and_damaged_ones_are_refused(monkeypatch):
    for state in (FIRST, State(""), State("µ\ud800\n" * 99, newtons=True), State(demo_text("bilinear"))):
        link = to_link(state)
        assert re.fullmatch(r"[A-Za-z0-9_.-]+", link)
        assert from_link(f"#{link}") == state
    assert len(link) < 0.75 * len(state.text)
    refused = 0
    for i in range(len(link)):
        for wrong in (link[:i], f"{link[:i]}A{link[i + 1 :]}", f"{link[:i]}\u00e9{link[i + 1 :]}"):
            try:
                assert from_link(wrong) == state
            except InvalidInput:
                refused += 1
    assert refused > 2.9 * len(link)
    monkeypatch.setattr(module, "LARGEST", 1000)
    assert to_link(State("a" * 2000)) == ""


def test_a_page_begins_with_a_demo_a_specification_or_a_result(tmp_path):
    assert first_state(None) == State(demo_text("operating-points"))
    (tmp_path / "mine.toml").write_text(SAMPLED)
    (tmp_path / "wanted.csv").write_text(WANTED)
    state = first_state(tmp_path / "mine.toml")
    assert state == State(SAMPLED, {"wanted.csv": WANTED})
    specification = read_spec(tmp_path / "mine.toml")
    save(specification.design(), tmp_path / "made", specification=specification)
    assert first_state(tmp_path / "made") == state
    (tmp_path / "bad.toml").write_text("[target]\n")
    with pytest.raises(InvalidInput, match=r"bad\.toml"):
        first_state(tmp_path / "bad.toml")


def test_files_that_are_loaded_replace_the_text_and_the_named_tables():
    text = SAMPLED.replace("wanted.csv", "laws/wanted.csv")
    found = loaded(FIRST, files(spec_toml=text, wanted_csv=WANTED, x_csv="1\n"))
    assert found == replace(FIRST, text=text, tables={"laws/wanted.csv": WANTED})
    again = loaded(found, files(wanted_csv=WANTED * 2))
    assert again == replace(found, tables={"laws/wanted.csv": WANTED * 2})
    assert loaded(FIRST, files(other_toml="[a]", spec_toml=text)).text == text
    broken = "[limits]\nmax_height = \n"
    assert loaded(FIRST, files(mine_toml=broken)).text == broken  # to be repaired
    cap = '[cap]\nkind = "profile"\nfile = "cap.csv"'
    assert table_names(State(text + cap)) == ["laws/wanted.csv", "cap.csv"]
    assert table_names(State("[target")) == table_names(State("target = 3\n[contact]\nfile = 4")) == []


def test_tables_of_spreadsheets_are_read_in_their_encodings():
    text = "load_N;height_µm\r\n1;2\r\n"
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "cp1252"):
        assert texts_of({"Maße.CSV": text.encode(encoding)}) == {"Maße.CSV": text}
    assert "\N{REPLACEMENT CHARACTER}" in texts_of({"spec.toml": b"\xff"})["spec.toml"]
