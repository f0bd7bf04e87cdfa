"""Intervals of repeated studies, and draws that are too few."""

from importlib import import_module

import pytest

import metafem as mf
from metafem.studies import Draws
from validation.scenes.repeated_studies import EXPECTED, coverage, tolerance


def test_errors_cover_the_mean_of_many_studies():
    # with Sobol points and control variates; the benchmark of the studies repeats 300
    assert coverage(100) == pytest.approx(EXPECTED, abs=tolerance(100))


def test_a_wanted_error_that_is_not_reached_is_noted(linear, monkeypatch):
    monkeypatch.setattr(import_module("metafem.studies.manufacturing"), "MOST_DRAWS", 200)
    study = mf.studies.manufacturing(linear, 0.003, draws=Draws(error=1e-4))
    assert study.draws.item() == 256
    assert "0.0001 of slope_sd is not reached within 256" in study.attrs["notes"]


def test_draws_are_added_until_the_error_is_reached(linear):
    study = mf.studies.manufacturing(linear, [0.0001, 0.01], draws=Draws(error=0.02))
    assert (study.slope_sd_error <= 0.02 * study.slope_sd).all()
    assert study.draws[1] > study.draws[0]
    assert study.attrs["draws"] == study.draws.max()
