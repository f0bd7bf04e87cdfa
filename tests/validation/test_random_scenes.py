"""Random scenes end as they are counted: converged, refused with a reason, or failed."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import metafem as mf
from validation.check import prose
from validation.results import Evaluated
from validation.scenes.random_contacts import random_scene
from validation.stability import random_scenes
from validation.verdicts import Evidence, answer

SCENE = random_scene(7)


class Broken(mf.Independent):
    """A model that ends in a given way."""

    end: object = None

    def curve(self, surface, load=None, *, approach=None, unloading=False):
        if isinstance(self.end, Exception):
            raise self.end
        curve = super().curve(surface, np.array([0.01]))
        return replace(curve, **self.end)


@pytest.mark.parametrize(
    ("end", "expected"),
    [
        ({}, "converged"),
        ({"residual": np.array([1.0])}, "not solved"),
        ({"stiffness": np.array([1.0]), "approach": np.array([np.nan])}, "failed"),
        (mf.InvalidInput("use lighter loads"), "refused"),
        (mf.NotConverged(""), "failed"),
        (mf.NotConverged("cannot be followed"), "not solved"),
        (ZeroDivisionError("division"), "failed"),
    ],
)
def test_each_end_is_counted_as_what_it_is(monkeypatch, end, expected):
    model = Broken()
    object.__setattr__(model, "end", end)
    scene = replace(SCENE, kind="independent", model=model, law=mf.Hertz(), by_load=True, unloading=False)
    monkeypatch.setattr(random_scenes, "random_scene", lambda seed, inside: scene)
    found = random_scenes.outcome(7, True)
    assert found.end == expected
    assert bool(found.reason) == (expected != "converged")


def test_a_seed_is_repeated_on_the_command_line():
    told = CliRunner().invoke(random_scenes.main, ["8", "--outside"]).output
    assert "Outcome(seed=8, inside=False" in told


def test_scenes_without_a_solution_are_rows_with_the_reason_in_its_own_words():
    words = "load {} mm^2 is beyond {} mm^2; raise offset"
    found = [
        random_scenes.Outcome(seed, False, "design", "Hertz", "refused", words.format(3.4 + seed, "1e-05"))
        for seed in range(5)
    ]
    found += [random_scenes.Outcome(9, True, "order 3", "Hertz", "converged")]
    (row,) = (row for row in random_scenes._results(found) if row.name.startswith("refused"))
    assert row.name == "refused: load … mm^2 is beyond … mm^2"
    assert row.value == 5
    assert row.method.startswith("outside the ranges: seeds 0, 1, 2, and 2 more. Seed 0: “load 3.4 mm^2 is")
    text = prose(random_scenes.claim, random_scenes._numbers(found))
    assert "Of 5 designs 5 were refused, of 1 other scenes 0." in text


def test_failures_of_solver_and_search_are_counted_as_failures_of_their_own():
    names = (
        ("order 3", "not solved"),
        ("design", "not solved"),
        ("design", "refused"),
        ("order 3", "converged"),
    )
    found = [
        random_scenes.Outcome(seed, False, model, "Hertz", end, "a reason" * (end != "converged"), error=0.0)
        for seed, (model, end) in enumerate(names)
    ]
    inside = random_scenes.Outcome(9, True, "order 3", "Hertz", "converged", error=0.0)
    rows = (*random_scenes._checks([*found, inside]), *random_scenes._results([*found, inside]))
    evidence = Evidence({"random_scenes": Evaluated("random_scenes", "", "", "A text.", rows, (), 1.0)})
    headline, sentence = answer("fails", evidence)
    assert headline == "None of the scenes inside the documented ranges, 2 of those outside"
    assert "no solution of 1 and the search of a design missed the target of 1; none of these" in sentence
    assert "None ended without a stated reason, and none inside the ranges were refused" in sentence
    unsolved = random_scenes._checks([replace(inside, end="not solved"), inside, *found])
    assert [check.passed for check in unsolved if check.name.startswith("inside")] == [True, False]
