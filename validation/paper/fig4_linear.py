"""Fig. 4: two linear laws of one material pair."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from validation.check import Claim, Picture, Row, near, reported
from validation.methods.densities import load_at_foot
from validation.methods.independent import fitted_slope
from validation.paper.pictures import law_and_slopes, slope_band
from validation.paper.surfaces import RADIUS, fig4, friction_of_slope
from validation.published import paper, table
from validation.sources import known_input, printed, second_method

COLOURS = ("blue", "red")

# Share of the load at which the plane reaches the foot of the density, from which the slopes are fitted. The
# paper does not print its range.
FROM = 0.25

# Accuracy of the quadrature and of the solvers of both methods, with a margin.
METHODS = 1e-6

WHERE = "Fig. 4 caption"
TARGET = known_input("target slope of the design, which is printed in the Fig. 4 caption")
CONSISTENT = "consistency of the printed numbers, none of which metafem computes: {}"


def claim() -> Claim:
    """Both surfaces of Fig. 4 are designed from the printed target slopes: 64 heights on steps of 6 µm, which
    follow a truncated exponential density, and independent Hertz contacts. The slope of the density is the
    target; the slope of 64 asperities is fitted to the predicted law between 25 and 100 % of the load at
    which the plane reaches the foot of the density. The paper prints no data points, but the measured slopes
    with their errors: both predicted slopes lie within them.
    """
    checks: list[Row] = []
    for colour in COLOURS:
        design, numbers = fig4(colour), paper()["fig4"][colour]
        branch, fit = design.fits[0]
        measured, error = numbers["measured_slope"]
        coefficient = friction_of_slope(design.surface) * measured
        checks += [
            near(
                f"{colour}: asymptotic slope of the density",
                design.density.asymptotic_slope(RADIUS),
                numbers["target_slope"], 1e-9, TARGET,
            ),
            near(
                f"{colour}: load at the foot of the density [mm²]", branch.load_range[1], foot_load(colour),
                METHODS, second_method(load_at_foot, "eq. S2 by quadrature, λ and h_m of the design"),
            ),
            near(
                f"{colour}: fitted slope of 64 asperities", fit.slope, table_slope(colour, fit.points),
                METHODS,
                second_method(fitted_slope, "line through the law of Table S1's heights, by Newton's method"),
            ),
            near(f"{colour}: fitted slope and measured slope", fit.slope, measured, error,
                 printed(WHERE, f"Fig. 4 {colour}, measured slope")),
            reported(f"{colour}: deviation of the measured slope from the target [%]",
                     1e2 * (measured / numbers["target_slope"] - 1.0),
                     CONSISTENT.format("both in the caption, which states less than 2.1 %")),
            reported(f"{colour}: friction coefficient from the measured slope", coefficient,
                     CONSISTENT.format(f"σB/E* m; printed {numbers['measured_friction_coefficient']}")),
        ]  # fmt: skip
    return Claim("Fig. 4: linear laws", checks, {
        f"{colour.capitalize()} surface": Picture(partial(_figure, colour), _seen(colour))
        for colour in COLOURS
    })  # fmt: skip


def foot_load(colour: str) -> float:
    """Load P/E* [mm²] at which the plane reaches the foot of the density of a design."""
    top = paper()["fig4"][colour]["max_height_um"] / 1e3
    return load_at_foot(fig4(colour).parameters["scale"], top, 64, RADIUS)


def table_heights(colour: str) -> np.ndarray:
    """Return the 64 heights of Table S1 [mm], without the offset."""
    levels = table("table_s1")
    return np.repeat(levels["height"], levels[f"count_{colour}"].astype(int)) / 1e3


def table_slope(colour: str, points: int) -> float:
    """Slope of the law of Table S1's heights by the second method, at a number of loads."""
    foot = foot_load(colour)
    load = np.linspace(FROM * foot, foot, points)
    return float(fitted_slope(table_heights(colour), load, RADIUS))


def _seen(colour: str) -> dict[str, Any]:
    numbers = paper()["fig4"][colour]
    measured, error = numbers["measured_slope"]
    target = numbers["target_slope"]
    return {"surface": colour.capitalize(), "target": target, "measured": measured, "error": error}


def _figure(colour: str):
    """{surface} surface, with the axes of the other one. Left: predicted rescaled friction F/(σB) over
    rescaled load P/E* [mm²], with the law of the continuous density and a straight line of the target slope.
    Right: slopes of both laws over the load. The slope of 64 asperities jumps whenever a level comes into
    contact; its fit (thick line) over the shaded range lies close to the target {target} (dashed line), and
    inside the band of the measured slope, {measured} ± {error}.
    """
    design = fig4(colour)
    designs = {f"Fig. 4 {each}": fig4(each) for each in COLOURS}
    figure, left, right = law_and_slopes(f"Fig. 4 {colour}", designs)
    measured, error = paper()["fig4"][colour]["measured_slope"]
    label = f"measured slope {measured:g} ± {error:g}"
    slope_band(right, design.fits[0][0].load_range, measured, error, label)
    left.legend(frameon=False, loc="lower right")
    right.legend(frameon=False, loc="lower right")
    return figure
