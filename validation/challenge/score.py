"""The scorer: the misfit of entries, by sums of closed forms and by resolved contacts, with numpy alone.

    python -m validation.challenge.score ENTRY [ENTRY ...] [--quick]

An entry is a JSON or CSV file; see `validation.challenge.entry`. Exit code 0: all entries keep the limits and
have the misfits that they state; 1: one does not; 2: a file cannot be read. With --quick no contacts are
resolved, and the misfits of targets with interaction are not compared with stated ones.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from validation.challenge import resolved
from validation.challenge.caps import Caps
from validation.challenge.entry import Entry, broken, read
from validation.challenge.substrate import point_loads
from validation.challenge.sums import coupled, independent
from validation.challenge.task import BadInput, Law, Target, names

# Number of random errors of the heights over which the misfit of a target with tolerances is averaged.
DRAWS = 1000

# Misfit of a target without a valid entry.
NONE = 1.0

# Relative and absolute difference of a misfit from a stated one: six digits are written, and heights that are
# rounded to 1e-10 mm change relative areas by about 1e-8.
DIGITS = {"rel_tol": 1e-5, "abs_tol": 1e-8}


@dataclass(frozen=True)
class Score:
    """What is known of an entry: misfits [-] and broken limits."""

    name: str
    sums: float  # from sums of closed forms
    resolved: float | None  # from resolved contacts, where asperities act on each other
    broken: list[str]
    stated: float | None = None  # the misfit that the entry states, if it differs

    @property
    def misfit(self) -> float:
        """The misfit that counts; that of no entry if a limit is broken."""
        if self.broken:
            return NONE
        return self.sums if self.resolved is None else self.resolved


def score(entry: Entry, quick: bool = False) -> Score:
    """Return the score of an entry; `quick` leaves the resolved contacts out."""
    wrong = broken(entry)
    found = None if wrong or quick or not entry.target.resolved else resolved_misfit(entry)
    result = Score(entry.target.name, float("nan") if wrong else sums_misfit(entry), found, wrong)
    stated = entry.stated.get("misfit")
    if stated is None or wrong or (quick and entry.target.resolved):
        return result
    return result if math.isclose(result.misfit, stated, **DIGITS) else replace(result, stated=stated)


def sums_misfit(entry: Entry) -> float:
    """Return the misfit from independent asperities or, with interaction, from point loads (order 1)."""
    wanted, caps = entry.target, Caps.of(entry.target.tools, entry.tool)
    if wanted.resolved:
        influence = point_loads(wanted.substrate, entry.position)
        area, _ = coupled(caps, entry.height, wanted.friction.load, influence)
        return float(wanted.misfit(area.sum(axis=1), None))
    return float(misfits(wanted, caps, drawn(wanted, entry.height)))


def misfits(wanted: Target, caps: Caps, height: np.ndarray) -> np.ndarray:
    """Return the misfits (...) of independent asperities of heights (..., draws, n), over their errors."""
    area, _ = independent(caps, height, wanted.friction.load)
    stiffness = None
    if wanted.stiffness is not None:
        _, stiffness = independent(caps, height, wanted.stiffness.load)
    return np.sqrt((wanted.misfit(area, stiffness) ** 2).mean(axis=-1))


def drawn(wanted: Target, height: np.ndarray, draws: int = DRAWS) -> np.ndarray:
    """Return heights (..., 1, n), or (..., draws, n) with random errors if the target has tolerances."""
    if not wanted.height_sd:
        return height[..., None, :]
    errors = np.random.default_rng(0).standard_normal((draws, wanted.count))[:, : height.shape[-1]]
    return height[..., None, :] + wanted.height_sd * errors


def resolved_misfit(entry: Entry, cell: float = resolved.CELL) -> float:
    """Return the misfit from resolved contacts."""
    return float(entry.target.misfit(resolved_areas(entry, entry.target.friction, cell), None))


def resolved_areas(entry: Entry, law: Law, cell: float = resolved.CELL) -> np.ndarray:
    """Return the areas (k,) [mm^2] of resolved contacts at the loads of a law."""
    grid = resolved.Grid(entry.target.substrate, entry.position, cell)
    tools = [entry.target.tools[t] for t in entry.tool]
    return resolved.areas(tools, entry.position, entry.height, law.load, grid).sum(axis=1)


def main(arguments: list[str]) -> int:
    """Print the scores of entries and their total, and return the exit code."""
    quick, paths = "--quick" in arguments, [Path(each) for each in arguments if each != "--quick"]
    if not paths or any(str(path).startswith("-") for path in paths):
        print(
            "usage: python -m validation.challenge.score ENTRY.json|ENTRY.csv ... [--quick]", file=sys.stderr
        )
        return 2
    best: dict[str, Score] = {}
    status = 0
    for path in paths:
        try:
            found = score(read(path), quick)
        except (BadInput, ArithmeticError) as error:
            print(f"error: {error}", file=sys.stderr)
            return 2
        status = 1 if found.broken or found.stated is not None else status
        print(line(found))
        if found.name not in best or found.misfit < best[found.name].misfit:
            best[found.name] = found
    every = names()
    total = sum(best[name].misfit if name in best else NONE for name in every) / len(every)
    missing = len(every) - len(best)
    print(f"total: {100 * total:.4g} %, the mean of {len(every)} misfits; {missing} targets without an entry")
    return status


def line(found: Score) -> str:
    """Return a score in one line."""
    if found.broken:
        return f"{found.name}: breaks its limits: {'; '.join(found.broken)}"
    words = f"{found.name}: misfit {100 * found.misfit:.4g} %; limits kept"
    if found.resolved is not None:
        words += f"; as point loads {100 * found.sums:.4g} %"
    return words if found.stated is None else f"{words}; the entry states {100 * found.stated:.6g} %"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
