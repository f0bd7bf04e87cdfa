"""Table S2: the heights of the two bilinear laws."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np

from validation.check import Claim, Difference, Picture, Reason, Row, below, near
from validation.figures import panels
from validation.methods.densities import interval_middles, share_above, two_branches
from validation.paper.surfaces import RADIUS, fig5
from validation.published import paper, table
from validation.sources import printed, second_method

# Half of the last printed digit of the heights [µm], of the slopes, and of the crossover loads [mm²].
HEIGHT_DIGIT, SLOPE_DIGIT, LOAD_DIGIT = 0.05, 0.005, 5e-5

# Accuracy of the solvers of both methods, with a margin, relative.
METHODS = 1e-6

COLOURS = ("red", "blue")

RULE = printed("SM, building a bilinear friction law")

OUTSIDE = """The difference is systematic: all heights outside lie below the crossover height and are printed
higher than computed. The paper does not print with which digits it computed scale and crossover height."""

WORDS = """Intervals of that mass, laid upwards from the foot of each branch, do not end at the top of the
branch, because 64 times the mass of a branch is not a whole number. The heights of Table S2 are the middles
of N1 and N2 intervals of equal mass that fill their branches. The design does the same."""


def claim() -> Claim:
    """Both surfaces of Fig. 5 are designed from their two slopes (7.15 and 12.52) and crossover loads, with
    the tallest height of 120 µm and the offset of 50 µm that the paper prints. The scale λ, the weight u and
    the crossover height h_c solve eqs. S7 and S8; they are computed a second time with the densities
    integrated by quadrature. The heights stand in the middles of intervals of equal mass. Each printed height
    is compared with an allowance of its own: half of its last digit, and the largest change of that height if
    each printed target changes by half of its last digit. The heights outside it are a difference.
    """
    rows: list[Row] = []
    for colour in COLOURS:
        design = fig5(colour)
        found, (scale, weight, crossover) = design.parameters, solved(colour)
        height = (found["crossover_height"] - design.limits.offset) * 1e3
        source = second_method(two_branches, "eqs. S7 and S8 with the integrals by quadrature")
        upper = round(64 * share(colour))
        words = f"nearest integer to 64 × {share(colour):.5f}, the mass above the crossover"
        mass = second_method(share_above, words)
        rows += [
            below(
                f"{colour}: largest difference of 64 heights [µm]", _difference(design, colour).max(),
                allowance(colour).max(), printed("Table S2", f"heights, {colour}"),
            ),
            _outside(design, colour),
            near(f"{colour}: weight u", found["weight"], weight, METHODS * weight, source),
            near(f"{colour}: crossover height [µm]", height, 1e3 * crossover, METHODS * height, source),
            near(f"{colour}: asperities above the crossover", found["counts"][0], upper, 0, mass),
            near(f"{colour}: asperities below the crossover", found["counts"][1], 64 - upper, 0, mass),
            near(f"{colour}: scale λ [µm]", found["scale"] * 1e3, 1e3 * scale, METHODS * 1e3 * scale, source),
            below(
                f"{colour}: largest difference of 64 heights from a second computation [µm]",
                np.abs(np.sort(design.surface.height - design.limits.offset) - heights(colour)).max() * 1e3,
                METHODS * height,
                second_method(interval_middles, "middles of intervals of equal mass of each branch"),
            ),
        ]  # fmt: skip
    rows += [_other_rule(colour) for colour in COLOURS]
    return Claim("Table S2: heights of the bilinear laws", rows, {"Heights": Picture(_figure)})


@cache
def solved(colour: str, digits: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[float, float, float]:
    """Scale [mm], weight and crossover height [mm] by the second method, of targets changed by digits."""
    numbers = paper()["fig5"]
    first, second = (slope + digit for slope, digit in zip(numbers["slopes"], digits[:2], strict=True))
    load, top = numbers[colour]["crossover_load_mm2"] + digits[2], numbers["max_height_um"] / 1e3
    return two_branches((first, second), load, top, 64, RADIUS)


def share(colour: str) -> float:
    """Share of the mass above the crossover height by the second method."""
    return share_above(*solved(colour), paper()["fig5"]["max_height_um"] / 1e3)


def heights(
    colour: str, printed_rule: bool = False, digits: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> np.ndarray:
    """Heights (64,) [mm] by the second method, without the offset, in increasing order.

    The intervals hold equal shares of the mass of their branch or, by the printed rule, of the whole density.
    """
    scale, _, crossover = solved(colour, digits)
    above, top, found = share(colour), paper()["fig5"]["max_height_um"] / 1e3, []
    upper = round(64 * above)
    for count, low, high, mass in ((64 - upper, 0.0, crossover, 1.0 - above), (upper, crossover, top, above)):
        part = 1.0 / (64 * mass) if printed_rule else 1.0 / count
        found.append(interval_middles(scale, low, high, np.full(count, part)))
    return np.concatenate(found)


@cache
def allowance(colour: str) -> np.ndarray:
    """Difference of each height (64,) [µm] that the digits of the printed heights and targets explain."""
    corners = product(*((-digit, digit) for digit in (SLOPE_DIGIT, SLOPE_DIGIT, LOAD_DIGIT)))
    changes = [np.abs(heights(colour, digits=digits) - heights(colour)) for digits in corners]
    return HEIGHT_DIGIT + 1e3 * np.max(changes, axis=0)


def _outside(design, colour: str) -> Difference:
    """Say how many heights differ from the printed ones by more than the digits explain."""
    outside = float(np.count_nonzero(_difference(design, colour) > allowance(colour)))
    name = f"{colour}: heights of Table S2 that differ by more than the digits explain"
    return Difference(
        name, outside, "64 heights in µm with one decimal", OUTSIDE, printed("Table S2"), Reason.AMBIGUOUS
    )


def _other_rule(colour: str) -> Difference:
    miss = np.abs(1e3 * heights(colour, printed_rule=True) + 50.0 - np.sort(table("table_s2")[colour])).max()
    name = f"{colour}: largest difference from Table S2 with intervals of mass 1/(N1 + N2) [µm]"
    rule = "intervals [b_i, b_{i+1}] whose probability is equal to 1/(N1 + N2)"
    return Difference(name, float(miss), rule, WORDS, RULE, Reason.MISPRINTED)


def _difference(design, colour: str) -> np.ndarray:
    return np.abs(np.sort(design.surface.height) * 1e3 - np.sort(table("table_s2")[colour]))


@panels(7.0, 5.0, rows=2, sharex=True, height_ratios=[2, 1])
def _figure(upper, lower):
    """Upper panel: the heights of both designs [µm], from the lowest to the tallest, as lines, and those of
    Table S2 as dots, which cover the lines. Lower panel: their differences [µm] as dots, and as lines what
    the digits explain: half of the last printed digit of the heights plus the effect of the last digits of
    the printed slopes and crossover loads on each height.
    """
    for colour in COLOURS:
        design, rank, ink = fig5(colour), np.arange(1, 65), f"tab:{colour}"
        upper.plot(rank, 1e3 * np.sort(design.surface.height), color=ink, label=f"{colour} design")
        listed = np.sort(table("table_s2")[colour])
        upper.plot(rank, listed, ".", ms=4, color=ink, label=f"{colour}, Table S2")
        lower.plot(rank, _difference(design, colour), ".", color=ink)
        lower.plot(rank, allowance(colour), color=ink, lw=0.8)
    upper.set_ylabel("height with offset [µm]")
    lower.set(xlabel="asperity, by height", ylabel="difference [µm]")
