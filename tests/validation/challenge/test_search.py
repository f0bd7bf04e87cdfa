"""The searches of the challenge, and the page that shows their results."""

import json
from dataclasses import replace

import numpy as np
import pytest

from validation.challenge import genetic
from validation.challenge.best_results import best
from validation.challenge.caps import Caps
from validation.challenge.entry import broken
from validation.challenge.score import sums_misfit
from validation.challenge.search import _laws
from validation.challenge.task import names, target
from validation.site.challenge import write_challenge


@pytest.mark.parametrize("name", ["05-saturation", "10-joint", "11-too-flat"])
def test_derivatives_are_those_of_differences(name):
    entry = best(name)
    wanted, caps = entry.target, Caps.of(entry.target.tools, entry.tool)
    # summits at all depths, so that none is about to touch
    height = 0.08 - 0.05 * np.arange(len(entry.height)) / len(entry.height)
    step = 1e-7
    _, slope = _laws(wanted, caps, height)
    for i in (0, len(height) // 2):
        move = step * (np.arange(len(height)) == i)
        high, low = (_laws(wanted, caps, height + sign * move)[0] for sign in (1.0, -1.0))
        np.testing.assert_allclose((high - low) / (2.0 * step), slope[:, i], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("name", ["02-height-steps", "05-saturation"])
def test_genetic_search_keeps_the_limits_and_improves(name, monkeypatch):
    monkeypatch.setattr(genetic, "GENERATIONS", 2)
    first = genetic.search(target(name))
    monkeypatch.setattr(genetic, "GENERATIONS", 40)
    later = genetic.search(target(name))
    assert broken(first) == broken(later) == []
    assert sums_misfit(later) < sums_misfit(first)
    np.testing.assert_array_equal(genetic.search(target(name)).height, later.height)


def test_best_results_are_no_worse_than_the_genetic_search():
    found = json.loads(genetic.RESULTS.read_text("utf-8"))
    assert sorted(found) == names()
    worse = [name for name in names() if best(name).stated["misfit"] > found[name]["misfit"] * (1.0 + 1e-3)]
    assert worse == []


def test_page_shows_every_target(tmp_path):
    (address,) = write_challenge(tmp_path)
    text = (tmp_path / address).read_text("utf-8")
    assert [name for name in names() if f'id="{name}"' not in text] == []
    assert text.count("<svg") == len(names())
    assert "arXiv.2511.03735" in text


def test_feet_that_overlap_are_named():
    entry = best("06-periodic-cell")
    moved = replace(entry, position=entry.position * 0.5)
    assert any("feet" in each and "overlap" in each for each in broken(moved))
