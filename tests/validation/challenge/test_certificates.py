"""The certificates of the impossible targets."""

import json
from itertools import pairwise

import numpy as np
import pytest

from validation.challenge import certificates, certify
from validation.challenge.best_results import best
from validation.challenge.caps import Caps
from validation.challenge.certificates import Case, certificate, certified, checked, possible
from validation.challenge.score import sums_misfit
from validation.challenge.sums import independent
from validation.challenge.task import names, target


def test_every_impossible_target_has_one():
    assert certified() == [name for name in names() if target(name).level == "impossible"]
    assert len(certified()) >= 2


@pytest.mark.parametrize("name", certified())
def test_bounds_are_proven_and_below_the_best_results(name):
    bound = checked(name)
    assert bound == pytest.approx(certificate(name)["bound"], rel=1e-5)  # six digits are written
    assert 0.05 < bound <= sums_misfit(best(name)) * (1.0 + 1e-6)


def test_one_bound_is_reached():
    name = "11-too-flat"
    assert sums_misfit(best(name)) == pytest.approx(checked(name), rel=1e-4)


@pytest.mark.parametrize("name", certified())
def test_random_surfaces_obey_all_rows(name):
    wanted, rng = target(name), np.random.default_rng(3)
    divided = certificate(name)["load"]
    edges = np.array(certificate(name)["edges"])
    for _ in range(40):
        n = int(rng.integers(1, wanted.count + 1))
        height = rng.exponential(10.0 ** rng.uniform(-5.0, -1.0), n)
        caps = Caps.of(wanted.tools, np.zeros(n, dtype=int))
        area, _ = independent(caps, height, wanted.friction.load)
        i = int(np.searchsorted(edges, area[divided])) - 1
        case = Case(wanted, divided, edges[i], edges[i + 1])
        for row in case.rows():
            line, least = case.constraint(row)
            # a difference of terms of about the size 10, to rounding
            assert line @ (area / wanted.friction.value) >= least - 1e-11, row


@pytest.mark.parametrize("name", certified())
def test_written_multipliers_are_those_of_the_search(name):
    found = certificate(name)
    cases = [Case(target(name), found["load"], *ends) for ends in pairwise(found["edges"])]
    again = [case.bound(certify._multipliers(case)) for case in cases]
    assert min(again) == pytest.approx(found["bound"], rel=1e-4)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bound": 0.5}, "states 0.5, and its multipliers prove"),
        ({"edges": [1.0, 1.1]}, "must cover all areas"),
        ({"cases": [[["rises", 0, 1, -1.0]]]}, "no proven row"),
        ({"cases": [[["falls", 0, 1, 1.0]]]}, "no proven row"),
    ],
)
def test_wrong_certificates_are_refused(change, words, tmp_path, monkeypatch):
    name = "11-too-flat"
    (tmp_path / f"{name}.json").write_text(json.dumps(certificate(name) | change), "utf-8")
    monkeypatch.setattr(certificates, "FOLDER", tmp_path)
    with pytest.raises(ValueError, match=words):
        checked(name)


def test_possible_areas_are_those_of_one_and_of_equal_asperities():
    wanted = target("12-too-steep")
    for n, expected in zip((1, wanted.count), possible(wanted, 3), strict=True):
        caps = Caps.of(wanted.tools, np.zeros(n, dtype=int))
        area, _ = independent(caps, np.ones(n), wanted.friction.load[3:4])
        assert area[0] == pytest.approx(expected, rel=1e-12)
