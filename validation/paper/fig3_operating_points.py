"""Fig. 3: a law through three operating points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import metafem as mf
from metafem.drawing import MEASURED, MEASURED_BESIDE
from metafem.report.figures import law_figure
from validation.check import Check, Claim, Difference, Picture, Reason, below, near
from validation.methods.level_equations import Levels, levels
from validation.paper.surfaces import RADIUS, fig3, template
from validation.published import paper
from validation.sources import known_input, printed, second_method

# Half of the last printed digit of the points [mm²] and of the heights [µm].
LOAD_DIGIT, FRICTION_DIGIT, HEIGHT_DIGIT = 5e-4, 5e-3, 0.05

# Accuracy of the solvers of both methods, with a margin [µm].
METHODS = 1e-6

# Loads that round to the printed one, of which that of the nearest point is taken.
ROUNDING = LOAD_DIGIT * np.linspace(-1.0, 1.0, 41)

SCHEME = "SM, inversion scheme for operating points"
SOLVED = second_method(levels, "eq. S1 for the printed points, by Brent's method")
AGAIN = known_input("the printed heights, from whose law these points follow")


ROUNDED = """The printed points have three digits. Other points that round to the same digits lead to all of
the printed heights, see the checks."""


def claim() -> Claim:
    """The surface is designed so that its law passes through the three printed points: a level of equal
    heights and one adjustment asperity for each point, as independent Hertz contacts. The design's counts are
    the printed ones; its heights differ from the printed ones, because the points are printed with three
    digits.

    That rounding is the reason follows from the printed heights themselves. With the plane at the next
    printed level, their law has a load and an area that round to the printed point, and a design for the
    points that are found in this way has the printed heights. The paper prints no data points.
    """
    rows = [*_designed(), *points_of_printed_heights(), *_designed_again(), *_differing()]
    return Claim("Fig. 3: three operating points", rows, {"Law through the points": Picture(_figure)})


def heights() -> dict[str, float]:
    """Return the printed heights by their symbols [µm]: levels, then adjustment asperities."""
    numbers = paper()["fig3"]
    named = {f"h_{i + 1}": height for i, height in enumerate(numbers["levels_um"])}
    return named | {f"h_{i + 1},a": height for i, height in enumerate(numbers["adjustment_um"])}


def second() -> Levels:
    """Solve eq. S1 by the second method for the printed points."""
    numbers = paper()["fig3"]
    return levels(numbers["load_mm2"], numbers["friction_mm2"], numbers["max_height_um"] / 1e3, RADIUS)


def _designed() -> Iterator[Check]:
    """Compare the design for the printed points with the printed counts and with the second method."""
    design, numbers, solved = fig3(), paper()["fig3"], second()
    targets = known_input("the operating points, targets of the design; their values are printed in the SM")
    yield below("largest relative error at the points", design.misfit, 1e-9, targets)
    for i, count in enumerate(numbers["counts"]):
        source = printed(SCHEME, f"Fig. 3, n_{i + 1}")
        yield near(f"n_{i + 1}", design.parameters["counts"][i], count, 0, source)
    other = [*solved.level[1:], *solved.adjustment]
    for name, value, expected in zip(list(heights())[1:], _of_design(), other, strict=True):
        yield near(f"{name} [µm]", value, 1e3 * expected, METHODS, SOLVED)


def _of_design() -> list[float]:
    """Return the heights of the design without the tallest, which is put in, as they are printed [µm]."""
    found = fig3().parameters
    return [float(1e3 * height) for height in (*found["levels"][1:], *found["adjustment_heights"])]


def _differing() -> list[Difference]:
    """Return the printed heights that the printed points do not give."""
    return [
        Difference(f"{name} for the printed points [µm]", value, f"{name} = {height} µm", ROUNDED,
                   printed(SCHEME), Reason.AMBIGUOUS)
        for (name, height), value in zip(list(heights().items())[1:], _of_design(), strict=True)
    ]  # fmt: skip


def printed_surface() -> mf.Surface:
    """Return a surface of the printed heights; independent asperities do not depend on their sites."""
    counts, lattice = paper()["fig3"]["counts"], template("fig3")
    tops, added = list(heights().values())[:3], list(heights().values())[3:]
    height = np.append(np.repeat(tops, counts), added)
    count = len(height)
    kept = {"position": lattice.position[:count], "radius": lattice.radius[:count]}
    return lattice.replaced(height=height / 1e3, **kept)


def points(surface: mf.Surface) -> list[mf.ContactState]:
    """Return the contacts at the operating points of a surface of three levels.

    The plane is at the next level. Below the last one it is where load and area are nearest to the printed
    point, in units of their digits, among the loads that round to the printed one.
    """
    numbers, modulus = paper()["fig3"], surface.material.composite_modulus
    tops = surface.height[np.cumsum([0, *numbers["counts"][:-1]])]
    found = [mf.equilibrium(surface, separation=float(top)) for top in tops[1:]]
    load = modulus * (numbers["load_mm2"][-1] + ROUNDING)
    off = np.abs(mf.friction_law(surface, load=load).area - numbers["friction_mm2"][-1]) / FRICTION_DIGIT
    nearest = int(np.argmin(np.maximum(off, np.abs(ROUNDING) / LOAD_DIGIT)))
    return [*found, mf.equilibrium(surface, load=float(load[nearest]))]


def points_of_printed_heights() -> Iterator[Check]:
    """Check that the law of the printed heights passes through the printed points where it has to."""
    numbers, surface = paper()["fig3"], printed_surface()
    # the load of the last point is chosen
    for i, state in enumerate(points(surface)[:-1]):
        name, load = f"operating point {i + 1}", state.load / surface.material.composite_modulus
        for symbol, value, exact, digit in (
            ("P/E*", load, numbers["load_mm2"][i], LOAD_DIGIT),
            ("F/(σB)", state.area, numbers["friction_mm2"][i], FRICTION_DIGIT),
        ):
            source = printed(SCHEME, f"Fig. 3, {symbol} of {name}")
            yield near(f"{name} of the printed heights: {symbol} [mm²]", value, exact, digit, source)


def _designed_again() -> Iterator[Check]:
    """Return from the points of the printed heights to the heights."""
    surface, numbers = printed_surface(), paper()["fig3"]
    found = points(surface)
    modulus = surface.material.composite_modulus
    target = mf.OperatingPoints([state.load / modulus for state in found], [state.area for state in found])
    design = mf.design(target, template("fig3"), limits=mf.Limits(float(surface.height.max())))
    other = not np.array_equal(design.parameters["counts"], numbers["counts"])
    yield near("these points: numbers of asperities that differ", other, 0, 0, AGAIN)
    if not other:
        difference = np.abs(np.sort(design.surface.height) - np.sort(surface.height)).max()
        yield below("these points: largest difference of the designed heights from the printed ones [µm]",
                    1e3 * difference, HEIGHT_DIGIT, AGAIN)  # fmt: skip


def _figure():
    """Upper panel: predicted rescaled friction F/(σB) over rescaled load P/E* [mm²] of the design (solid) and
    of the printed heights (dashed, on the solid line), through the three printed points. The bars are the
    largest deviations of the measured forces that the paper states: 2.5 % at the first two points, 5 % at the
    third. Lower panel: the law meets the points without an error.
    """
    figure, numbers = law_figure(fig3()), paper()["fig3"]
    ax, law = figure.axes[0], mf.friction_law(printed_surface())
    limit = ax.get_xlim()
    ax.plot(law.rescaled_load, law.area, "--", color=MEASURED, lw=1.0, label="printed heights")
    friction = np.array(numbers["friction_mm2"])
    ax.errorbar(
        numbers["load_mm2"], friction, friction * numbers["measured_within"], fmt="none", capsize=4,
        color=MEASURED_BESIDE, lw=1.4, label="measured forces lie within", zorder=4,
    )  # fmt: skip
    ax.set_xlim(limit)
    ax.legend(frameon=False, loc="upper left")
    return figure
