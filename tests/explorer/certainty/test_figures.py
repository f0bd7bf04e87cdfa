"""The figures that say how sure a design is, against the functions and studies they come from."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import Answer, answered
from metafem.explorer.certainty import band
from metafem.explorer.certainty.figures import Standing, figures
from metafem.explorer.certainty.places import remarks, warnings_by_place
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.prediction.validity import base_contact_load

LINEAR = demo_text("linear")


def answer_of(text):
    answer = answered(State(text), 1)
    assert answer.design is not None, (answer.problems, answer.refusal)
    return answer


@pytest.fixture(scope="module")
def shown():
    return answer_of(LINEAR)


def figure(answer, beginning):
    (found,) = [each for each in figures(answer) if each.name.startswith(beginning)]
    return found


def percentage(text):
    return float(text.split(" %")[0]) / 100


def test_a_page_without_a_design_has_no_figures(shown):
    empty = Answer(1, shown.state)
    assert (figures(empty), remarks(empty), warnings_by_place(empty)) == ((), (), {})


def test_misfit_and_slopes_are_those_of_the_report(shown):
    design = shown.design
    misfit, slope = figure(shown, "misfit"), figure(shown, "fitted slope")
    assert (misfit.name, misfit.value) == mf.report.misfit_words(design)
    assert (misfit.standing, misfit.bound) == (Standing.GOOD, "at most 10 %")
    (row,) = mf.report.fit_table(design)[1]
    assert (slope.value, slope.bound) == (row[2], "target 6.87")
    assert slope.sentence.startswith(f"It differs from the target by {row[3]};")


@pytest.mark.slow
def test_interaction_is_that_of_the_study(shown):
    found, law = figure(shown, "estimated error of the model"), shown.design.law
    change = (
        mf.studies.interaction(shown.design, placements=1).area_change.sel(substrate="layer", order=3).values
    )
    largest = change[np.abs(change).argmax()]
    # the estimate is made at eight loads of the law, and includes the error of order 3
    assert 0.5 < law.model_error / abs(largest) < 1.2
    way = "lowers" if largest < 0 else "raises"
    assert f"{way} the friction at a given load by up to" in found.sentence
    assert found.standing is Standing.GOOD


@pytest.mark.slow
def test_scatter_of_the_slope_is_that_of_the_study(shown):
    study = mf.studies.manufacturing(shown.design.surface, 0.0009, draws=200, model=shown.design.law.model)
    expected = float(study.slope_sd[0] / study.nominal_slope)
    found = figure(shown, "scatter of the slope")
    # linear response is 3 % of it, and two digits are printed
    assert percentage(found.value) == pytest.approx(expected, rel=0.06)


def test_scatter_of_the_law_is_that_of_the_band_by_draws_once_there_are_some():
    answer = answer_of(LINEAR)
    before = figure(answer, "scatter of the law")
    _, low, high = band.tolerance_band(answer)
    rms = np.sqrt((((high - low) / (high + low)) ** 2).mean())
    assert percentage(before.value) == pytest.approx(rms, rel=0.05)
    assert before.sentence.startswith("By linear response to errors of the heights of 0.9 µm (SD)")
    # the first draws may compile kernels, which takes longer than draws may
    drawn = band.draw(answer) or band.draw(answer)
    after = figure(answer, "scatter of the law")
    assert percentage(after.value) == pytest.approx(np.sqrt(((drawn.sd / drawn.mean) ** 2).mean()), rel=0.05)
    assert after.sentence.startswith("Of 200 drawn surfaces")


def test_errors_of_the_part_that_are_not_stated_are_asked_for():
    found = figure(answer_of(LINEAR.replace('height_sd = "0.9 um"', "")), "scatter")
    assert (found.value, found.standing) == ("not stated", Standing.REMARK)
    assert "limits.height_sd" in found.sentence


def test_base_contact_is_compared_with_the_largest_load(shown):
    design = shown.design
    onset = design.surface.material.composite_modulus * base_contact_load(design.surface, design.law.model)
    found = figure(shown, "load at which the plane touches the base")
    assert (found.value, found.standing) == (f"{onset:.3g} N", Standing.GOOD)
    low = replace(shown, design=replace(design, law=mf.friction_law(design.surface, load=[1.0, 1.1 * onset])))
    touching = figure(low, "load at which the plane touches the base")
    assert touching.standing is Standing.WARNING
    assert touching.name in warnings_by_place(low)["limits.offset"][0]


def test_wide_contacts_are_judged_as_by_the_notes(shown):
    state = mf.equilibrium(shown.design.surface, shown.design.law.model, load=shown.design.law.load[-1])
    ratio = np.sqrt(state.asperity_area / np.pi / shown.design.surface.radius**2).max()
    assert figure(shown, "widest contact").value.startswith(f"{ratio:.2f} at ")
    design = shown.design
    parts = {
        name: getattr(design, name).replaced(position=getattr(design, name).position / 3.0)
        for name in ("surface", "template")
    }
    close = replace(shown, design=replace(design, **parts))
    near = figure(close, "contact radius over")
    assert near.standing is Standing.WARNING
    assert "pairs overlap" in near.sentence
    places = warnings_by_place(close)
    assert any(near.name in text for text in places["surface"])
    assert any(near.name in text for text in places["lattice.pitch"])
    # the note that states the same is not repeated
    assert not any(text.startswith("contacts overlap") for text in places["surface"])


def test_the_plasticity_index_is_shown_where_a_hardness_is_given():
    answer = answer_of(LINEAR + '\n[checks]\nhardness = "10 MPa"\n')
    index = answer.design.parameters["plasticity_index"]
    assert figure(answer, "plasticity").value == f"{index:.2g}"
    assert figure(answer, "plasticity").standing is Standing.GOOD


def test_what_has_no_solution_is_said_in_words(shown, monkeypatch):
    def fails(*given):
        raise mf.NotConverged("no solution at 3 N")

    monkeypatch.setattr("metafem.explorer.certainty.figures.base_contact_load", fails)
    found = figure(shown, "load at which the plane touches the base")
    assert (found.value, found.standing) == ("unknown", Standing.UNKNOWN)
    assert found.sentence == "No solution at 3 N."


def test_notes_are_those_of_the_report_warnings_first(shown):
    warned = replace(
        shown,
        design=replace(
            shown.design, notes=(*shown.design.notes, mf.Note("raise the offset", remedies=("offset",)))
        ),
    )
    assert remarks(warned) == mf.report.all_notes(warned.design)
    assert remarks(warned)[0].warns
    assert warnings_by_place(warned) == {
        "surface": ["raise the offset"],
        "limits.offset": ["raise the offset"],
    }
