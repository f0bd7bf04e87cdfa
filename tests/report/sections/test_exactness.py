"""The report's section on how exact the part must be."""

from pathlib import Path

import pytest

import metafem as mf
from metafem import cli
from metafem.report.sections.exactness import QUESTIONS, SOURCE, exactness_section


@pytest.fixture
def studies(template):
    design = mf.design(mf.LinearLaw(6.87), template)
    return {"misalignment": mf.studies.misalignment(design.surface, [0.0005, 0.001], shuffles=3)}


def test_answers_have_a_sentence_a_figure_and_a_table(studies):
    section = exactness_section(studies)
    assert [each["question"] for each in section["answers"]] == [QUESTIONS[name].text for name in studies]
    for answer in section["answers"]:
        assert answer["answer"].endswith(".")
        assert answer["figure"].svg.startswith("<svg")
        assert {len(row) for row in answer["rows"]} == {len(answer["columns"])}


def test_missing_studies_name_their_commands(demo_results):
    folder, _ = demo_results("linear")
    text = (folder / "linear/report.html").read_text("utf-8")
    assert all(f"<code>{question.command}</code>" in text for question in QUESTIONS.values())
    section = exactness_section({})
    assert section["missing"] == [(each.text, each.command) for each in QUESTIONS.values()]
    assert (section["answers"], section["fitted"]) == ([], "")


@pytest.mark.parametrize("name", QUESTIONS)
def test_the_commands_are_complete(name):
    program, group, study, *options = QUESTIONS[name].command.split()
    assert (program, group, study) == ("metafem", "study", name)
    command = cli.main.commands["study"].commands[name]
    assert command.make_context(name, options).params["folder"] == Path("DIR")


def test_the_range_of_the_slopes_is_stated(studies):
    study = studies["misalignment"].assign_attrs(load_range=[0.05, 0.2])
    fitted = exactness_section({"misalignment": study})["fitted"]
    assert fitted == f"Slopes are fitted over the rescaled loads P/E* = 0.05 to 0.2 mm². {SOURCE}"


def test_comparisons_of_models_have_no_range_of_slopes(template):
    study = mf.studies.interaction(mf.design(mf.LinearLaw(6.87), template), placements=2)
    assert exactness_section({"interaction": study})["fitted"] == ""
