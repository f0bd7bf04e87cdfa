"""Random scenes from sparse to crowded, and what `Automatic` chooses on them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.models.error import coupled
from metafem.substrate import Substrate

LAWS = (mf.Hertz(), mf.Elastic(mf.Sphere()), mf.Elastic(mf.Power(3.0)), mf.Elastic(mf.Power(4.0)))
TOLERANCES = (1e-4, 1e-3, 1e-2)

# Part of the tolerance up to which the estimated error of order 3 makes it the reference.
NEGLIGIBLE = 0.3


class Choice(NamedTuple):
    """What `Automatic` chose at one load: 0 for independent asperities, 1 for order 3; errors of A0."""

    tolerance: float
    chosen: int
    cheapest: int  # the first within the tolerance
    estimate: float
    error: float
    along: float  # the error at this load of a curve of all loads
    stated: float  # the largest error that the curve states


def scene(rng: np.random.Generator) -> tuple[mf.Surface, Contact, Substrate, FloatArray]:
    """Return a surface of 2 to 39 asperities, 0.3 to 160 mm apart, a law, a substrate and 20 loads."""
    count, pitch = int(rng.integers(2, 40)), 10 ** rng.uniform(-0.1, 2.0)
    row, column = np.divmod(rng.permutation(7 * 7)[:count], 7)
    position = pitch * (np.column_stack([row, column]) + 0.3 * rng.uniform(-1.0, 1.0, (count, 2)))
    radius = 0.5 * (10 ** rng.uniform(-0.5, 0.5, count) if rng.random() < 0.5 else np.ones(count))
    spread = 10 ** rng.uniform(-3.0, -0.7)
    block = mf.Block(1000.0, 1000.0, 10 ** rng.uniform(0.3, 1.5))
    height = 0.3 + rng.uniform(0.0, spread, count)
    surface = mf.Surface(position, height, radius, mf.Material(1.36, 0.5), block=block)
    law = LAWS[int(rng.integers(len(LAWS)))]
    substrate = (mf.HalfSpace(), mf.BondedLayer())[int(rng.integers(2))]
    approach = 10 ** rng.uniform(-3.0, -1.5) * radius.min() + spread * rng.uniform(0.0, 1.0)
    end = mf.Independent(law).curve(surface, approach=np.array([approach])).load[0]
    return surface, law, substrate, np.linspace(end / 20, end, 20)


def choices(count: int, seed: int = 0) -> list[Choice]:
    """Return the choices of `Automatic` on `count` scenes, at the loads where order 3 can judge them."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(count):
        surface, law, substrate, load = scene(rng)
        models = (mf.Independent(law), mf.Interacting(3, substrate, law))
        try:
            alone, full = (model.curve(surface, load).checked() for model in models)
        except mf.MetafemError:
            continue
        errors = np.abs(alone.area / full.area - 1.0)
        _, own = coupled(surface, models[1], load)
        for tolerance in TOLERANCES:
            if own.max() > NEGLIGIBLE * tolerance:
                continue
            automatic = mf.Automatic(tolerance, substrate, law)
            curve = automatic.curve(surface, load)
            along = np.abs(curve.area / full.area - 1.0)
            for k in range(len(load)):
                state = automatic.curve(surface, load[k : k + 1])
                chosen = models.index(state.last.model)
                error = float(abs(state.area[0] / full.area[k] - 1.0))
                cheapest = int(errors[k] > tolerance)
                stated = float(curve.error or 0.0)
                estimate = float(state.error or 0.0)
                found.append(Choice(tolerance, chosen, cheapest, estimate, error, along[k], stated))
    return found
