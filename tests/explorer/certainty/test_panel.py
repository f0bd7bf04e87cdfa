"""Data of the panel."""

import json
import re
from dataclasses import replace
from html import unescape

from metafem.explorer.answer import Answer, answered
from metafem.explorer.certainty.figures import Standing, figures
from metafem.explorer.certainty.long_studies import STUDIES, Found
from metafem.explorer.certainty.panel import (
    NO_DESIGN,
    NOT_CURRENT,
    at_once,
    figure_data,
    found_data,
    study_data,
)
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.notes import Note

STATE = State(demo_text("operating-points"))


def test_rows_are_the_figures_and_what_needs_attention_stands_first():
    answer = answered(STATE, 1)
    data = json.loads(json.dumps(figure_data(answer)))
    assert {row["name"] for row in data["rows"]} == {each.name for each in figures(answer)}
    order = [list(Standing).index(Standing(row["standing"])) for row in data["rows"]]
    assert data["rows"][0]["standing"] == "remark"
    assert order[1:] == [0] * (len(order) - 1)
    texts = re.findall(r"</strong> (.*?)</p>", data["notes"][1])
    assert [unescape(text) for text in texts] == [str(note) for note in answer.design.notes]
    assert data["words"] == ""
    assert at_once(answer)


def test_figures_of_an_earlier_surface_are_marked_and_no_study_of_it_starts():
    answer = replace(answered(STATE, 1), problems={"limits.max_height": "is missing"})
    assert figure_data(answer)["words"] == NOT_CURRENT
    assert all(study_data(answer)["hindered"].values())
    assert figure_data(Answer(1, STATE))["words"] == NO_DESIGN
    assert not at_once(Answer(1, STATE))


def test_a_study_belongs_to_the_specification_and_its_tables():
    answer = answered(STATE, 1)
    shown = study_data(answer)
    assert set(shown["hindered"]) == set(STUDIES)
    assert not any(shown["hindered"].values())
    found = found_data(Found("title", ("a",), (("1",),), (Note("n"),), "Good."), shown["shown"])
    assert found["of"] == study_data(replace(answer, state=replace(STATE, newtons=True)))["shown"]
    assert found["notes"] == [{"level": "warning", "text": "n"}]
    others = (replace(STATE, text=STATE.text + "\n"), replace(STATE, tables={"law.csv": "1,2\n"}))
    assert len({study_data(replace(answer, state=state))["shown"] for state in (STATE, *others)}) == 3
