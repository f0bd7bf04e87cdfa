"""Targets taken from random real surfaces under their own model, so that each of them can be reached."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.inversion import Target
from metafem.models import Model
from validation.scenes.random_contacts import largest_load

RADIUS, MATERIAL, BLOCK = 0.526, mf.Material(1.36, 0.5), mf.Block(20.0, 20.0, 7.2)

# Largest numbers of rows of the lattices: in general, and of adhesive asperities that interact, of which one
# state takes milliseconds.
SIDE, ADHESIVE_SIDE = 8, 4

# Part of the documented range of contact radii that the last load reaches, at least and at most.
RANGE = 0.2, 0.9

# The first load of a target over its last, at least and at most.
FIRST = 0.02, 0.5

# Height of the tallest summit over the approach at the last load, so that the plane stays above the base.
CLEARANCE = 1.5

MODELS: dict[str, Callable[[Contact], Model]] = {
    "independent": mf.Independent,
    "order 1": lambda law: mf.Interacting(1, contact=law),
    "order 1, layer": lambda law: mf.Interacting(1, mf.BondedLayer(), law),
    "order 3": lambda law: mf.Interacting(3, contact=law),
    "order 3, layer": lambda law: mf.Interacting(3, mf.BondedLayer(), law),
}

# Half of the caps are paraboloids without adhesion.
LAWS: dict[str, Callable[[np.random.Generator], Contact]] = {
    "Hertz": lambda rng: mf.Hertz(),
    "sphere": lambda rng: mf.Elastic(mf.Sphere()),
    "power": lambda rng: mf.Elastic(mf.Power(rng.uniform(1.5, 4.0))),
    "JKR": lambda rng: mf.JKR(float(np.exp(rng.uniform(np.log(1e-6), np.log(3e-5))))),
    "plastic": lambda rng: mf.KogutEtsion(float(np.exp(rng.uniform(np.log(1.0), np.log(100.0))))),
}
SHARES = (0.5, 0.1, 0.15, 0.15, 0.1)

# Part of the targets that are operating points; the others are samples. Largest number of points, and
# numbers of samples.
POINTS, MOST_POINTS, SAMPLES = 0.5, 5, (6, 30)


def real_target(seed: int) -> tuple[Target, mf.Surface, Model, mf.Limits]:
    """Return the target of a seed, and what it is designed with."""
    rng = np.random.default_rng(seed)
    law = LAWS[str(rng.choice(list(LAWS), p=SHARES))](rng)
    names = [name for name in MODELS if law.largest_order > 1 or "3" not in name]
    model = MODELS[str(rng.choice(names))](law)
    side = int(rng.integers(2, 1 + (ADHESIVE_SIDE if model.couples and law.adhesive else SIDE)))
    depth = _depths(rng, side**2)
    sites = np.sort(rng.choice(side**2, len(depth), replace=False))
    lattice = mf.Surface.square_lattice(
        1.0, (side, side), rng.uniform(0.8, 2.0), radius=RADIUS, material=MATERIAL, block=BLOCK
    )
    radius = np.full(len(depth), RADIUS)
    part = lattice.replaced(position=lattice.position[sites], height=1.0 - depth, radius=radius)
    last = largest_load(part, law, rng.uniform(*RANGE))
    points = rng.random() < POINTS
    count = int(rng.integers(1, MOST_POINTS + 1)) if points else int(rng.integers(*SAMPLES))
    load = _loads(rng, count, last, points)
    curve = model.curve(part, load).checked()
    top = CLEARANCE * max(float(curve.approach[-1]), float(np.ptp(depth)))
    span = float(min(top, rng.choice([1.0, 1.5, 3.0]) * np.ptp(depth))) or top
    limits = mf.Limits(span, offset=top - span)
    target = _target(rng, points, model, curve.load, curve.area)
    template = lattice.replaced(height=np.full(lattice.count, top))
    return target, template, model, limits


def misfit(seed: int) -> float:
    """Design the target of a seed and return its misfit, inf if it is refused."""
    try:
        return mf.design(*real_target(seed)).misfit
    except mf.Infeasible:
        return np.inf


def _depths(rng: np.random.Generator, sites: int) -> FloatArray:
    """Return the depths of up to `sites` summits below the tallest, (n,) [mm]."""
    count = sites if rng.random() < 0.5 else int(rng.integers(1, sites + 1))
    kind = rng.integers(4)
    if kind == 0:
        depth = rng.exponential(rng.uniform(0.003, 0.05), count)
    elif kind == 1:
        depth = rng.uniform(0.0, rng.uniform(0.01, 0.1), count)
    elif kind == 2:
        depth = rng.choice([0.0, 0.05], count) + np.abs(rng.normal(0.0, 0.01, count))
    else:
        depth = rng.choice(rng.uniform(0.0, 0.1, int(rng.integers(1, 5))), count)
    return np.asarray(depth - depth.min())


def _loads(rng: np.random.Generator, count: int, last: float, points: bool) -> FloatArray:
    """Return increasing loads (k,) [mm²]: evenly spaced, or at random on a logarithmic scale for points."""
    first = last * float(np.exp(rng.uniform(*np.log(FIRST))))
    if not points:
        return np.linspace(first, last, count)
    inner = np.exp(rng.uniform(np.log(first), np.log(last), count - 1))
    return np.append(np.sort(inner), last)


def _target(
    rng: np.random.Generator, points: bool, model: Model, load: FloatArray, area: FloatArray
) -> Target:
    """Return points or samples of a law; of points, those with an increasing friction."""
    if not points:
        return mf.SampledLaw(load, area)
    rising = area > np.maximum.accumulate(np.insert(area, 0, 0.0))[:-1]
    return mf.OperatingPoints(load[rising], area[rising])
