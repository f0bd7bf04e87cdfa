"""Targets of designs on square lattices whose loads and areas grow with the number of asperities."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.inversion.targets.target import Target

LAYER = mf.Interacting(substrate=mf.BondedLayer(thickness=7.2))

# The paper's lattice, whose numbers of asperities the loads and areas are scaled from.
PAPER = 64

Task = tuple[Target, mf.Limits]


@cache
def template(count: int) -> mf.Surface:
    """Return a square lattice of `count` sites."""
    side = round(count**0.5)
    return mf.Surface.square_lattice(0.12, (side, side), 1.5, radius=0.526, material=mf.Material(1.36))


@cache
def tasks(count: int) -> dict[str, Task]:
    """Return the targets and limits for `count` asperities by name; the samples are those of a surface."""
    scale = count / PAPER
    thick, free = mf.Limits(0.27), mf.Limits(0.3, offset=0.05)
    height, load = np.random.default_rng(0).exponential(0.03, count), np.linspace(0.02, 0.5, 30) * scale
    area = mf.Independent().areas(template(count), load, height[None])[0]
    points = np.array([0.144, 0.336, 0.649]) * scale, np.array([0.84, 1.68, 4.12]) * scale
    return {
        "linear": (mf.LinearLaw(6.87), mf.Limits(0.12, offset=0.084)),
        "operating points": (mf.OperatingPoints(*points), thick),
        "sampled": (mf.SampledLaw(load, area), free),
        "power": (mf.PowerLaw(0.8, (0.1 * scale, 0.4 * scale)), free),
        "line over a range": (mf.LinearLaw(6.87, load_range=(0.05 * scale, 0.4 * scale)), free),
    }
