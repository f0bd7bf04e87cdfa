"""Times of the studies of misalignment and of uncertain parameters, and coverage of the Sobol indices."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from validation.paper.error_bars import DRAWS, errors, largest, measured
from validation.paper.surfaces import fig4, surfaces
from validation.scenes.sobol_functions import coverage
from validation.timing import Row, best, spent

# Fig. S2: largest angle [degrees] and shuffled placements; 2,001 angles.
LARGEST, SHUFFLES = 0.1, 20

LAYER = mf.Interacting(substrate=mf.BondedLayer())

# Repetitions of the Sobol indices, evaluations of each, and how far the coverage may be from 68 %.
REPETITIONS, EVALUATIONS, OFF = 2000, 4000, 0.04

MANY_DRAWS = 10**7

MANY = f"""
import metafem as mf
from validation.paper.error_bars import errors
from validation.paper.surfaces import surfaces
mf.studies.uncertainty(surfaces()["Fig. 4 blue"], errors("Fig. 4 blue"), draws={MANY_DRAWS})
"""


def rows() -> Iterator[Row]:
    """Measure the times of Fig. S2 and of the error bars of Figs. 3 to 5."""
    pair = [fig4(colour).surface for colour in ("blue", "red")]
    angle = float(np.radians(LARGEST))

    def tilted() -> None:
        for surface in pair:
            mf.studies.misalignment(surface, angle, shuffles=SHUFFLES)

    yield Row(f"Fig. S2, both surfaces, 2,001 angles, {SHUFFLES} shuffles", 5.0, best(tilted, 2), "s")
    for name, surface in surfaces().items():
        sd = errors(name)
        for model in (mf.Independent(), LAYER):
            seconds = best(partial(mf.studies.uncertainty, surface, sd, model=model, draws=DRAWS), 2)
            yield Row(f"{name}: bars of the law at 100 loads, {model.name}", 2.0, seconds, "s")
        seconds = best(partial(measured, name, largest(name) * np.arange(1, 21) / 20), 2)
        yield Row(f"{name}: bars of 20 measured pairs", 2.0, seconds, "s")


def long_rows() -> list[Row]:
    """Measure the coverage of the Sobol indices, and the memory of ten million draws."""
    off = np.abs(coverage(REPETITIONS, EVALUATIONS) - 0.68)
    memory = spent([sys.executable, "-c", MANY]).memory
    what = f"coverage of the 68 % intervals over {REPETITIONS} repetitions: largest difference"
    return [
        Row(f"{what}, Ishigami function", OFF, off[:, 0].max()),
        Row(f"{what}, linear law", OFF, off[:, 1].max()),
        Row(f"error bars with {MANY_DRAWS:.0e} draws: peak memory", 1.0, memory, "GiB"),
    ]
