"""Table S1: numbers of asperities on the height levels of the two linear laws."""

from __future__ import annotations

import numpy as np

from metafem.drawing import ACHIEVED
from validation.check import Claim, Difference, Picture, Reason, Row, near
from validation.figures import panels
from validation.methods.densities import expected_counts, scale_of_slope
from validation.paper.surfaces import RADIUS, fig4
from validation.published import paper, table
from validation.sources import printed, second_method

PRINTED = "Table S1"
RULE = printed("SM, building a quasi-linear friction law")

# Accuracy of the quadrature, with a margin [µm].
METHODS = 1e-6

WORDS = """The closest integers add up to {total:.0f} on the blue surface. Table S1 has one asperity less
than the closest integer at {level:g} µm, where the expectation is {expected:.2f}. Of all numbers this one,
changed by one, has the smallest difference from its expectation, relative to it. The design changes numbers
by that rule until the sum is N."""


def claim() -> Claim:
    """The surfaces of Fig. 4 are designed from their target slopes 9.43 and 6.87, with the tallest height h_m
    and the step of 6 µm that the paper prints. The scale λ of the density solves eqs. S3 to S5, and each
    level receives the whole number of asperities nearest to its expectation, changed by one on one level if
    the sum is not 64. All 33 printed numbers up to h_m are reproduced.
    """
    numbers, parameters = table("table_s1"), paper()["fig4"]
    rows: list[Row] = []
    for colour in ("blue", "red"):
        design = fig4(colour)
        counts = np.zeros_like(numbers["height"])
        levels = (design.parameters["levels"] - design.limits.offset) * 1e3
        counts[np.searchsorted(numbers["height"], levels - 1.0)] = design.parameters["counts"]
        wrong = np.count_nonzero(counts != numbers[f"count_{colour}"])
        scale, solved = design.parameters["scale"] * 1e3, 1e3 * _scale(colour)
        rows += [
            near(f"{colour}: levels with another number of asperities", wrong, 0, 0,
                 printed(PRINTED, f"numbers of asperities on the levels, {colour}")),
            near(f"{colour}: scale λ [µm]", scale, parameters[colour]["scale_um"], 0.5,
                 printed(PRINTED, f"scale λ, {colour}")),
            near(
                f"{colour}: scale λ, all digits [µm]", scale, solved, METHODS,
                second_method(scale_of_slope, "eq. S7 with the slope of the density by quadrature"),
            ),
        ]  # fmt: skip
    rounded = np.rint(_expected("blue"))
    level = int(np.flatnonzero(rounded != numbers["count_blue"][: len(rounded)])[0])
    name = "blue: asperities with the closest integer on each level"
    rule = "N = 64, with the closest integer to the expectation on each level"
    found = {"total": rounded.sum(), "level": numbers["height"][level], "expected": _expected("blue")[level]}
    words = WORDS.format(**found)
    rows.append(Difference(name, float(rounded.sum()), rule, words, RULE, Reason.MISPRINTED))
    figures = {"Asperities on each level": Picture(_figure)}
    return Claim("Table S1: levels of the linear laws", rows, figures)


def _scale(colour: str) -> float:
    """Scale λ of the target slope by the second method [mm]."""
    numbers = paper()["fig4"][colour]
    return scale_of_slope(numbers["target_slope"], numbers["max_height_um"] / 1e3, RADIUS)


def _expected(colour: str) -> np.ndarray:
    """Expected numbers on the levels by the second method."""
    numbers = paper()["fig4"]
    top = numbers[colour]["max_height_um"] / 1e3
    return expected_counts(_scale(colour), top, numbers["level_step_um"] / 1e3, numbers["asperities"])


@panels(7.0, 3.2, columns=2, sharey=True)
def _figure(*axes):
    """Numbers of asperities on each height level [µm]: bars are the designs, short marks the numbers of Table
    S1, and the thin line is the expectation of the continuous density at each level. Every mark lies on the
    end of its bar.
    """
    for ax, colour in zip(axes, ("blue", "red"), strict=True):
        design, numbers = fig4(colour), table("table_s1")
        levels = (design.parameters["levels"] - design.limits.offset) * 1e3
        style = {"width": 5.0, "color": f"tab:{colour}", "alpha": 0.5}
        ax.bar(levels, design.parameters["counts"], **style, label="designed")
        expected = _expected(colour)
        ax.plot(numbers["height"][: len(expected)], expected, color=ACHIEVED, lw=0.8, label="expectation")
        ax.plot(numbers["height"], numbers[f"count_{colour}"], "k_", ms=8, label="Table S1")
        ax.set(xlabel="height above the offset [µm]", title=f"{colour.capitalize()} surface")
    axes[0].set_ylabel("asperities")
