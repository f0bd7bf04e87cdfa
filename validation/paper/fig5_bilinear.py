"""Fig. 5: two bilinear laws."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

import metafem as mf
from metafem.drawing import TARGET
from validation.check import Claim, Picture, Row, below, near, reported
from validation.methods.independent import fitted_slope, sums
from validation.paper.pictures import law_and_slopes, load_band, slope_band
from validation.paper.surfaces import fig5
from validation.paper.table_s2 import heights, solved
from validation.published import paper
from validation.sources import known_input, printed, second_method

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = ("red", "blue")

# Accuracy of the solvers of both methods, with a margin.
METHODS = 1e-6

TARGETS = known_input("target of the design, which is printed in SM, building a bilinear friction law")
CROSSOVERS = printed("main text: the ratio of the crossover loads agrees with its target to 10 %")
MEASURED = printed("SM, building a bilinear friction law: 0.046 ± 0.005 and 0.098 ± 0.005 mm²")
HEIGHTS = "heights in the middles of intervals of equal mass, eqs. S7 and S8 by quadrature"
PREDICTED = "independent Hertz contacts, line through the predicted law of 64 asperities"

TEXT = """Both surfaces are designed for two slopes, 7.15 and 12.52, and a crossover load, with a weighted
exponential density of heights, eq. S6. The densities meet the targets exactly; the laws of 64 asperities
meet the slopes to about 6 %. Slopes are fitted between 25 and 100 % of each branch. The paper prints neither
its ranges nor data points; it states that its measured slopes agree with the targets to 5.2 %.

