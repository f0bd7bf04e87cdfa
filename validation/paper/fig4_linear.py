"""Fig. 4: two linear laws of one material pair."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from metafem.studies.slope import slope
from validation.check import Claim, Picture, Row, near, reported
from validation.methods.densities import load_at_foot
from validation.methods.independent import fitted_slope
from validation.paper.pictures import law_and_slopes, slope_band
from validation.paper.surfaces import RADIUS, fig4, friction_of_slope
from validation.published import paper, table
from validation.sources import known_input, printed, second_method

COLOURS = ("blue", "red")

# Share of the load at which the plane reaches the foot of the density, from which the slopes are fitted. The
# paper prints how many of the last points are fitted, 12 (blue) and 7 (red), but not their loads.
FROM = 0.25

# Other ranges, as shares of this load.
OTHERS = ((0.1, 1.0), (0.25, 0.8), (0.5, 1.0))

# Accuracy of the quadrature and of the solvers of both methods, with a margin, relative.
METHODS = 1e-6

WHERE = "Fig. 4 caption"
TARGET = known_input("target slope of the design, which is printed in the Fig. 4 caption")


def claim() -> Claim:
    """Both surfaces of Fig. 4 are designed from the printed target slopes: 64 heights on steps of 6 µm, which
    follow a truncated exponential density, and independent Hertz contacts. The slope of the density is the
    target; the slope of 64 asperities is fitted to the predicted law between 25 and 100 % of the load at
    which the plane reaches the foot of the density. The paper prints no data points, but the measured slopes
    with their errors: both predicted slopes lie within them. The rows of other ranges show how much the
    slope depends on the loads of the fitted points, which the paper does not print.
    """
    checks: list[Row] = []
    for colour in COLOURS:
        design, numbers = fig4(colour), paper()["fig4"][colour]
        branch, fit = design.fits[0]
        measured, error = numbers["measured_slope"]
        checks += [
            near(
                f"{colour}: asymptotic slope of the density",
                design.density.asymptotic_slope(RADIUS),
                numbers["target_slope"], 1e-9, TARGET,
            ),
            near(
                f"{colour}: load at the foot of the density [mm²]", branch.load_range[1], foot_load(colour),
                METHODS * foot_load(colour),
                second_method(load_at_foot, "eq. S2 by quadrature, λ and h_m of the design"),
            ),
            near(
                f"{colour}: fitted slope of 64 asperities", fit.slope, table_slope(colour, fit.points),
                METHODS * measured,
                second_method(fitted_slope, "line through the law of Table S1's heights, by Newton's method"),
            ),
            near(f"{colour}: fitted slope and measured slope", fit.slope, measured, error,
                 printed(WHERE, f"Fig. 4 {colour}, measured slope")),
            *_ranges(colour),
        ]  # fmt: skip
    figures = {
        f"{colour.capitalize()} surface": Picture(partial(_figure, colour), {"surface": colour.capitalize()})
        for colour in COLOURS
    }
    return Claim("Fig. 4: linear laws", checks, figures)


def _ranges(colour: str) -> Iterator[Row]:
    """Report the slope of the law fitted over other ranges, and the friction coefficient."""
    foot, numbers = foot_load(colour), paper()["fig4"][colour]
    measured, error = numbers["measured_slope"]
    surface = fig4(colour).surface
    for begin, end in OTHERS:
        load = np.linspace(begin * foot, end * foot, 100)
        off = (slope(load, mf.Independent().curve(surface, load).area) - measured) / error
        name = f"{colour}: slope fitted from {100 * begin:g} to {100 * end:g} % minus the measured one [s.d.]"
        yield reported(name, float(off), "independent Hertz contacts")
    mu, unit = numbers["measured_friction_coefficient"], friction_of_slope(surface)
    where = printed(WHERE, f"Fig. 4 {colour}, measured friction coefficient")
    name, value = f"{colour}: friction coefficient of the fitted line", fig4(colour).fits[0][1].slope * unit
    yield near(name, value, mu, error * unit, where)


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


def _figure(colour: str):
    """{surface} surface, with the axes of the other one. Left: predicted rescaled friction F/(σB) over
    rescaled load P/E* [mm²], with the law of the continuous density and a straight line of the target slope.
    Right: slopes of both laws over the load. The slope of 64 asperities jumps whenever a level comes into
    contact; its fit (thick line) over the shaded range lies close to the target (dashed line), and inside the
    band of the measured slope.
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
