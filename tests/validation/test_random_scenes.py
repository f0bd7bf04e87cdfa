"""Random scenes end as they are counted: converged, refused with a reason, or failed."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import metafem as mf
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
