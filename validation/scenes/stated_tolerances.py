"""Tolerances that studies state for several spans of errors, and what plain draws say at them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

import metafem as mf
from metafem.studies.made_laws import MadeLaws
from metafem.studies.sampling.inputs import NO_INPUTS
from validation.scenes.random_laws import LATTICE, LIMITS, random_law

# Errors of the heights [mm] and largest tilts [degrees] that are asked for.
HEIGHT_SD, ANGLE = (1e-3, 3e-3, 1e-2, 3e-2, 1e-1), (0.01, 0.1, 1.0, 10.0, 45.0)

# What is allowed: scatter of the slope, and the misfit that 90 % of the surfaces do not exceed.
SCATTER, MISFIT, PROBABILITY = 0.01, 0.03, 0.9

# Plain draws that are solved at once.
AT_ONCE = 5_000


def differences(seed: int, draws: int) -> Iterator[tuple[str, float, float]]:
    """Yield, for the design of a random law, differences of stated tolerances.

    Each is the name of the study, the relative difference between the largest and the least tolerance of all
    spans, and that of what plain draws show at their mean from what is stated. Scatter and misfit are nearly
    proportional to the errors, so this is that of the tolerances, too.
    """
    design = mf.design(random_law(seed), LATTICE, limits=LIMITS)
    surface, random = design.surface, np.random.default_rng(seed)
    yield _heights(surface, random, draws)
    yield _tilts(surface, random, draws)
    yield _combined(design, seed, draws)


def _heights(surface: mf.Surface, random: np.random.Generator, draws: int) -> tuple[str, float, float]:
    stated = [float(mf.studies.manufacturing(surface, sd).largest_height_sd) for sd in HEIGHT_SD]
    sd, load = np.mean(stated), mf.studies.manufacturing(surface, 0.0, draws=2).rescaled_load.values

    def drawn(count: int) -> np.ndarray:
        return np.asarray(surface.height + sd * random.standard_normal((count, surface.count)))

    return "manufacturing", _apart(stated), _scatter(surface, load, drawn, draws) / SCATTER - 1.0


def _tilts(surface: mf.Surface, random: np.random.Generator, draws: int) -> tuple[str, float, float]:
    found = [mf.studies.misalignment(surface, math.radians(angle)) for angle in ANGLE]
    stated, load = [float(each.largest_angle) for each in found], found[0].rescaled_load.values
    angle, along = np.mean(stated), surface.position.sum(axis=1)

    def drawn(count: int) -> np.ndarray:
        return np.asarray(surface.height + np.outer(np.tan(random.uniform(-angle, angle, count)), along))

    return "misalignment", _apart(stated), _scatter(surface, load, drawn, draws) / SCATTER - 1.0


def _combined(design: mf.Design, seed: int, draws: int) -> tuple[str, float, float]:
    stated = []
    for sd in HEIGHT_SD:
        requirement = mf.studies.Requirement(MISFIT, PROBABILITY)
        found = mf.studies.combined(design, mf.Tolerances(height_sd=sd), requirement=requirement)
        stated.append(sd * float(found.factor.sel({"tolerance": "all"})))
    tolerances = mf.Tolerances(height_sd=float(np.mean(stated)))
    branches = tuple(branch for branch, _ in design.fits)
    task = MadeLaws(
        design.surface, design.law.model, tolerances, NO_INPUTS, design.target_law, branches, None,
        seed=seed + 1, size=AT_ONCE, draws=draws,
    )  # fmt: skip
    misfit = np.concatenate([task(batch)["misfit"] for batch in task.batches])
    return "combined", _apart(stated), float(np.quantile(misfit, PROBABILITY)) / MISFIT - 1.0


def _apart(stated: list[float]) -> float:
    return max(stated) / min(stated) - 1.0


def _scatter(surface: mf.Surface, load: np.ndarray, drawn: Callable[[int], np.ndarray], draws: int) -> float:
    """Return the deviation of the slope of plain draws over the slope without errors, by numpy."""
    areas = [
        mf.Independent().areas(surface, load, drawn(min(AT_ONCE, draws - done)))
        for done in range(0, draws, AT_ONCE)
    ]
    slopes = np.polyfit(load, np.concatenate(areas).T, 1)[0]
    nominal = np.polyfit(load, mf.Independent().curve(surface, load).area, 1)[0]
    return float(slopes.std(ddof=1) / nominal)
