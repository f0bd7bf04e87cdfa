"""Fig. 1: the design strategy from a friction coefficient to the measured law of the made part, step by step.

Each step starts from what the step before wrote: the specification, the result folder with its table of
heights, and the table of measured forces.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import stats

import metafem as mf
from metafem import files
from metafem.drawing import MEASURED, TARGET
from validation.check import Claim, Picture, Row, below, near
from validation.figures import panels
from validation.methods import independent
from validation.paper.surfaces import RADIUS, friction_of_slope
from validation.published import paper
from validation.sources import known_input, second_method

# The friction coefficient to be designed, within the bounds of the paper and not one of its own, and loads of
# the measurement [N]: twelve points up to those of the paper's red law.
COEFFICIENT, FORCES = 1.5, np.linspace(0.08, 0.95, 12)

# Standard deviations that separate agreement from an error in a single draw.
SIGMAS = 3.0

# Tables are written with thirteen digits: 1e-13 of 200 µm. Rounding in sums of 64 terms.
WRITTEN_UM, ROUNDING = 1e-10, 1e-10

RESCALED = known_input("target of the flow, m = μ E*/(σB) as in the Fig. 4 caption")
LEVELS = known_input("steps of the specification, 6 µm as in the paper")
MADE = known_input("three times 0.5 %, the bound that the paper states for the s.d. of the slope at 0.9 µm")
SUMS = second_method(independent.areas, "law of the heights and lines through it, eq. S1, with numpy")
LINE = second_method(stats.linregress, "Student's quantile times the standard error of the slope, with scipy")
DRAWN = known_input("the draws that the check puts in, and the tilt x tan φ + y tan φ of the paper's SM")
TRUE = known_input("true law of the made part, on which the errors of the forces are drawn")
WANTED = known_input("target of this check")


@cache
def designed() -> tuple[mf.Design, mf.Surface]:
    """Return the design that is loaded from its result folder, and the surface of its table of heights."""
    text = files.demo_text("linear").replace("slope = 6.87 ", f"friction_coefficient = {COEFFICIENT} ")
    with tempfile.TemporaryDirectory() as name:
        Path(name, "wanted.toml").write_text(text, "utf-8")
        mf.save(mf.read_spec(Path(name, "wanted.toml")).design(), Path(name, "result"))
        design = mf.load(Path(name, "result"))
        given = design.template.material, None, design.template.friction
        return design, files.read_surface(Path(name, "result", "heights.csv"), *given)


@cache
def made() -> tuple[mf.Surface, np.ndarray, mf.calibration.MeasuredLaw]:
    """Return a part with the paper's errors, what was drawn for its heights (n,) [µm], and its measured law.

    The forces have the paper's errors, and are read from a table.
    """
    sample, error, surface = paper()["sample"], paper()["force_error"], designed()[1]
    depth, angle = sample["depth_precision_um"], np.radians(sample["alignment_precision_deg"])
    of_height, of_force, of_radius = map(np.random.default_rng, (1, 2, 3))
    radius = surface.radius + 1e-3 * sample["radius_sd_um"] * of_radius.standard_normal(surface.count)
    part = surface.perturbed(1e-3 * depth, rng=1).replaced(radius=radius).tilted(angle, angle)
    drawn = depth * of_height.standard_normal(surface.count)
    drawn += 1e3 * np.tan(angle) * surface.position.sum(axis=1)
    true = mf.friction_law(part, load=FORCES).friction_force
    load = FORCES + error["normal_N"] * of_force.standard_normal(len(FORCES))
    sd = np.hypot(error["friction_N"], error["friction_relative"] * true)
    table = pd.DataFrame({"load_N": load, "friction_force_N": true + sd * of_force.standard_normal(len(sd))})
    with tempfile.TemporaryDirectory() as name:
        table.to_csv(Path(name, "measured.csv"), index=False)
        law = files.read_measured_law(Path(name, "measured.csv"), part.material, part.friction)
    return part, drawn, law


def claim() -> Claim:
    """Fig. 1 of the paper is a flowchart: a target friction law, an inversion that uses a friction model and
    calibrated contacts, a list of heights, a manufactured sample, and a measured law that closes the circle.
    Here it is run for a friction coefficient of {coefficient}, with the paper's material parameters, through
    the files that a user gets. The part and its measurement are simulated with the errors that the paper
    states: 0.9 µm in height, 5 µm in radius, 0.005° in alignment, 5 mN in load, and 1 mN and 1 % in friction
    force.
    """
    rows, values = list(_steps()), {"coefficient": COEFFICIENT}
    return Claim("Fig. 1: the flow from a target to a measured law", rows, {"flow": Picture(_figure)}, values)


def _steps() -> Iterator[Row]:
    """Check each step by numpy, by scipy, and by what was put in."""
    design, table = designed()
    branch, factor = design.fits[0][0], friction_of_slope(table)
    slope = COEFFICIENT / factor
    yield near("1 target: slope m of the rescaled law", branch.slope, slope, ROUNDING, RESCALED)
    # heights stand in the middles of the steps above the offset
    step = paper()["fig4"]["level_step_um"]
    number = 1e3 * (table.height - design.limits.offset) / step - 0.5
    off = step * np.abs(number - np.rint(number)).max()
    yield below("2 heights: largest distance from the middle of a step [µm]", off, 1e-9, LEVELS)
    modulus, loads = table.material.composite_modulus, np.linspace(*branch.load_range, 100)
    law, name = mf.friction_law(table, load=modulus * loads), "3 predicted law"
    force = factor * modulus * independent.areas(table.height, loads, RADIUS)
    worst = float(np.abs(law.friction_force / force - 1.0).max())
    yield below(f"{name}: largest relative difference of the friction force F = σB A0", worst, ROUNDING, SUMS)
    line, second = law.fit(branch.load_range), float(independent.fitted_slope(table.height, loads, RADIUS))
    half = float(stats.t.ppf(0.84, len(loads) - 2) * stats.linregress(loads, law.area).stderr)
    found = line.slope_interval[1] - line.slope
    yield near(f"{name}: half of the 68 % interval of the slope", found, half, 1e-8 * half, LINE)
    yield near(f"{name}: fitted slope", line.slope, second, ROUNDING * second, SUMS)
    part, drawn, points = made()
    off = np.abs(1e3 * (part.height - table.height) - drawn).max()
    yield below("4 made part: largest difference of the heights from the draws [µm]", off, WRITTEN_UM, DRAWN)
    true = mf.friction_law(part, load=modulus * loads).fit(branch.load_range).slope
    most = SIGMAS * paper()["manufacturing"]["slope_sd_below_at_0p9um"]
    change = abs(true / line.slope - 1.0)
    yield below(f"4 made part: change of the slope, {SIGMAS:g} s.d.", change, most, MADE)
    chosen = np.flatnonzero((points.rescaled_load >= loads[0]) & (points.rescaled_load <= loads[-1]))
    weight = np.linalg.pinv(np.vander(points.rescaled_load[chosen], 2))[0]
    covariance = mf.calibration.compare(points, design).covariance[np.ix_(chosen, chosen)]
    slope, sd = weight @ points.rescaled_friction[chosen], SIGMAS * np.sqrt(weight @ covariance @ weight)
    name = f"5 measured law, {SIGMAS:g} s.d."
    yield near(f"{name}: slope", slope, true, sd, TRUE)
    yield near(f"{name}: friction coefficient", factor * slope, COEFFICIENT, factor * sd, WANTED)


@panels(6.0, 3.6)
def _figure(ax):
    """Predicted law of the designed heights, measured points of the made part with their errors, and a line
    of the target slope; the points follow the slope, with the intercept that the paper explains.
    """
    law, points = designed()[0].law, made()[2]
    law.plot(ax, "N", "predicted")
    errors = points.friction_force_sd, points.load_sd
    ax.errorbar(points.load, points.friction_force, *errors, fmt="o", color=MEASURED, label="measured")
    middle = 0.45, float(np.interp(0.45, law.load, law.friction_force))
    ax.axline(middle, slope=COEFFICIENT, color=TARGET, label=f"slope {COEFFICIENT}")
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.8))
