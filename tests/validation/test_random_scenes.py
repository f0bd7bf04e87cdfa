"""Random scenes end as they are counted: converged, refused with a reason, or failed."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import metafem as mf
from validation.check import prose
from validation.scenes.random_contacts import random_scene
from validation.stability import random_scenes

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
        ({"residual": np.array([1.0])}, "refused"),
        ({"stiffness": np.array([1.0]), "approach": np.array([np.nan])}, "failed"),
        (mf.InvalidInput("use lighter loads"), "refused"),
        (mf.NotConverged(""), "failed"),
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
    (row,) = (row for row in random_scenes._results(found) if row.name.startswith("not solved"))
    assert row.name == "not solved: load … mm^2 is beyond … mm^2"
    assert row.value == 5
    assert row.method.startswith("outside the ranges: seeds 0, 1, 2, and 2 more. Seed 0: “load 3.4 mm^2 is")
    text = prose(random_scenes.claim, random_scenes._numbers(found))
    assert "Of 5 designs 5 were refused, of 1 other scenes 0." in text
