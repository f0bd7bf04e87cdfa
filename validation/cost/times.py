"""How times are measured here: medians of repeated runs on surfaces for which nothing is kept."""

from __future__ import annotations

import os
import platform
import statistics
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from typing import Any

import numpy as np

import metafem as mf
from validation.timing import took

# Times are medians of this many runs, or of as many as take so long together [s], but at least of LEAST.
REPEATS, ENOUGH, LEAST = 50, 0.3, 3

# A run longer than this is not repeated [s].
LONG = 1.0


def timed(work: Callable[[int], Any]) -> tuple[float, Any]:
    """Median seconds of several runs, one if it is long, and the last answer; the work is told the run."""
    times: list[float] = []
    while len(times) < LEAST or (len(times) < REPEATS and sum(times) < ENOUGH):
        seconds, answer = took(partial(work, len(times)))
        times.append(seconds)
        if times[0] > LONG:
            break
    return statistics.median(times), answer


def renewed(surface: mf.Surface, run: int) -> mf.Surface:
    """Return the surface with sites moved by parts in 10⁹, for which nothing is kept from other calls."""
    moved = surface.position * (1.0 + 1e-9 * (run + 1))
    return mf.Surface(moved, surface.height, surface.radius, surface.material, surface.friction)


def machine(*packages: str) -> str:
    """State the number of cores, and the versions of Python and of packages."""
    versions = [f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", *packages)]
    cores = os.cpu_count()
    return (
        f"Measured on {cores} processor core{'' if cores == 1 else 's'} with Python "
        f"{platform.python_version()}, {', '.join(versions)}."
    )


def rounded(value: float, *, down: bool = False) -> float:
    """Return a number rounded to 1, 2 or 5 times a power of ten, so that it seldom changes between runs."""
    decade = 10.0 ** np.floor(np.log10(value))
    steps = decade * np.array([1.0, 2.0, 5.0, 10.0])
    if down:
        return float(steps[steps <= value * (1.0 + 1e-12)][-1])
    return float(steps[np.abs(np.log(steps / value)).argmin()])


def percent(value: float) -> str:
    """Return a percentage to two digits, without an exponent."""
    return f"{float(f'{100.0 * value:.2g}'):.10f}".rstrip("0").rstrip(".") + " %"


def in_words(seconds: float) -> str:
    """Return a time rounded to 1, 2 or 5 with its unit."""
    value = rounded(seconds)
    units = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))
    scale, unit = next((each for each in units if value >= each[0] * (1.0 - 1e-12)), units[-1])
    return f"{value / scale:.0f} {unit}"
