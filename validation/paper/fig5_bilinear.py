"""Fig. 5: two bilinear laws."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import metafem as mf
from metafem.drawing import MEASURED
from validation.check import Claim, Difference, Picture, Reason, Row, near, reported
from validation.methods.independent import fitted_slope, sums
from validation.paper.pictures import INKS, law_and_slopes, load_band, slope_band
from validation.paper.surfaces import RADIUS, fig5
from validation.paper.table_s2 import heights, solved
from validation.published import paper
from validation.sources import known_input, printed, second_method

COLOURS = ("red", "blue")

# Accuracy of the solvers of both methods, with a margin, relative.
METHODS = 1e-6

TARGETS = known_input("target of the design, which is printed in SM, building a bilinear friction law")
CROSSOVERS = printed("SM, building a bilinear friction law")
SLOPES = printed("Fig. 5 caption")
RATIO = printed("main text, building friction laws with multiple branches", "ratio of the crossover loads")
HEIGHTS = "heights in the middles of intervals of equal mass, eqs. S7 and S8 by quadrature"

SLOPE = """This is the slope of the 64 designed asperities, predicted over the loads of this check. The paper
prints neither its measured slopes nor the loads of the fitted points."""

PREDICTED = "independent Hertz contacts, line through the predicted law of 64 asperities"


def claim() -> Claim:
    """Both surfaces are designed for two slopes, 7.15 and 12.52, and a crossover load, with a weighted
    exponential density of heights, eq. S6. The densities meet the targets exactly; the laws of 64 asperities
    meet the slopes to about 6 %. Slopes are fitted between 25 and 100 % of each branch. The paper prints
    the numbers of fitted points, but not their loads; it states that its measured slopes agree with the
    targets to 5.2 %.

    It also states the measured crossover loads, which lie 21 % (red) and 33 % (blue) above their targets. The
    lines fitted to the two branches of the predicted laws intersect above the targets as well, because 64
    asperities are few. The measured load of the blue surface lies above this intersection by more than its
    printed error. The paper reads its loads otherwise: half-way between the last point on the line of the
    first branch and the first point off it. The claim “Fig. 5: crossover and slopes of measured laws”
    applies this rule to the predicted laws, and finds the measured loads of both surfaces.
    """
    rows: list[Row] = []
    for colour in COLOURS:
        rows += [*_densities(colour), *_asperities(colour), *_crossover(colour)]
    ratio, most = paper()["fig5"]["crossover_ratio"], paper()["fig5"]["measured_ratio_within"]
    found, name = _intersection("blue") / _intersection("red"), "crossover load of blue over that of red"
    rows.append(near(name, found, ratio, most * ratio, RATIO))
    figures = {
        f"{colour.capitalize()} surface": Picture(partial(_figure, colour), {"surface": colour.capitalize()})
        for colour in COLOURS
    }
    return Claim("Fig. 5: bilinear laws", rows, figures)


def _crossover(colour: str) -> Iterator[Row]:
    """Compare the measured crossover load with that of the predicted law."""
    (measured, error), value = paper()["fig5"][colour]["measured_crossover_mm2"], _intersection(colour)
    yield reported(f"{colour}: crossover load of the predicted law [mm²]", value, PREDICTED)
    name = f"{colour}: measured crossover load minus the predicted one, over its printed error"
    words = f"the printed error of the measured load, {error} mm²: half the distance of two loads"
    yield reported(name, (measured - value) / error, words)


def _densities(colour: str) -> list[Row]:
    """Check that the density has the printed targets."""
    design = fig5(colour)
    slopes = design.density.asymptotic_slopes(RADIUS)
    crossover = design.density.crossover_load(design.surface.count, RADIUS)
    targets = *paper()["fig5"]["slopes"], paper()["fig5"][colour]["crossover_load_mm2"]
    names = "slope m_1", "slope m_2", "crossover load [mm²]"
    return [
        near(f"{colour}: {name} of the density", value, target, 1e-9, TARGETS)
        for name, value, target in zip(names, (*slopes, crossover), targets, strict=True)
    ]


def _asperities(colour: str) -> Iterator[Row]:
    """Check the law of 64 asperities by the second method, and report its deviations from the targets."""
    design, height = fig5(colour), heights(colour)
    modulus = design.surface.material.composite_modulus
    for i, (branch, fit) in enumerate(design.fits):
        expected = float(fitted_slope(height, branch.load, RADIUS))
        source = second_method(fitted_slope, f"line through the law by Newton's method; {HEIGHTS}")
        name = f"{colour}: fitted slope {i + 1}"
        yield near(f"{name} of 64 asperities", fit.slope, expected, METHODS * expected, source)
        yield _deviation(f"{name}, deviation from the target [%]", colour, i)
    crossover = design.parameters["crossover_height"]
    load = mf.equilibrium(design.surface, separation=crossover).load / modulus
    expected = float(sums(height - solved(colour)[2], RADIUS)[1])
    yield near(
              f"{colour}: load of 64 asperities at the crossover height [mm²]", load, expected,
              METHODS * expected, second_method(sums, f"sum of Hertz's loads; {HEIGHTS}"),
    )  # fmt: skip


def _deviation(name: str, colour: str, i: int) -> Row:
    """Compare the deviation of a fitted slope from its target with that of the measured slopes."""
    branch, fit = fig5(colour).fits[i]
    value, most = 1e2 * (fit.slope / branch.slope - 1.0), 1e2 * paper()["fig5"]["measured_within"]
    if (colour, i) != ("red", 1):
        return reported(name, value, PREDICTED)
    stated = f"the measured slopes match the target slopes to better than {most:g} %"
    return Difference(name, value, stated, SLOPE, SLOPES, Reason.AMBIGUOUS)


def _intersection(colour: str) -> float:
    """Load [mm²] at which the lines fitted to the two branches of the predicted law intersect."""
    (_, first), (_, second) = fig5(colour).fits
    return (second.intercept - first.intercept) / (first.slope - second.slope)


def _figure(colour: str):
    """{surface} surface, with the axes of the other one. Left: predicted rescaled friction F/(σB) over
    rescaled load P/E* [mm²] with the law of the continuous density and lines of the target slopes. Vertical
    lines are the target crossover load (dotted) and the predicted one (solid); the band is the measured one,
    with its error. Right: slopes of both laws over the load; the target slopes (dashed) lie in bands of 5.2
    %, within which the measured slopes agree with them. The slope of the density changes at the crossover,
    that of 64 asperities jumps at each new contact; thick lines are its fits.
    """
    design, numbers = fig5(colour), paper()["fig5"]
    designs = {f"Fig. 5 {each}": fig5(each) for each in COLOURS}
    figure, left, right = law_and_slopes(f"Fig. 5 {colour}", designs)
    for ax in (left, right):
        ax.axvline(_intersection(colour), color=INKS[f"Fig. 5 {colour}"], lw=1.2, label="predicted crossover")
        label = "measured crossover" if ax is left else None
        load_band(ax, *numbers[colour]["measured_crossover_mm2"], label)
    right.axvline(design.target.crossover_load, color=MEASURED, ls=":", lw=1.2)
    for i, (branch, _) in enumerate(design.fits):
        label = "measured slopes within 5.2 %" if i == 0 else None
        slope_band(right, branch.load_range, branch.slope, numbers["measured_within"] * branch.slope, label)
    left.legend(frameon=False, loc="upper left", fontsize=8)
    right.legend(frameon=False, loc="lower right", fontsize=8)
    return figure
