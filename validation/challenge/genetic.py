"""A plain genetic search, with numpy alone, as the baseline of the challenge.

    python -m validation.challenge.genetic [NAME ...]

A surface is a height, a tool and whether there is an asperity, for each site. Two parents, each the better of
two drawn, give a child that takes every site from one of them; some sites then change at random. The best few
surfaces stay. Under interaction the misfits of the search are those of point loads; the result is scored as
any entry.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from validation.challenge.caps import Caps
from validation.challenge.entry import Entry
from validation.challenge.score import drawn, misfits, score
from validation.challenge.substrate import point_loads
from validation.challenge.sums import coupled
from validation.challenge.task import Target, names, target

RESULTS = Path(__file__).parent / "genetic.json"

# Surfaces of a generation, generations, surfaces that stay, share of sites that change, and the standard
# deviation of a change, relative to the largest height, at the beginning and at the end.
SIZE, GENERATIONS, KEPT, CHANGING, WIDTHS = 60, 200, 4, 0.05, (0.1, 0.002)

# Draws of the errors of heights in the search.
DRAWS = 20

# Misfit of a surface whose coupled contacts do not converge.
BAD = 10.0

# Height [mm] that stands for an empty site: far below every plane.
EMPTY = -1e3


@dataclass(frozen=True)
class Surfaces:
    """Some surfaces, arrays (m, n)."""

    height: np.ndarray
    tool: np.ndarray
    present: np.ndarray

    def take(self, rows: np.ndarray) -> Surfaces:
        """Return some of them."""
        return Surfaces(*(each[rows] for each in vars(self).values()))

    def beside(self, other: Surfaces) -> Surfaces:
        """Return these and others."""
        return Surfaces(*map(np.concatenate, zip(vars(self).values(), vars(other).values(), strict=True)))

    def mixed(self, other: Surfaces, own: np.ndarray) -> Surfaces:
        """Return the children that take the sites `own` from these and all others from `other`."""
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return Surfaces(*(np.where(own, a, b) for a, b in pairs))


def search(wanted: Target, seed: int = 0) -> Entry:
    """Return the best surface that the search finds."""
    rng = np.random.default_rng(seed)
    alive = _random(wanted, SIZE, rng)
    misfit = _misfits(wanted, alive)
    for width in np.geomspace(*WIDTHS, GENERATIONS):
        order = np.argsort(misfit)[:KEPT]
        mother, father = (alive.take(_better(misfit, rng)) for _ in range(2))
        children = mother.mixed(father, rng.random(alive.height.shape) < 0.5)
        children = _changed(wanted, children, width, rng)
        found = _misfits(wanted, children)
        kept = np.argsort(found)[: SIZE - KEPT]
        alive = alive.take(order).beside(children.take(kept))
        misfit = np.concatenate([misfit[order], found[kept]])
    one = alive.take(np.array([misfit.argmin()]))
    here = one.present[0]
    return Entry(wanted, wanted.sites[here], allowed(wanted, one.height[0, here]), one.tool[0, here])


def allowed(wanted: Target, height: np.ndarray) -> np.ndarray:
    """Return the nearest heights within the limits, on the levels of the steps if there are steps."""
    limits = wanted.limits
    low = limits.get("offset", 0.0) + limits.get("min_height", 0.0)
    high, step = limits.get("offset", 0.0) + limits["max_height"], limits.get("height_step")
    if not step:
        return np.clip(height, max(low, 1e-3), high)
    last = np.floor((high - low) / step - 0.5 + 1e-9)
    return low + step * (0.5 + np.clip(np.round((height - low) / step - 0.5), 0.0, last))


def _random(wanted: Target, size: int, rng: np.random.Generator) -> Surfaces:
    """Return random surfaces."""
    shape = (size, wanted.count)
    top = wanted.limits.get("offset", 0.0) + wanted.limits["max_height"]
    scale = wanted.limits["max_height"] * rng.uniform(0.02, 0.5, (size, 1))
    present = rng.random(shape) < rng.uniform(0.1, 1.0, (size, 1))
    present[:, 0] = True
    height = top - scale * rng.exponential(1.0, shape)
    return Surfaces(height, rng.integers(len(wanted.tools), size=shape), present)


def _better(misfit: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the numbers of the better one of random pairs, (SIZE,)."""
    first, second = rng.integers(len(misfit), size=(2, SIZE))
    return np.where(misfit[first] < misfit[second], first, second)


def _changed(wanted: Target, given: Surfaces, width: float, rng: np.random.Generator) -> Surfaces:
    """Return the surfaces with random changes of some sites."""
    shape = given.height.shape

    def some(share: float) -> np.ndarray:
        return rng.random(shape) < share

    step = width * wanted.limits["max_height"]
    height = given.height + step * some(2.0 * CHANGING) * rng.standard_normal(shape)
    tool = np.where(some(0.5 * CHANGING), rng.integers(len(wanted.tools), size=shape), given.tool)
    present = given.present ^ some(0.3 * CHANGING)
    present[:, 0] |= ~present.any(axis=1)
    return Surfaces(height, tool, present)


def _misfits(wanted: Target, given: Surfaces) -> np.ndarray:
    """Return the misfits (m,) of surfaces."""
    height = np.where(given.present, allowed(wanted, given.height), EMPTY)
    if wanted.resolved:
        return np.array(
            [_coupled(wanted, *one) for one in zip(height, given.tool, given.present, strict=True)]
        )
    caps = Caps.of(wanted.tools, given.tool[:, None, :])
    return misfits(wanted, caps, drawn(wanted, height, DRAWS))


def _coupled(wanted: Target, height: np.ndarray, tool: np.ndarray, present: np.ndarray) -> float:
    """Return the misfit of one surface from point loads."""
    influence = _influence(wanted)[np.ix_(present, present)]
    try:
        area, _ = coupled(
            Caps.of(wanted.tools, tool[present]), height[present], wanted.friction.load, influence
        )
    except (ArithmeticError, np.linalg.LinAlgError):
        return BAD
    return float(wanted.misfit(area.sum(axis=1), None))


_INFLUENCES: dict[str, np.ndarray] = {}


def _influence(wanted: Target) -> np.ndarray:
    """Return the influence of all sites, computed once."""
    if wanted.name not in _INFLUENCES:
        _INFLUENCES[wanted.name] = point_loads(wanted.substrate, wanted.sites)
    return _INFLUENCES[wanted.name]


def main(chosen: list[str]) -> int:
    """Search surfaces for the named targets, or for all, and write misfits and times."""
    found = json.loads(RESULTS.read_text("utf-8")) if RESULTS.exists() else {}
    for name in chosen or names():
        begin = time.perf_counter()
        entry = search(target(name))
        seconds = time.perf_counter() - begin
        result = score(entry)
        print(f"{name}: misfit {100.0 * result.misfit:.4g} %, {seconds:.3g} s", flush=True)
        found[name] = {"misfit": float(f"{result.misfit:.4g}"), "seconds": float(f"{seconds:.2g}")}
        rows = ",\n".join(f"  {json.dumps(key)}: {json.dumps(found[key])}" for key in sorted(found))
        RESULTS.write_text(f"{{\n{rows}\n}}\n", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
