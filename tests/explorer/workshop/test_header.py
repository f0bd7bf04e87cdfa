"""The head of the page names the target and says whether it is met."""

from dataclasses import replace

from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.workshop.header import STOPPED, header_data
from metafem.files import demo_text

TEXT = demo_text("linear")


def test_the_status_of_a_design_has_its_misfit():
    answer = answered(State(TEXT), 1)
    data = header_data(answer)
    assert data["status"] == f"approximate, misfit {100 * answer.design.misfit:.2g} %"
    assert data["meaning"].startswith("Approximate: the heights follow a density")
    assert data["meaning"].endswith("rms difference from the law of the height density; up to 10 % is good.")
    assert (data["kind"], data["model"]) == ("", "independent")
    assert data["title"] == answer.specification.target.title


def test_problems_and_refusals_come_before_the_design_that_is_still_shown():
    before = answered(State(TEXT), 1)
    data = header_data(answered(State(TEXT.replace('"120 um"', "120")), 2, before))
    assert (data["status"], data["kind"]) == ("1 problem in the specification", "warn")
    assert "title" not in data
    failed = header_data(replace(before, problems={"": "no convergence"}, failed=True))
    assert (failed["status"], failed["meaning"]) == ("no design: the computation failed", "no convergence")
    refused = replace(before, refusal="slope 2 is not above the bound")
    assert header_data(refused)["status"] == "refused: no surface reaches the target"


def test_the_model_is_shown_also_where_the_text_has_problems():
    text = TEXT.replace('kind = "independent"', 'kind = "layered"')
    assert header_data(answered(State(text), 1))["model"] == "layered"
    assert "model" not in header_data(answered(State("[model"), 1))


def test_an_exact_design_is_called_exact():
    data = header_data(answered(State(demo_text("operating-points")), 1))
    assert data["status"] == "meets the target exactly"


def test_a_computation_that_was_stopped_is_called_so():
    data = header_data(answered(State(TEXT), 1, stopped=True))
    assert (data["status"], data["kind"], data["stopped"]) == (STOPPED, "", True)
    assert data["title"] == header_data(answered(State(TEXT), 1))["title"]
