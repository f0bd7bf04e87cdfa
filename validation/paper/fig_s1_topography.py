"""Fig. S1: the topography for three operating points, three levels with an adjustment asperity each."""

from __future__ import annotations

from functools import cache

import numpy as np

from metafem.drawing import QUIET, new_figure
from validation.check import Check, Claim, Picture, Result, near, reported
from validation.methods import contact_equations, level_equations
from validation.paper.surfaces import fig3
from validation.published import paper
from validation.sources import known_input, printed, second_method

# Colours of the levels in the paper.
COLOURS = ("tab:green", "tab:blue", "tab:red")

# Half of the last printed digit of loads and frictions [mm²], and of heights.
LOAD_DIGIT, FRICTION_DIGIT, HEIGHT_DIGIT_UM = 5e-4, 5e-3, 0.05

# The design and bisection solve the same equations to 1e-10 of a height [µm].
SOLVED_UM = 1e-6

SKETCH = printed("Fig. S1 caption, N = n1 + n2 + n3 + 3")
SCHEME = printed("SM, inversion scheme for operating points")
TARGETS = printed("SM, inversion scheme for operating points, targets of Fig. 3")
SECOND = second_method(level_equations.levels, "eq. S1 solved point by point with numpy")
ROUND_TRIP = known_input("the printed heights, whose law gives the operating points")
ROUNDED = "eq. S1 for the printed points; points that round to them give the printed heights"
PLANE = second_method(contact_equations.independent, "plane at the operating point by bisection of eq. S1")


def claim() -> Claim:
    """Solve eq. S1 twice for the printed points, and once for the points of the printed heights."""
    text = (
        "Each operating point is reached by one level of equal heights and one adjustment asperity. The "
        "numbers of asperities that follow from the printed points are the printed ones; the heights are "
        "not, by up to 8 µm. The reason is rounding: the printed heights belong to points that round to the "
        "printed ones, and eq. S1 for those points gives the printed heights back. The last adjustment "
        "height, which must make up for all differences of the last point, is the most sensitive."
    )
    caption = (
        "Side view of the 58 asperities, sorted by height and magnified vertically, in the colours of Fig. "
        "S1. The last asperity of each colour is the adjustment asperity. Dashed lines: planes at the "
        "operating points; the first two touch the summits of the next level."
    )
    return Claim(
        "Fig. S1: topography for three operating points",
        [*_counts(), *_heights(), *_printed_heights()],
        {"topography": Picture(_sketch, caption)},
        text,
    )


@cache
def solved() -> level_equations.Levels:
    """Return the solution of eq. S1 for the printed points."""
    points = paper()["fig3"]
    return level_equations.levels(
        points["load_mm2"], points["friction_mm2"], points["max_height_um"] / 1e3, _radius()
    )


def _radius() -> float:
    return paper()["sample"]["radius_um"] / 1e3


def _counts() -> list[Check]:
    design, counts = fig3(), paper()["fig3"]["counts"]
    return [
        near("number of asperities N", design.surface.count, sum(counts) + len(counts), 0, SKETCH),
        *(near(f"n_{i + 1}", design.parameters["counts"][i], counts[i], 0, SCHEME) for i in range(3)),
    ]


def _heights() -> list[Check | Result]:
    """Compare the design with eq. S1 by the second method, and with the printed heights."""
    design, points, second = fig3(), paper()["fig3"], solved()
    levels, added = (1e3 * design.parameters[name] for name in ("levels", "adjustment_heights"))
    rows: list[Check | Result] = []
    for i in range(3):
        for name, value, expected, published in (
            (f"h_{i + 1} [µm]", levels[i], second.level[i], points["levels_um"][i]),
            (f"h_{i + 1},a [µm]", added[i], second.adjustment[i], points["adjustment_um"][i]),
        ):
            if name == "h_1 [µm]":
                continue  # the tallest height, which is put in
            rows += [
                near(name, value, 1e3 * expected, SOLVED_UM, SECOND),
                reported(f"{name}: difference from the printed {published} µm", value - published, ROUNDED),
            ]
    for i in range(2):
        load = points["load_mm2"][i]
        height = design.surface.height[design.surface.height > 1e-3 * levels[i + 1] + 1e-3 * SOLVED_UM]
        plane = contact_equations.independent(height, _radius(), load)[1]
        name = f"h_{i + 2} and the plane at operating point {i + 1}: difference [µm]"
        rows.append(near(name, levels[i + 1] - 1e3 * plane, 0.0, SOLVED_UM, PLANE))
    return rows


