"""Fig. S1: the topography for three operating points, three levels with an adjustment asperity each."""

from __future__ import annotations

import numpy as np

from metafem.drawing import QUIET
from validation.check import Check, Claim, Picture, near
from validation.figures import panels
from validation.methods import contact_equations
from validation.paper.fig3_operating_points import METHODS, second
from validation.paper.pictures import LEVELS
from validation.paper.surfaces import RADIUS, fig3
from validation.published import paper
from validation.sources import known_input, second_method

SKETCH = known_input("N = n1 + n2 + n3 + 3 of the Fig. S1 caption, with the printed n1 to n3")
PLANE = second_method(contact_equations.independent, "plane at the operating point by bisection of eq. S1")


def claim() -> Claim:
    """Each operating point is reached by one level of equal heights and one adjustment asperity. The plane at
    an operating point touches the asperities of the next level, so that the law continues with all of them.
    The heights themselves are compared with the printed ones in the claim of Fig. 3.
    """
    design, numbers = fig3(), paper()["fig3"]
    total = sum(numbers["counts"]) + len(numbers["counts"])
    rows = [near("number of asperities N", design.surface.count, total, 0, SKETCH), *_planes()]
    title = "Fig. S1: topography for three operating points"
    return Claim(title, rows, {"topography": Picture(_sketch)})


def _planes() -> list[Check]:
    """Compare each level with the plane at the point before, of the asperities above it."""
    design, rows = fig3(), []
    levels = design.parameters["levels"]
    for i, load in enumerate(paper()["fig3"]["load_mm2"][:-1]):
        height = design.surface.height[design.surface.height > levels[i + 1] + 1e-3 * METHODS]
        plane = contact_equations.independent(height, RADIUS, load).separation
        name = f"h_{i + 2} and the plane at operating point {i + 1}: difference [µm]"
        rows.append(near(name, 1e3 * (levels[i + 1] - plane), 0.0, METHODS, PLANE))
    return rows


@panels(9.0, 3.6)
def _sketch(ax):
    """Side view of the 58 asperities, sorted by height and magnified vertically, in the colours of Fig. S1.
    The last asperity of each colour is the adjustment asperity. Dashed lines: planes at the operating points;
    the first two touch the asperities of the next level.
    """
    design = fig3()
    levels, added = (1e3 * design.parameters[name] for name in ("levels", "adjustment_heights"))
    start, pitch = 0.0, 1.1
    for i, colour in enumerate(LEVELS):
        count = int(design.parameters["counts"][i])
        centres = start + pitch * np.arange(count + 1)
        for j, centre in enumerate(centres):
            height = levels[i] if j < count else added[i]
            _cap(ax, centre, height / 1e3, colour, dark=j == count)
        place = centres[:-1].mean(), levels[i] + 7.0
        ax.annotate(f"{count} × $h_{i + 1}$", place, ha="center", color=colour)
        ax.annotate(f"$h_{{{i + 1},a}}$", (centres[-1] + 0.4, added[i] - 16.0), color=colour)
        start = centres[-1] + 3.0 * pitch
    for i, plane in enumerate(1e3 * second().plane):
        ax.axhline(plane, color=QUIET, ls="--", lw=0.8)
        ax.annotate(f"plane at point {i + 1}", (start + 10.0, plane + 2.0), ha="right", fontsize=8)
    ax.set(ylim=(0.0, 310.0), xlim=(-pitch, start + 10.0), xticks=[], ylabel="height [µm]")


def _cap(ax, centre: float, height: float, colour: str, *, dark: bool) -> None:
    """Draw the cap of a sphere above the base plane."""
    foot = np.sqrt(height * (2.0 * RADIUS - height))
    x = foot * np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 31))
    profile = 1e3 * (np.sqrt(RADIUS**2 - x**2) - (RADIUS - height))
    ax.fill_between(centre + x, 0.0, profile, color=colour, alpha=0.95 if dark else 0.45, lw=0.0)
