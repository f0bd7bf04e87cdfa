"""Time, accuracy and memory of the study of manufacturing errors."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import metafem as mf
from validation.paper.surfaces import fig4
from validation.scenes.repeated_studies import EXPECTED, MOMENTS, coverage, tolerance
from validation.timing import Row, best, spent, took

# Fig. S3: standard deviations of the heights [mm], and its draws.
LEVELS, DRAWS = 1e-4 * np.arange(31), 10_000

# Levels at which plain draws of the interacting model are compared [mm].
COMPARED = (9e-4, 3e-3)

LAYER = mf.Interacting(substrate=mf.BondedLayer())

# Relative error of the standard deviation of Gaussian slopes, and that of the mean in units of it.
OF_SD, OF_MEAN = 1.0 / np.sqrt(2.0 * DRAWS), 1.0 / np.sqrt(DRAWS)

# Repeated studies, whose errors must hold the mean as often as stated.
REPETITIONS = 300

# Draws of a process of its own.
MANY = """
import metafem as mf
from validation.paper.surfaces import fig4
mf.studies.manufacturing(fig4("red").surface, 0.003, draws=10**7)
"""


def rows() -> Iterator[Row]:
    """Measure Fig. S3 of independent asperities."""
    studies: dict[str, Any] = {}
    taken = best(lambda: studies.update({colour: _study(colour) for colour in ("blue", "red")}), 1)
    yield Row("Fig. S3, both surfaces, 31 levels of 10,000 draws: time", 10.0, taken, "s")
    for colour, found in studies.items():
        study = found / float(found.nominal_slope)
        made = float(study.slope_sd.sel(height_sd=9e-4, method="nearest"))
        mean = float(abs(study.slope_mean - 1.0).max())
        yield Row(f"{colour}: scatter of the slope at 0.9 um", 0.005, made)
        yield Row(f"{colour}: scatter of the slope up to 3 um", 0.015, float(study.slope_sd.max()))
        yield Row(f"{colour}: change of the mean slope", 0.002, mean)


def long_rows() -> list[Row]:
    """Measure Fig. S3 on the bonded layer, the coverage of the errors, and ten million draws."""
    measured, total = [], 0.0
    for colour in ("blue", "red"):
        taken, study = took(partial(_study, colour, model=LAYER, draws=mf.studies.Draws(error=OF_SD)))
        total += taken
        drawn = study.sel(height_sd=LEVELS[1:], method="nearest")
        plain = _study(colour, COMPARED, model=LAYER, draws=mf.studies.Draws(plain=True))
        here = study.sel(height_sd=np.array(COMPARED), method="nearest")
        what = f"{colour}, layer, order 3"
        for name, bound in (("slope_sd", OF_SD), ("slope_mean", OF_MEAN)):
            error = float((drawn[f"{name}_error"] / drawn.slope_sd).max())
            apart = np.abs(here[name].values - plain[name].values)
            apart /= np.hypot(here[f"{name}_error"].values, plain[f"{name}_error"].values)
            measured += [
                Row(f"{what}: error of {name} over slope_sd", bound, error),
                Row(f"{what}: {name}, difference from plain draws", 3.0, float(apart.max()), "errors"),
            ]
    limit = tolerance(REPETITIONS)
    what = "Fig. S3, both surfaces, layer, order 3, to the error of 10,000 plain draws: time"
    return [
        Row(what, 60.0, total, "s"),
        *measured,
        *(
            Row(f"{name}: share of {REPETITIONS} studies within their errors, off by", limit, off)
            for name, off in zip(MOMENTS, np.abs(coverage(REPETITIONS) - EXPECTED).tolist(), strict=True)
        ),
        Row("10 million draws: memory", 1.0, spent([sys.executable, "-c", MANY]).memory, "GiB"),
    ]


def _study(colour: str, levels=LEVELS, **options):
    """Study the errors of the heights of a surface of Fig. 4, over the load range of its design."""
    design = fig4(colour)
    load_range = design.fits[0][1].load_range
    return mf.studies.manufacturing(design.surface, levels, load_range=load_range, **options)
