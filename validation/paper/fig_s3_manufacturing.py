"""Fig. S3: errors of the heights scatter the slopes of the linear laws by less than 1.5 %."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.report.study_figures import manufacturing_figure
from validation.check import Claim, below, near
from validation.paper.surfaces import fig4
from validation.published import PAPER

# Standard deviations of the heights [mm]: 0 to 3 um by steps of 0.1 um, and the workshop's.
LEVELS, MADE = 1e-4 * np.arange(31), 9e-4

# Sobol points with control variates: their errors are smaller than those of the paper's 10,000 draws.
DRAWS = 2000

# Scatter of the slope over the nominal one, at 0.9 and at 3 um, over 25 to 100 % of the load at which the
# plane reaches the foot of the density of heights; tests/validation/test_expected_numbers.py draws them with
# numpy. The paper does not print its range.
SCATTER = {"blue": (0.0045, 0.0139), "red": (0.0024, 0.0078)}

# Twice the sampling error of 2,000 draws, relative.
SAMPLING = 0.03

DRAWN = "2,000 draws with numpy, by tests/validation/test_expected_numbers.py"
TEXT = f"{PAPER}, SM, effect of manufacturing errors"


@cache
def study(colour: str):
    """Study the errors of the heights of a surface of Fig. 4."""
    design = fig4(colour)
    load_range = design.fits[0][1].load_range
    return mf.studies.manufacturing(design.surface, LEVELS, draws=DRAWS, load_range=load_range)


def claim() -> Claim:
    """Compare mean and scatter of the slopes with the bounds of the paper's text."""
    checks = []
    for colour, scatters in SCATTER.items():
        found = study(colour) / study(colour).nominal_slope
        scatter = found.slope_sd.values
        made = float(found.slope_sd.sel(height_sd=MADE, method="nearest"))
        mean = float(np.abs(found.slope_mean - 1.0).max())
        checks += [
            below(f"{colour}: largest scatter of the slope", float(scatter.max()), 0.015, TEXT),
            below(f"{colour}: scatter of the slope at 0.9 µm", made, 0.005, TEXT),
            below(f"{colour}: change of the mean slope", mean, 0.002, f"{TEXT}: very close to 1"),
        ]
        for name, value, expected in zip(("0.9", "3"), (made, scatter[-1]), scatters, strict=True):
            what = f"{colour}: scatter of the slope at {name} µm, drawn"
            checks.append(near(what, float(value), expected, SAMPLING * expected, DRAWN))
    figures = {"S3": lambda: manufacturing_figure({colour: study(colour) for colour in SCATTER})}
    return Claim("Fig. S3: errors of the heights", checks, figures)
