"""Answers equal the design of the command, and say what is wrong by key and by the nearest law."""

import builtins
import io
from dataclasses import replace

import numpy as np
import pytest

from metafem.explorer.answer import answered
from metafem.explorer.header import STOPPED, header_data
from metafem.explorer.history import State
from metafem.explorer.kinds import reachable, with_kind_near, with_nearest
from metafem.explorer.law_data import law_data
from metafem.explorer.table import with_field, with_only
from metafem.files import demo_text, of_table, parsed
from tests.explorer.scenes import SAMPLED, WANTED, changed

TEXT, LINEAR = demo_text("operating-points"), demo_text("linear")


def to(given, **how):
    """Return the answer to a text or a table."""
    return answered(State(given) if isinstance(given, str) else State("").edited(given), 1, **how)


def test_an_answer_is_the_design_of_the_command_once_for_each_text():
    answer = answered(State(TEXT), 3)
    assert (answer.number, answer.current, answer.refused) == (3, True, "")
    assert answer.design == parsed(TEXT).design()
    again = answered(State(TEXT, newtons=False, load=0.2), 4, answer)
    assert again.design is answer.design
    assert (again.number, again.state.load) == (4, 0.2)
    assert answered(State(TEXT + "\n"), 5, answer).design is not answer.design
    assert answered(State(SAMPLED, {"wanted.csv": WANTED}), 6).current
    header = header_data(answer)
    assert (header["status"], header["kind"], header["model"]) == ("exact", "good", "independent")
    assert header["title"] == answer.specification.target.title
    assert header_data(replace(answer, stopped=True))["status"] == STOPPED


def test_problems_have_their_keys_and_the_last_design_stays():
    before = to(TEXT)
    text = TEXT.replace('"270 um"', "270").replace('pitch = "1.5 mm"', 'pitch = "1.5 kg"')
    answer = answered(State(text), 2, before)
    assert set(answer.problems) == {"limits.max_height", "lattice.pitch"}
    assert (answer.specification, answer.current) == (None, False)
    assert answer.design is before.design
    assert answer.template is before.design.template
    header = header_data(answer)
    assert (header["status"], header["kind"]) == ("2 problems in the specification", "warn")
    assert header["meaning"] == answer.refused
    assert set(to("[target").problems) == {""}
    assert "model" not in header_data(to("[model"))
    assert header_data(replace(before, problems={"": "no"}, failed=True))["kind"] == "warn"
    surrogate = LINEAR.replace('"linear"', '"sampled"').replace("slope = 6.87", 'file = "a.csv"')
    assert list(answered(State(surrogate, {"a.csv": "load_N,\ud800"}), 1).problems) == ["target.file"]


def test_files_of_the_machine_are_not_read(tmp_path, monkeypatch):
    (tmp_path / "secret.csv").write_text(WANTED, "utf-8")
    monkeypatch.chdir(tmp_path)
    to(TEXT)  # imports and compiled functions are files too

    def refused(*given, **options):
        raise AssertionError(f"a file is opened: {given}")

    for section, kind, name in (("target", "sampled", "secret.csv"), ("cap", "profile", "/etc/passwd")):
        text = changed(TEXT, with_only, section, {"kind": kind, "file": name})
        with monkeypatch.context() as patched:
            patched.setattr(io, "open", refused)
            patched.setattr(builtins, "open", refused)
            assert "not loaded" in to(text).problems[f"{section}.file"]


def test_a_draft_is_simplified_where_it_would_be_slow_and_followed_by_the_design():
    for rows, model, drafted in (
        (8, "layer", "layer"),
        (8, "resolved", "half-space"),
        (12, "layer", "independent"),
    ):
        text = TEXT.replace('kind = "independent"', f'kind = "{model}"').replace(
            "[8, 8]", f"[{rows}, {rows}]"
        )
        draft = to(text.replace('pitch = "1.5 mm"', 'pitch = "1.2 mm"'), draft=True)
        assert (draft.current, draft.design.law.model.name) == (True, drafted)
        assert draft.simplified == (model != drafted)
        assert law_data(draft)["model"] == (f"{drafted}, draft" if draft.simplified else model)
        assert header_data(draft)["status"].startswith("draft under") == draft.simplified
    arranged = to(changed(TEXT, with_field, "layout.tilt", "0.1 deg"), draft=True)
    assert "tilt_after" not in arranged.design.parameters
    again = answered(State(TEXT), 2, to(TEXT, draft=True), draft=True)
    found = answered(State(TEXT), 3, again)
    assert (again.draft, found.draft) == (True, False)
    assert answered(State(TEXT), 4, found, draft=True).design is found.design


RANGE = {"load_range": ["0.1 mm^2", "0.4 mm^2"]}
REFUSED = {
    "forces": {"kind": "operating-points", "load": ["0.2 N", "0.4 N"], "friction_force": ["0.3 N", "1 N"]},
    "a sample": {"kind": "sampled", "rescaled_load": ["0.1 mm^2"], "rescaled_friction": ["0.1 mm^2"]},
    "a line": {"kind": "linear", "slope": 8.0, "load_range": ["0.1 mm^2", "0.6 mm^2"]},
    "far from its kind": {"kind": "multilinear", "slopes": [1.0], "crossover_loads": [], **RANGE},
}


# what would reach the forces is searched for two seconds
SLOW = pytest.param("forces", marks=pytest.mark.slow)


@pytest.mark.parametrize("name", [SLOW, *(name for name in REFUSED if name != "forces")])
def test_a_refused_law_has_a_nearest_one_which_can_be_taken(name):
    refused = to(changed(TEXT, with_only, "target", REFUSED[name]), before=to(TEXT))
    assert refused.refused == refused.refusal
    assert (" N (" if name == "forces" else " mm^2 (") in refused.refusal
    assert header_data(refused)["status"] == "refused: no surface reaches the target"
    found = with_nearest(refused)
    assert to(found).current
    if name == "far from its kind":  # samples serve
        return
    assert found["target"].keys() == REFUSED[name].keys()
    assert found["target"]["kind"] == REFUSED[name]["kind"]
    wanted = getattr(refused.nearest_target, "rescaled_friction", None)
    if wanted is not None:
        np.testing.assert_allclose(refused.nearest[1], wanted)
        assert of_table(found).target.rescaled_friction == pytest.approx(wanted, rel=1e-8)


@pytest.mark.parametrize("kind", ["sampled", "bilinear"])
def test_a_law_that_lower_limits_refuse_has_one_that_can_be_reached(kind):
    first = to(TEXT)
    table = with_field(with_kind_near(first.state, first.design, kind), "limits.max_height", "40 um")
    low = answered(first.state.edited(table), 2, first)
    assert low.refusal
    assert to(reachable(low)).current


def test_a_coefficient_over_loads_is_the_ratio_of_the_law():
    line = {"kind": "linear", "friction_coefficient": 1.7, "load_range": ["0.1 N", "0.9 N"]}
    refused = to(changed(TEXT, with_only, "target", line))
    assert law_data(refused)["offer"]
    used = to(with_nearest(refused))
    law, (low, high) = used.design.law, refused.nearest_target.load_range
    rows = (law.rescaled_load >= low) & (law.rescaled_load <= high)
    np.testing.assert_allclose(law.friction_force[rows] / law.load[rows], 1.7, rtol=0.01)
    assert law_data(used)["handles"][0]["carried"] == "μ = 1.7"
