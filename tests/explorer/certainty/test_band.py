"""The tolerance band of an answer, by linear response and by draws."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import Answer, answered
from metafem.explorer.certainty import band
from metafem.explorer.queue import Dropped
from metafem.explorer.session import State
from metafem.files import demo_text
from metafem.prediction import Tolerances
from metafem.progress import listening


def answer_of(text):
    answer = answered(State(text), 1)
    assert answer.design is not None
    return answer


@pytest.fixture(scope="module")
def linear_demo():
    return answer_of(demo_text("linear"))


def test_the_errors_are_those_of_robust_or_else_of_the_heights(linear_demo):
    tolerances = Tolerances(height_sd=0.003, angle=0.001)
    robust = replace(linear_demo, design=replace(linear_demo.design, robust=tolerances))
    assert band.tolerances_of(linear_demo) == Tolerances(height_sd=0.0009)
    assert band.tolerances_of(robust) == tolerances


def test_there_is_no_band_without_errors_or_a_design(linear_demo):
    exact = answer_of(linear_demo.state.text.replace('height_sd = "0.9 um"', ""))
    for answer in (exact, Answer(1, linear_demo.state)):
        assert band.tolerances_of(answer) is None
        assert band.tolerance_band(answer) is None
        assert band.band_words(answer) == ""
        assert band.draw(answer) is None


def test_linear_response_is_that_of_differences_of_the_law(linear_demo):
    design = linear_demo.design
    load, low, high = band.tolerance_band(linear_demo)
    assert load[-1] == design.law.rescaled_load[-1]
    assert (low + high) / 2 == pytest.approx(design.law.area[::-3][::-1], rel=1e-12)
    step, model, surface = 1e-7, design.law.model, design.surface
    heights = surface.height + step * np.vstack([np.eye(surface.count), -np.eye(surface.count)])
    plus, minus = np.split(model.areas(surface, load, heights), 2)
    sd = 0.0009 * np.sqrt((((plus - minus) / (2 * step)) ** 2).sum(axis=0))
    assert (high - low) / 2 == pytest.approx(sd, rel=1e-4)


def test_draws_replace_the_linear_band_and_agree_with_the_study(linear_demo):
    answer = answer_of(linear_demo.state.text)
    before = band.band_words(answer)
    drawn = band.draw(answer)
    load, low, high = band.tolerance_band(answer)
    assert (low, high) == (pytest.approx(drawn.mean - drawn.sd), pytest.approx(drawn.mean + drawn.sd))
    study = mf.studies.manufacturing(
        answer.design.surface,
        0.0009,
        draws=2000,
        load_range=(load[3], load[-1]),
        model=answer.design.law.model,
    )
    sd = np.interp(study.rescaled_load, load, drawn.sd)
    # the sampling error of a deviation of n draws is sd / sqrt(2 n), 5 % of it here
    assert sd == pytest.approx(study.area_sd.values[0], rel=4 / np.sqrt(2 * drawn.count))
    assert before == "± 1 SD of made surfaces, linear response to errors of the heights of 0.9 µm (SD)"
    assert band.band_words(answer).startswith(
        "± 1 SD about the mean of 200 made surfaces, drawn with errors of the heights of 0.9 µm (SD); "
    )


def test_draws_are_the_same_each_time_and_end_when_nobody_waits(linear_demo):
    first, again = (band.draw(answer_of(linear_demo.state.text)) for _ in range(2))
    assert (first.sd == again.sd).all()
    answer = answer_of(linear_demo.state.text)
    steps = []

    def on_step(step, done):
        steps.append(step)
        if len(steps) > 1:
            raise Dropped

    with pytest.raises(Dropped), listening(on_step):
        band.draw(answer)
    assert len(steps) == 2
    assert band.drawn_of(answer) is None


def test_many_asperities_have_no_band_at_once(monkeypatch, linear_demo):
    answer = answer_of(linear_demo.state.text)
    monkeypatch.setattr(band, "MOST_ALONE", answer.design.surface.count - 1)
    assert band.tolerance_band(answer) is None


@pytest.mark.parametrize(
    ("tolerances", "words"),
    [
        (Tolerances(0.0009), "errors of the heights of 0.9 µm (SD)"),
        (
            Tolerances(angle=0.001, radius_sd=0.002),
            "errors of the radii of 2 µm (SD) and tilts within ±0.057°",
        ),
    ],
)
def test_errors_in_words(tolerances, words):
    assert band.tolerance_words(tolerances) == words