It also states the measured crossover loads, which lie 21 % (red) and 33 % (blue) above their targets, and
compares their ratio with its target, to 10 %. A part of the deviation is the rule by which they are read,
half-way between the last point on the line of the first branch and the first point off it: behind the
crossover the slope of the law rises gradually. Another part is that of few asperities: the lines fitted to
the two branches of the predicted laws intersect {red:.0f} % (red) and {blue:.0f} % (blue) above the
targets, still below the measured loads by more than their error; the ratio of both is the measured one
within its error."""

SEEN = """{} surface. Left: predicted rescaled friction F/(σB) over rescaled load P/E* [mm²] with the law of
the continuous density, lines of the target slopes, and the target crossover load (dotted). The band is the
measured crossover load, {:g} ± {:g} mm². Right: slopes of both laws over the load; the target slopes
(dashed) lie in bands of 5.2 %, within which the measured slopes agree with them. The slope of the density
changes at the crossover, that of 64 asperities jumps at each new contact; its fits (thick lines) deviate
from the targets by {:+.1f} % and {:+.1f} %{}."""


def claim() -> Claim:
    """Compare the densities and the laws of 64 asperities with the targets."""
    rows: list[Row] = []
    for colour in COLOURS:
        rows += _densities(colour) + _asperities(colour)
    rows += _crossovers()
    above = {
        colour: 1e2 * (_intersection(colour) / fig5(colour).target.crossover_load - 1.0) for colour in COLOURS
    }
    figures = {
        f"{colour.capitalize()} surface": Picture(
            partial(_figure, colour),
            _seen(colour),
        )
        for colour in COLOURS
    }
    return Claim("Fig. 5: bilinear laws", rows, figures, TEXT.format(**above))


def _crossovers() -> list[Row]:
    """Compare the measured crossover loads with the targets and with the predicted laws."""
    numbers = paper()["fig5"]
    target, measured, error = (
        {colour: numbers[colour][key] if index is None else numbers[colour][key][index] for colour in COLOURS}
        for key, index in (
            ("crossover_load_mm2", None),
            ("measured_crossover_mm2", 0),
            ("measured_crossover_mm2", 1),
        )
    )
    rows: list[Row] = []
    for colour in COLOURS:
        rows += [
            reported(f"{colour}: measured crossover load over its target", measured[colour] / target[colour],
                     "both printed in SM, building a bilinear friction law"),
            reported(f"{colour}: intersection of the fitted lines minus the measured crossover load [mm²]",
                     _intersection(colour) - measured[colour],
                     f"the measured one is {measured[colour]:g} ± {error[colour]:g} mm², printed in SM"),
        ]  # fmt: skip
    ratio, wanted = (each["blue"] / each["red"] for each in (measured, target))
    spread = ratio * np.hypot(*(error[colour] / measured[colour] for colour in COLOURS))
    return [
        *rows,
        near("ratio of the target crossover loads", wanted, numbers["crossover_ratio"], 0.005,
             printed("main text")),
        below("ratio of the measured crossover loads, deviation from the target [%]",
              1e2 * abs(ratio / wanted - 1.0), 1e2 * numbers["measured_ratio_within"], CROSSOVERS),
        near("ratio of the intersections of the predicted lines, and of the measured crossover loads",
             _intersection("blue") / _intersection("red"), ratio, spread, MEASURED),
    ]  # fmt: skip


def _seen(colour: str) -> str:
    """Return the caption of a surface, with the deviations of its fits."""
    numbers, fits = paper()["fig5"], fig5(colour).fits
    deviations = [fit.slope / branch.slope - 1.0 for branch, fit in fits]
    outside = [i for i, each in enumerate(deviations) if abs(each) > numbers["measured_within"]]
    words = f"; the second, {fits[1][1].slope:.2f}, lies outside the band" if outside == [1] else ""
    return SEEN.format(
        colour.capitalize(), *numbers[colour]["measured_crossover_mm2"],
        *(1e2 * each for each in deviations), words,
    )  # fmt: skip


def _densities(colour: str) -> list[Row]:
    """Check that the density has the printed targets."""
    design = fig5(colour)
    slopes = design.density.asymptotic_slopes(float(design.surface.radius[0]))
    crossover = design.density.crossover_load(design.surface.count, float(design.surface.radius[0]))
    numbers = paper()["fig5"]
    return [
        *(
            near(f"{colour}: slope m_{i + 1} of the density", slope, numbers["slopes"][i], 1e-9, TARGETS)
            for i, slope in enumerate(slopes)
        ),
        near(
            f"{colour}: crossover load of the density [mm²]", crossover,
            numbers[colour]["crossover_load_mm2"], 1e-9, TARGETS,
        ),
    ]  # fmt: skip


def _asperities(colour: str) -> list[Row]:
    """Check the law of 64 asperities by the second method, and report its deviations from the targets."""
    design, height = fig5(colour), heights(colour)
    radius, modulus = paper()["sample"]["radius_um"] / 1e3, design.surface.material.composite_modulus
    rows: list[Row] = []
    for i, (branch, fit) in enumerate(design.fits):
        expected = float(fitted_slope(height, branch.load, radius))
        lines = second_method(fitted_slope, f"line through the law by Newton's method; {HEIGHTS}")
        name = f"{colour}: fitted slope {i + 1}"
        rows += [
            near(f"{name} of 64 asperities", fit.slope, expected, METHODS, lines),
            reported(
                f"{name}, deviation from the target [%]", 1e2 * (fit.slope / branch.slope - 1.0), PREDICTED
            ),
        ]
    crossover = design.parameters["crossover_height"]
    load = mf.equilibrium(design.surface, separation=crossover).load / modulus
    expected = float(sums(height - solved(colour)[2], radius)[1])
    target = design.target.crossover_load
    return [
        *rows,
        near(
            f"{colour}: load of 64 asperities at the crossover height [mm²]", load, expected, METHODS,
            second_method(sums, f"sum of Hertz's loads; {HEIGHTS}"),
        ),
        reported(f"{colour}: load at the crossover height, deviation from the target [%]",
                 1e2 * (load / target - 1.0),
                 "independent Hertz contacts with the plane at the crossover height"),
        reported(f"{colour}: intersection of the fitted lines over the target load",
                 _intersection(colour) / target, PREDICTED),
    ]  # fmt: skip


def _intersection(colour: str) -> float:
    """Load [mm²] at which the lines fitted to the two branches of the predicted law intersect."""
    (_, first), (_, second) = fig5(colour).fits
    return (second.intercept - first.intercept) / (first.slope - second.slope)


def _figure(colour: str) -> Figure:
    """Draw the predicted law and its slopes with the numbers of the measurements."""
    design, numbers = fig5(colour), paper()["fig5"]
    figure, left, right = law_and_slopes(design)
    for ax in (left, right):
        load_band(
            ax, *numbers[colour]["measured_crossover_mm2"], "measured crossover" if ax is left else None
        )
    right.axvline(design.target.crossover_load, color=TARGET, ls=":", lw=1.2)
    for i, (branch, _) in enumerate(design.fits):
        label = "measured slopes within 5.2 %" if i == 0 else None
        slope_band(right, branch.load_range, branch.slope, numbers["measured_within"] * branch.slope, label)
    left.legend(frameon=False, loc="upper left", fontsize=8)
    right.legend(frameon=False, loc="lower right", fontsize=8)
    return figure
