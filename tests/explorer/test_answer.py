"""Answers equal the design of the command, and say what is wrong by key."""

import io

import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.files import demo_text, parsed

TEXT = demo_text("operating-points")


def test_an_answer_is_the_design_of_the_specification_to_the_bit():
    answer = answered(State(TEXT), 3)
    assert answer.number == 3
    assert answer.current
    assert answer.refused == ""
    assert answer.design == parsed(TEXT).design()


def test_another_look_at_the_same_specification_designs_nothing():
    before = answered(State(TEXT), 1)
    after = answered(State(TEXT, newtons=True, load=0.2), 2, before)
    assert after.design is before.design
    assert after.number == 2
    assert after.state.newtons
    assert answered(State(TEXT + "\n"), 3, before).design is not before.design


def test_problems_are_told_by_their_keys_and_the_last_design_stays():
    before = answered(State(TEXT), 1)
    text = TEXT.replace('"270 um"', "270").replace('pitch = "1.5 mm"', 'pitch = "1.5 kg"')
    answer = answered(State(text), 2, before)
    assert set(answer.problems) == {"limits.max_height", "lattice.pitch"}
    assert "needs a unit" in answer.problems["limits.max_height"]
    assert "kg" in answer.refused
    assert answer.specification is None
    assert answer.design is before.design
    assert not answer.current
    assert set(answered(State("[target"), 1).problems) == {""}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"4.12 mm^2"', '"40 mm^2"'),
        ('kind = "operating-points" ', 'kind = "sampled"'),
    ],
)
def test_a_target_out_of_reach_is_refused_with_the_nearest_law(old, new):
    text = TEXT.replace('"4.12 mm^2"', '"40 mm^2"').replace(old, new)
    answer = answered(State(text), 1)
    assert "mm^2" in answer.refusal
    assert answer.refused == answer.refusal
    assert not answer.problems
    load, friction = answer.nearest
    assert load[-1] == pytest.approx(0.649)
    assert friction[-1] < 40.0
    assert answer.nearest_target.curve().base == pytest.approx(friction)
    # the nearest law can be designed
    specification = answer.specification
    found = mf.design(answer.nearest_target, specification.template, limits=specification.limits)
    assert found.misfit < 0.1


def test_the_nearest_law_of_a_slope_is_that_of_its_design():
    answer = answered(
        State(demo_text("linear").replace("friction_coefficient = 1.5", "friction_coefficient = 9.0")), 1
    )
    if answer.refusal:
        assert answer.nearest is not None
        assert len(answer.nearest[0]) == 100


def test_a_table_is_read_from_the_state():
    lines = ["[target]", 'kind = "sampled"', 'file = "wanted.csv"']
    text = "\n".join(lines) + "\n" + TEXT[TEXT.index("[material]") :]
    table = "rescaled_load_mm2,rescaled_friction_mm2\n0.1,0.5\n0.2,1.0\n0.3,1.6\n"
    assert answered(State(text, {"wanted.csv": table}), 1).current
    assert "wanted.csv" in answered(State(text), 1).refused


def test_a_table_with_half_a_character_is_a_problem_of_its_key():
    text = demo_text("linear").replace('"linear"', '"sampled"').replace("slope = 6.87", 'file = "a.csv"')
    (problem,) = answered(State(text, {"a.csv": "load_N,\ud800"}), 1).problems.items()
    assert problem[0] == "target.file"
    assert "is not UTF-8" in problem[1]


def test_a_draft_is_followed_by_the_design_of_the_command():
    text = demo_text("linear").replace('kind = "independent"', 'kind = "layer"')
    draft = answered(State(text), 1, draft=True)
    assert draft.draft
    assert draft.current
    again = answered(State(text), 2, draft, draft=True)
    assert again.design is draft.design
    found = answered(State(text), 3, draft)
    assert not found.draft
    assert found.design == parsed(text).design()
    assert answered(State(text), 4, found, draft=True).design is found.design
    assert draft.design.misfit < 1.25 * found.design.misfit


@pytest.mark.parametrize("section", ["target", "contact"])
def test_files_of_the_machine_are_not_read(section, tmp_path, monkeypatch):
    table = tmp_path / "secret.csv"
    table.write_text("rescaled_load_mm2,rescaled_friction_mm2\n0.05,0.4\n0.1,0.7\n", "utf-8")
    monkeypatch.chdir(tmp_path)

    def refused(*given, **options):
        raise AssertionError(f"a file is opened: {given}")

    answered(State(TEXT), 0)  # imports and compiled functions are files too
    for name in (str(table), "secret.csv", f"../{tmp_path.name}/secret.csv", "/etc/passwd"):
        kind = "sampled" if section == "target" else "profile"
        text = Document(TEXT).with_kind(section, kind, {"file": name})
        with monkeypatch.context() as patched:
            patched.setattr(io, "open", refused)
            patched.setattr("builtins.open", refused)
            answer = answered(State(text), 1)
        assert answer.specification is None
        assert "names a table that is not given (given: none)" in answer.problems[f"{section}.file"]
