"""A small search for the targets that metafem's specifications cannot state: heights and tools of each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from validation.challenge.caps import Caps
from validation.challenge.entry import Entry
from validation.challenge.genetic import allowed
from validation.challenge.score import misfits, resolved_areas, sums_misfit
from validation.challenge.substrate import point_loads
from validation.challenge.sums import contact_radii, coupled
from validation.challenge.task import Target

# Number of random starts, of the best of them, of random changes of each of these, and largest number of
# evaluations of one search.
STARTS, CLIMBS, CHANGES, EVALUATIONS = 300, 6, 300, 60

# Changes under interaction, and the evaluations of each.
COUPLED, COUPLED_EVALUATIONS = 150, 12

# Rounds in which the target of point loads is corrected by resolved contacts.
ROUNDS = 6

# Lowest height [mm] of an asperity; smallest indentation [mm] in slopes, which may be infinite at 0.
LOWEST, SHALLOWEST = 1e-3, 1e-9

# Distance from its ends [mm] at which a search begins, and its typical change [mm].
MARGIN, SCALE = 1e-6, 0.01

# Number of searches for a target with height steps.
STEPPED = 20

# Distance of coordinates [mm] below which two sites are the same.
SAME_SITE = 1e-6

# Decimals of heights [mm] on steps.
ROUNDED = 9


def searched(wanted: Target) -> tuple[Entry, str]:
    """Return the best of many searches by least squares from random heights and tools."""
    rng, alone = np.random.default_rng(0), replace(wanted, model="independent")
    starts = sorted((_attempt(alone, rng) for _ in range(STARTS)), key=_misfit)[:CLIMBS]
    found = [_climbed(start, rng, CHANGES)[1] for start in starts]
    method = f"least squares from {STARTS} random starts and {CHANGES} changes of the best {CLIMBS}"
    if not wanted.resolved:
        return min(found, key=sums_misfit), method
    coupled_starts = [refined(replace(entry, target=wanted)) for entry in found]
    one = _climbed(min(coupled_starts, key=_misfit), rng, COUPLED)[1]
    return _corrected(one), f"{method}, then {COUPLED} changes under interaction"


def _corrected(start: Entry) -> Entry:
    """Return the best surface after corrections of its target by resolved contacts."""
    wanted, found, tried = start.target, start, []
    for _ in range(ROUNDS):
        area = resolved_areas(found, wanted.friction)
        tried.append((float(wanted.misfit(area, None)), found))
        influence = point_loads(wanted.substrate, found.position)
        caps = Caps.of(wanted.tools, found.tool)
        sums = wanted.friction.value * (1.0 + _coupled_laws(wanted, caps, found.height, influence))
        law = replace(wanted.friction, value=wanted.friction.value * sums / area)
        aim = replace(found, target=replace(wanted, friction=law))
        found = replace(refined(aim)[1], target=wanted)
    return min(tried, key=_misfit)[1]


def _misfit(found: tuple[float, Entry]) -> float:
    return found[0]


def stepped(start: Entry) -> tuple[Entry, str]:
    """Return the best surface on height steps, from a design and from rounded results of searches."""
    rng, wanted = np.random.default_rng(0), start.target
    starts = [start]
    for _ in range(STEPPED):
        found = _attempt(wanted, rng, most=len(start.height))[1]
        starts.append(replace(found, height=allowed(wanted, found.height)))
    found = min(map(_on_levels, starts), key=lambda each: each[0])[1]
    return found, f"metafem design and {STEPPED} searches, with all changes of two levels that help"


def _on_levels(start: Entry) -> tuple[float, Entry]:
    """Return misfit and surface after all helpful changes of a level of one or two asperities."""
    wanted, step = start.target, start.target.limits["height_step"]
    caps = Caps.of(wanted.tools, start.tool)
    best, misfit = start.height, float(misfits(wanted, caps, start.height[None]))
    n = len(best)
    moves = step * np.vstack([np.eye(n), -np.eye(n)])
    while True:
        trials = allowed(wanted, (best + moves + moves[:, None]).reshape(-1, n))
        trials = np.unique(trials.round(ROUNDED), axis=0)
        found = misfits(wanted, Caps.of(wanted.tools, start.tool[None, None]), trials[:, None])
        if found.min() >= misfit:
            return misfit, replace(start, height=best)
        best, misfit = trials[found.argmin()], float(found.min())


def _attempt(wanted: Target, rng: np.random.Generator, most: int | None = None) -> tuple[float, Entry]:
    """Return the misfit and the surface of one search, with at most so many asperities."""
    most = most or wanted.count
    count = int(rng.integers(max(2, most // 3), most + 1))
    tool = rng.choice(len(wanted.tools), count, p=rng.dirichlet(np.ones(len(wanted.tools))))
    low, top = _ends(wanted)
    height = top - rng.exponential(rng.uniform(0.05, 0.6) * (top - low), count)
    return refined(Entry(wanted, wanted.sites[rng.permutation(wanted.count)[:count]], height, tool))


def _climbed(start: tuple[float, Entry], rng: np.random.Generator, changes: int) -> tuple[float, Entry]:
    """Return misfit and surface after random changes, of which those that help stay."""
    for _ in range(changes):
        trial = refined(_changed(start[1], rng))
        if trial[0] < start[0]:
            start = trial
    return start


def _changed(start: Entry, rng: np.random.Generator) -> Entry:
    """Return a surface with up to three other tools and heights, or with an asperity more or less."""
    tool, height, position = start.tool.copy(), start.height.copy(), start.position
    free = [site for site in start.target.sites if np.abs(position - site).sum(axis=1).min() > SAME_SITE]
    kind = rng.integers(4)
    if kind == 0 and free:
        position = np.vstack([position, free[rng.integers(len(free))]])
        tool = np.append(tool, rng.integers(len(start.target.tools)))
        height = np.append(height, rng.choice(height))
    elif kind == 1 and len(tool) > 1:
        kept = np.arange(len(tool)) != rng.integers(len(tool))
        position, tool, height = position[kept], tool[kept], height[kept]
    else:
        some = rng.choice(len(tool), min(len(tool), int(rng.integers(1, 4))), replace=False)
        tool[some] = rng.integers(0, len(start.target.tools), some.size)
        height[some] = rng.choice(height, some.size) + 0.05 * np.ptp(height) * rng.standard_normal(some.size)
    return replace(start, position=position, tool=tool, height=height)


def refined(start: Entry) -> tuple[float, Entry]:
    """Return the misfit and the surface after least squares over the heights."""
    wanted, caps = start.target, Caps.of(start.target.tools, start.tool)
    low, top = _ends(wanted)
    given = {"bounds": (low, top), "max_nfev": EVALUATIONS, "x_scale": SCALE}
    inside = np.clip(start.height, low + MARGIN, top - MARGIN)
    if wanted.resolved:
        given |= {"max_nfev": COUPLED_EVALUATIONS}
        influence = point_loads(wanted.substrate, start.position)
        found = least_squares(lambda height: _coupled_laws(wanted, caps, height, influence), inside, **given)
    else:
        found = least_squares(
            lambda height: _laws(wanted, caps, height)[0],
            inside,
            lambda height: _laws(wanted, caps, height)[1],
            **given,
        )
    return float(np.sqrt((found.fun**2).mean())), replace(start, height=found.x)


def _coupled_laws(wanted: Target, caps: Caps, height: np.ndarray, influence: np.ndarray) -> np.ndarray:
    """Return the relative differences of the law of point loads, (k,)."""
    area, _ = coupled(caps, height, wanted.friction.load, influence)
    return wanted.friction.difference(area.sum(axis=1))


def _ends(wanted: Target) -> tuple[float, float]:
    """Return the lowest and the largest height [mm]."""
    offset = wanted.limits.get("offset", 0.0)
    return max(offset + wanted.limits.get("min_height", 0.0), LOWEST), offset + wanted.limits["max_height"]


def _laws(wanted: Target, caps: Caps, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return relative differences (k,) and their derivatives by the heights (k, n), at fixed loads."""
    parts = []
    for law, is_area in ((wanted.friction, True), (wanted.stiffness, False)):
        if law is None:
            continue
        a = contact_radii(caps, height, law.load)
        stiffness = 2.0 * a.sum(axis=-1)
        depth = caps.factor * a**caps.exponent
        rise = np.divide(a, caps.exponent * np.maximum(depth, SHALLOWEST))  # da/dd
        own = 2.0 * np.pi * a * rise if is_area else 2.0 * rise
        value = np.pi * (a**2).sum(axis=-1) if is_area else stiffness
        by_height = own - 2.0 * a * (own.sum(axis=-1) / stiffness)[:, None]
        ratio, slope = value / law.value, by_height / law.value[:, None]
        if law.free:
            slope = (slope - np.outer(ratio, slope.mean(axis=0)) / ratio.mean()) / ratio.mean()
            ratio = ratio / ratio.mean()
        parts.append((ratio - 1.0, slope))
    return np.concatenate([each[0] for each in parts]), np.vstack([each[1] for each in parts])