def _printed_heights() -> list[Check]:
    """Return to the printed heights from the points through which their law passes."""
    points = paper()["fig3"]
    tops, added = np.array(points["levels_um"]) / 1e3, np.array(points["adjustment_um"]) / 1e3
    height = np.concatenate([np.repeat(tops, points["counts"]), added])
    # the plane at the first two points touches the next level; the last point has the least load that
    # rounds to the printed one
    last = contact_equations.independent(height, _radius(), points["load_mm2"][-1] - LOAD_DIGIT)[1]
    depths = [height - plane for plane in (*tops[1:], last)]
    load = [float(contact_equations.loads(depth, _radius()).sum()) for depth in depths]
    friction = [contact_equations.area(depth, _radius()) for depth in depths]
    again = level_equations.levels(load, friction, float(tops[0]), _radius())
    rounding = 1.0 + 1e-9  # the last load stands at the edge of its interval
    rows = []
    for i in range(3):
        which = f"operating point {i + 1} of the printed heights"
        rows += [
            near(f"{which}: P/E* [mm²]", load[i], points["load_mm2"][i], rounding * LOAD_DIGIT, TARGETS),
            near(f"{which}: F/σB [mm²]", friction[i], points["friction_mm2"][i], FRICTION_DIGIT, TARGETS),
            near(f"{which}: n_{i + 1}", again.count[i], points["counts"][i], 0, ROUND_TRIP),
            near(f"{which}: h_{i + 1},a [µm]", 1e3 * again.adjustment[i], points["adjustment_um"][i],
                 HEIGHT_DIGIT_UM, ROUND_TRIP),
        ]  # fmt: skip
    return rows


def _sketch():
    design = fig3()
    levels, added = (1e3 * design.parameters[name] for name in ("levels", "adjustment_heights"))
    figure = new_figure(9.0, 3.6)
    ax = figure.add_subplot()
    start, pitch = 0.0, 1.1
    for i, colour in enumerate(COLOURS):
        count = int(design.parameters["counts"][i])
        centres = start + pitch * np.arange(count + 1)
        for j, centre in enumerate(centres):
            height = levels[i] if j < count else added[i]
            _cap(ax, centre, height / 1e3, colour, dark=j == count)
        ax.annotate(
            f"{count} × $h_{i + 1}$", (centres[:-1].mean(), levels[i] + 7.0), ha="center", color=colour
        )
        ax.annotate(f"$h_{{{i + 1},a}}$", (centres[-1] + 0.4, added[i] - 16.0), color=colour)
        start = centres[-1] + 3.0 * pitch
    for i, plane in enumerate(1e3 * solved().plane):
        ax.axhline(plane, color=QUIET, ls="--", lw=0.8)
        ax.annotate(f"plane at point {i + 1}", (start + 10.0, plane + 2.0), ha="right", fontsize=8)
    ax.set(ylim=(0.0, 310.0), xlim=(-pitch, start + 10.0), xticks=[], ylabel="height [µm]")
    ax.spines[["top", "right"]].set_visible(False)
    return figure


def _cap(ax, centre: float, height: float, colour: str, *, dark: bool) -> None:
    """Draw the cap of a sphere above the base plane."""
    radius = _radius()
    foot = np.sqrt(height * (2.0 * radius - height))
    x = foot * np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 31))
    profile = 1e3 * (np.sqrt(radius**2 - x**2) - (radius - height))
    ax.fill_between(centre + x, 0.0, profile, color=colour, alpha=0.95 if dark else 0.45, lw=0.0)
