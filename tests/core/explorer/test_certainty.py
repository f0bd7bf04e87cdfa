"""How sure a design is: figures, the band of made surfaces, and warnings at their places."""

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import metafem as mf
from metafem.cli import main
from metafem.explorer.answer import Answer, answered
from metafem.explorer.certainty import band
from metafem.explorer.certainty.figures import Standing, figures
from metafem.explorer.certainty.panel import NO_DESIGN, NOT_CURRENT, STUDIES, at_once, figure_data
from metafem.explorer.certainty.places import remarks, warnings_by_place
from metafem.explorer.certainty.table import figure_table, note_list
from metafem.explorer.queue import Dropped
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.notes import Note, information
from metafem.prediction import Tolerances
from metafem.prediction.validity import WIDTH, base_contact_load
from metafem.progress import listening
from metafem.studies.sampling.slope import Slope
from tests.explorer.scenes import with_height

LINEAR, TEXT = demo_text("linear"), demo_text("operating-points")
EXACT = LINEAR.replace('height_sd = "0.9 um"', "")
BASE = "load at which the plane touches the base"


@pytest.fixture(scope="module")
def shown():
    return answered(State(LINEAR), 1)


def figure(answer, beginning):
    (found,) = [each for each in figures(answer) if each.name.startswith(beginning)]
    return found


def percentage(text):
    return float(text.split(" %")[0]) / 100


def differences(design, load, step=1e-7):
    """Return the changes (n, k) of the areas at loads with each height."""
    surface = design.surface
    heights = surface.height + step * np.vstack([np.eye(surface.count), -np.eye(surface.count)])
    plus, minus = np.split(design.law.model.areas(surface, load, heights), 2)
    return (plus - minus) / (2 * step)


def test_misfit_slopes_scatter_and_hardness_are_those_of_the_design(shown):
    design = shown.design
    misfit, slope = figure(shown, "misfit"), figure(shown, "fitted slope")
    assert (misfit.name, misfit.value) == mf.report.misfit_words(design)
    assert (misfit.standing, misfit.bound) == (Standing.GOOD, "at most 10 %")
    (row,) = mf.report.fit_table(design)[1]
    assert (slope.value, slope.bound) == (row[2], "target 6.87")
    _, low, high = band.tolerance_band(shown)
    rms = np.sqrt((((high - low) / (high + low)) ** 2).mean())
    assert percentage(figure(shown, "scatter of the law").value) == pytest.approx(rms, rel=0.05)
    fit = Slope.of(design.surface, None, design.law.model)
    sd = 0.0009 * np.linalg.norm(differences(design, fit.load) @ fit.weight)
    slope = fit.weight @ design.law.model.curve(design.surface, fit.load).area
    # two digits are printed
    assert percentage(figure(shown, "scatter of the slope").value) == pytest.approx(sd / slope, rel=0.03)
    missing = figure(answered(State(EXACT), 1), "scatter")
    assert (missing.value, missing.standing) == ("not stated", Standing.REMARK)
    error = design.law.model_error
    found = figure(shown, "estimated error of the model")
    assert percentage(found.value) == pytest.approx(np.sqrt((error.change**2).mean()), rel=0.05)
    assert found.standing is Standing.GOOD
    hard = answered(State(LINEAR + '\n[checks]\nhardness = "10 MPa"\n'), 1)
    assert figure(hard, "plasticity").value == f"{hard.design.parameters['plasticity_index']:.2g}"
    empty = Answer(1, shown.state)
    assert (figures(empty), remarks(empty), warnings_by_place(empty)) == ((), (), {})


def test_base_contact_and_wide_contacts_are_judged_and_told_at_their_places(shown, monkeypatch):
    design = shown.design
    onset = design.surface.material.composite_modulus * base_contact_load(design.surface, design.law.model)
    assert (figure(shown, BASE).value, figure(shown, BASE).standing) == (f"{onset:.3g} N", Standing.GOOD)
    low = replace(shown, design=replace(design, law=mf.friction_law(design.surface, load=[1.0, 1.1 * onset])))
    assert figure(low, BASE).standing is Standing.WARNING
    assert BASE in warnings_by_place(low)["limits.offset"][0]
    state = mf.equilibrium(design.surface, design.law.model, load=design.law.load[-1])
    ratio = np.sqrt(state.asperity_area / np.pi / design.surface.radius**2).max()
    assert figure(shown, "widest contact").value.startswith(f"{ratio:.2f} at ")
    parts = {
        name: getattr(design, name).replaced(position=getattr(design, name).position / 3.0)
        for name in ("surface", "template")
    }
    close = replace(shown, design=replace(design, **parts))
    near = figure(close, "contact radius over")
    assert near.standing is Standing.WARNING
    for place in ("surface", "lattice.pitch"):
        assert any(near.name in text for text in warnings_by_place(close)[place])

    def fails(*given):
        raise mf.NotConverged("no solution at 3 N")

    monkeypatch.setattr("metafem.explorer.certainty.figures.base_contact_load", fails)
    assert (figure(shown, BASE).value, figure(shown, BASE).standing) == ("unknown", Standing.UNKNOWN)


