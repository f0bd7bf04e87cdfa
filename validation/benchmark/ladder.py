"""What `Automatic` chooses on random scenes, its time on sparse ones, and estimated errors of models."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import metafem as mf
from metafem.models import Model
from validation.scenes.ladder import Choice, choices, estimates
from validation.timing import Row, best

# Random scenes; rows of the sparse lattices and their pitch [mm], of which contacts are below a hundredth.
SCENES, SIDES, PITCH = 2000, (8, 20, 40), 100.0

# Errors below this are not compared with their estimates.
SMALL = 1e-4


def rows() -> Iterator[Row]:
    """Compare the choices on random scenes with all models, and time curves of 100 loads."""
    found = Choice(*np.array(choices(SCENES)).T)
    above = found.chosen - found.cheapest
    large = (found.error > SMALL) & (found.chosen < 2)
    ratio = found.estimate[large] / found.error[large]
    what = f"{len(above)} choices on {SCENES} scenes"
    yield Row(f"{what}: error of A0 over the tolerance", 1.0, float((found.error / found.tolerance).max()))
    yield Row(f"{what}: more than one model too high [%]", 10.0, 100.0 * float((above > 1).mean()))
    yield Row(f"{what}: dearer than the cheapest [%]", 10.0, 100.0 * float((above > 0).mean()))
    apart = (ratio > 3.0) | (ratio < 1.0 / 3.0)
    yield Row(f"{large.sum()} estimates off by more than a factor of three [%]", 1.0, 100.0 * apart.mean())
    judged = estimates(SCENES)
    estimate, error = judged[judged[:, 1] > SMALL].T
    ratio = estimate / error
    what = f"{len(ratio)} errors of independent asperities and of order 1: estimates"
    apart = ~((ratio > 1.0 / 3.0) & (ratio < 3.0))
    yield Row(f"{what} off by more than a factor of three [%]", 1.0, 100.0 * apart.mean())
    for side in SIDES:
        ratio = _seconds(mf.Automatic(1e-3), side) / _seconds(mf.Independent(), side)
        yield Row(f"{side**2} sparse asperities, 100 loads: time over independent", 1.2, ratio)


def _seconds(model: Model, side: int) -> float:
    """Seconds of a curve of 100 loads on a sparse lattice."""
    height = np.random.default_rng(0).uniform(0.1, 0.2, side**2)
    material = mf.Material(1.36)
    surface = mf.Surface.square_lattice(height, (side, side), PITCH, radius=0.526, material=material)
    load = np.linspace(0.005, 0.1, 100) * side**2 / 64
    return best(lambda: model.curve(surface, load), 5)
