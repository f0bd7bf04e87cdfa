"""Heights for laws of any shape: samples, powers, lines, and straight branches with free intercepts."""

from __future__ import annotations

from functools import singledispatch

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.candidate import Blueprint, Branch, Parameter
from metafem.inversion.feasibility import friction_bounds
from metafem.inversion.limits import Limits
from metafem.inversion.radii import Radii
from metafem.inversion.search.multistart import LawSearch, independent_law, nearest_law
from metafem.inversion.targets.laws import (
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
)
from metafem.inversion.targets.wanted import Wanted

# Number of loads at which a power law, or all branches of a multilinear law, are compared.
POINTS = 30

# Number of loads at which a line is compared. Its misfit is the largest difference, and with thirty loads
# contacts enter between them (measured: with this many, the misfit is within a tenth of that at any load).
LINE_POINTS = 100

# Random restarts of a search, about 10 ms each; nearly all laws of real surfaces need none or a few.
RESTARTS = 30

# Where the target leaves its level open, levels at these fractions of the feasible range (of its logarithm)
# are tried.
TRIED_SHARES = (0.5, 0.25, 0.75, 0.1, 0.9)


def invert(
    target: SampledLaw | PowerLaw | LinearLaw | BilinearLaw | MultilinearLaw,
    radii: Radii,
    count: int,
    limits: Limits,
    rng: np.random.Generator,
    restarts: int = RESTARTS,
) -> Blueprint:
    """Return heights and radii whose independent law is nearest to the target."""
    wanted = wanted_law(target)
    low, high = friction_bounds(wanted.load, radii, count)
    laws = first_laws(target, wanted, low, high)
    height, radius = nearest_law(LawSearch(wanted, laws, count, limits.span, restarts, rng), radii)
    area = independent_law(height, radius, wanted.load).curve.area
    parameters: dict[str, Parameter] = {"span": float(-height[-1]), **open_parameters(target, wanted, area)}
    branches = tuple(
        Branch(slope, ends, None if wanted.free.shape[1] else _intercept(wanted, slope, ends[0]))
        for slope, ends in target.branches
    )
    top = limits.offset + limits.max_height
    return Blueprint(top + height, radius, parameters, wanted, branches)


def _intercept(wanted: Wanted, slope: float, start: float) -> float:
    """Return the friction at zero load of the line on which a branch lies [mm^2]."""
    return float(np.interp(start, wanted.load, wanted.base)) - slope * start


@singledispatch
def wanted_law(target: object) -> Wanted:
    """Return the target law at a list of loads."""
    raise TypeError(f"{type(target).__name__} defines no law")


@wanted_law.register
def _(target: OperatingPoints) -> Wanted:
    return Wanted.exactly(target.rescaled_load, target.rescaled_friction, pointwise=True)


@wanted_law.register
def _(target: SampledLaw) -> Wanted:
    return Wanted.exactly(target.rescaled_load, target.rescaled_friction, target.weight)


@wanted_law.register(LinearLaw)
@wanted_law.register(BilinearLaw)
def _(target: LinearLaw | BilinearLaw) -> Wanted:
    each = LINE_POINTS // len(target.branches)
    load = np.unique(np.concatenate([np.geomspace(*ends, each) for _, ends in target.branches]))
    return Wanted.exactly(load, target.line(load), pointwise=True)


@wanted_law.register
def _(target: PowerLaw) -> Wanted:
    load = np.geomspace(*target.load_range, POINTS)
    shape = load**target.exponent
    if target.prefactor is not None:
        return Wanted.exactly(load, target.prefactor * shape)
    return Wanted(load, np.zeros(POINTS), shape[:, None], np.ones(POINTS))


@wanted_law.register
def _(target: MultilinearLaw) -> Wanted:
    each = max(4, POINTS // len(target.slopes))
    loads: list[FloatArray] = []
    base: list[FloatArray] = []
    piece: list[int] = []
    column, offset, last = 0, 0.0, 0.0
    for i, (slope, (start, end)) in enumerate(target.branches):
        load = np.linspace(start, end, each)
        if i and start > last:  # free between the branches: the intercept is another open parameter
            column, offset = column + 1, 0.0
        elif i:
            load = load[1:]
            offset += (target.slopes[i - 1] - slope) * start
        loads.append(load)
        base.append(offset + slope * load)
        piece += [column] * len(load)
        last = end
    free = np.eye(column + 1)[piece]
    return Wanted(np.concatenate(loads), np.concatenate(base), free, np.ones(len(piece)))


@singledispatch
def first_laws(target: object, wanted: Wanted, low: FloatArray, high: FloatArray) -> list[FloatArray]:
    """Return laws for the initial guesses; at several levels where the target leaves the level open."""
    return [wanted.base]


@first_laws.register
def _(target: PowerLaw, wanted: Wanted, low: FloatArray, high: FloatArray) -> list[FloatArray]:
    if target.prefactor is not None:
        return [wanted.base]
    shape = wanted.free[:, 0]
    least, most = float((low / shape).max()), float((high / shape).min())
    return [shape * least * (most / least) ** share for share in TRIED_SHARES]


@first_laws.register
def _(target: MultilinearLaw, wanted: Wanted, low: FloatArray, high: FloatArray) -> list[FloatArray]:
    laws = []
    for share in TRIED_SHARES:
        law = np.empty_like(wanted.load)
        for column in range(wanted.free.shape[1]):
            rows = np.flatnonzero(wanted.free[:, column])
            base, load = wanted.base[rows], wanted.load[rows]
            if column == 0:
                least, most = float((low[rows] - base).max()), float((high[rows] - base).min())
                level = least + share * (most - least)
            else:  # between the branches friction is proportional to the load
                last = rows[0] - 1
                level = float(law[last] * load[0] / wanted.load[last] - base[0])
            law[rows] = base + level
        laws.append(law)
    return laws


def open_parameters(target: object, wanted: Wanted, area: FloatArray) -> dict[str, Parameter]:
    """Return the parameters that the target leaves open, fitted to the law."""
    if not wanted.free.shape[1]:
        return {}
    found = np.linalg.lstsq(wanted.free, wanted.law(area) - wanted.base, rcond=None)[0]
    if isinstance(target, PowerLaw):
        return {"prefactor": float(found[0])}
    return {"intercepts": np.asarray(found, dtype=np.float64)}