def test_notes_are_told_where_their_remedies_are():
    answer = answered(State(TEXT), 1)
    assert "take" not in warnings_by_place(answer)
    assert answer.no_part == ""
    notes = (
        Note("the caps", remedies=("load_range",)),
        Note("a word", remedies=("pitch", "model")),
        Note("no remedy"),
        Note("the figure has it", quantity=WIDTH, remedies=("radius",)),
    )
    before = warnings_by_place(answer)
    noted = replace(answer, design=replace(answer.design, notes=notes))
    places = {
        name: [text for text in texts if text not in before.get(name, [])]
        for name, texts in warnings_by_place(noted).items()
    }
    assert places["law"] == ["the caps", "no remedy"]
    assert places["target.load_range"] == ["the caps"]
    assert places["surface"] == places["lattice.pitch"] == places["model.kind"] == ["a word"]
    assert "lattice.radius" not in places
    assert remarks(noted) == mf.report.all_notes(noted.design)
    low = with_height(answer, 7, 0.0)
    assert warnings_by_place(low)["take"] == [low.no_part]
    assert low.no_part in warnings_by_place(low)["surface"]
    refused = answered(State(TEXT.replace('"1.68 mm^2"', '"3.9 mm^2"')), 2, low)
    assert warnings_by_place(refused) == {}  # those of an earlier surface


def test_the_band_is_that_of_differences_of_the_law(shown, monkeypatch):
    design = shown.design
    assert band.tolerances_of(shown) == Tolerances(height_sd=0.0009)
    robust = Tolerances(height_sd=0.003, angle=0.001)
    assert band.tolerances_of(replace(shown, design=replace(design, robust=robust))) == robust
    load, low, high = band.tolerance_band(shown)
    assert load[-1] == design.law.rescaled_load[-1]
    assert (low + high) / 2 == pytest.approx(design.law.area[::-3][::-1], rel=1e-12)
    sd = 0.0009 * np.linalg.norm(differences(design, load), axis=0)
    assert (high - low) / 2 == pytest.approx(sd, rel=1e-4)
    for without in (answered(State(EXACT), 1), Answer(1, shown.state)):
        assert band.tolerances_of(without) is band.tolerance_band(without) is band.draw(without) is None
        assert band.band_words(without) == ""
    assert "0.9 µm" in band.band_words(shown)
    several = Tolerances(angle=0.001, radius_sd=0.002)
    assert band.tolerance_words(several) == "errors of the radii of 2 µm (SD) and tilts within ±0.057°"
    monkeypatch.setattr(band, "MOST_ALONE", design.surface.count - 1)
    assert band.tolerance_band(answered(State(LINEAR), 1)) is None


def test_draws_replace_the_linear_band_and_end_when_nobody_waits():
    answer, again = (answered(State(LINEAR), 1) for _ in range(2))
    _, low, high = band.tolerance_band(answer)
    drawn = band.draw(answer) or band.draw(answer)  # the first one may compile kernels
    assert drawn.count == 200
    # the sampling error of a deviation of n draws is sd / sqrt(2 n)
    assert drawn.sd == pytest.approx((high - low) / 2, rel=4 / np.sqrt(2 * drawn.count))
    _, low, high = band.tolerance_band(answer)
    assert (low, high) == (pytest.approx(drawn.mean - drawn.sd), pytest.approx(drawn.mean + drawn.sd))
    scatter = np.sqrt(((drawn.sd / drawn.mean) ** 2).mean())
    assert percentage(figure(answer, "scatter of the law").value) == pytest.approx(scatter, rel=0.05)
    steps = []

    def on_step(step, done):
        steps.append(step)
        raise Dropped

    with pytest.raises(Dropped), listening(on_step):
        band.draw(again)
    assert (len(steps), band.drawn_of(again)) == (1, None)


def test_the_panel_has_the_figures_what_needs_attention_first():
    answer = answered(State(TEXT), 1)
    data = json.loads(json.dumps(figure_data(answer)))
    assert {row["name"]: row["value"] for row in data["rows"]} == {
        each.name: each.value for each in figures(answer)
    }
    assert [row["standing"] for row in data["rows"]] == ["remark", *["good"] * (len(data["rows"]) - 1)]
    assert (data["words"], at_once(answer)) == ("", True)
    old = replace(answer, problems={"limits.max_height": "is missing"})
    assert figure_data(old)["words"] == NOT_CURRENT
    assert figure_data(Answer(1, answer.state))["words"] == NO_DESIGN
    assert not at_once(Answer(1, answer.state))


def test_the_commands_of_studies_are_those_of_the_program():
    for command in STUDIES:
        program, *words = command.split()
        assert (program, CliRunner().invoke(main, [*words, "--help"]).exit_code) == ("metafem", 0)


def test_tables_and_notes_are_no_markup():
    texts = dict.fromkeys(("name", "value", "bound", "sentence"), "<b>")
    table = figure_table({"words": "", "rows": [{**texts, "standing": Standing.WARNING}], "band": "± 1 SD"})
    assert (table.count("<tr data-standing="), table.count('class="chip warn"')) == (1, 1)
    assert (table.count("&lt;b"), "<b>" in table) == (4, False)
    count, texts = note_list([Note("a"), information("b <"), information("c")])
    assert count == "1 warning, 2 notes on the design"
    assert "b &lt;" in texts
