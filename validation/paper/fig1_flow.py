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
from scipy import stats

import metafem as mf
from metafem import files
from metafem.drawing import ACHIEVED, MEASURED, TARGET
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
    with tempfile.TemporaryDirectory() as name:
        path, result = Path(name, "wanted.toml"), Path(name, "result")
        text = files.demo_text("linear").replace("slope = 6.87 ", f"friction_coefficient = {COEFFICIENT} ")
        path.write_text(text, "utf-8")
        mf.save(mf.read_spec(path).design(), result)
        design = mf.load(result)
        given = design.template.material, None, design.template.friction
        return design, files.read_surface(result / "heights.csv", *given)


@cache
def made() -> tuple[mf.Surface, np.ndarray]:
    """Return a part with the paper's errors, and what was drawn for its heights (n,) [µm]."""
    sample, surface = paper()["sample"], designed()[1]
    angle, rng = np.radians(sample["alignment_precision_deg"]), np.random.default_rng(3)
    radius = surface.radius + 1e-3 * sample["radius_sd_um"] * rng.standard_normal(surface.count)
    perturbed = surface.perturbed(1e-3 * sample["depth_precision_um"], rng=1)
    scatter = sample["depth_precision_um"] * np.random.default_rng(1).standard_normal(surface.count)
    drawn = scatter + 1e3 * np.tan(angle) * surface.position.sum(axis=1)
    return perturbed.replaced(radius=radius).tilted(angle, angle), drawn


@cache
def measured() -> mf.calibration.MeasuredLaw:
    """Write a table of forces with the paper's errors, and read it."""
    error, rng, part = paper()["force_error"], np.random.default_rng(2), made()[0]
    true = mf.friction_law(part, load=FORCES).friction_force
    sd = np.hypot(error["friction_N"], error["friction_relative"] * true)
    load = FORCES + error["normal_N"] * rng.standard_normal(len(FORCES))
    table = np.column_stack([load, true + sd * rng.standard_normal(len(FORCES))])
    with tempfile.TemporaryDirectory() as name:
        path = Path(name, "measured.csv")
        np.savetxt(path, table, "%.17g", ",", header="load_N,friction_force_N", comments="")
        return files.read_measured_law(path, part.material, part.friction)


def _slope(found: mf.calibration.Comparison, ends: tuple[float, float]) -> tuple[float, float]:
    """Return the slope of the measured points between two loads P/E*, and its standard deviation."""
    x, y = found.measured.rescaled_load, found.measured.rescaled_friction
    chosen = (x >= ends[0]) & (x <= ends[1])
    centred = np.where(chosen, x - x[chosen].mean(), 0.0)
    weight = centred / (centred**2).sum()
    return float(weight @ y), float(np.sqrt(weight @ found.covariance @ weight))


def claim() -> Claim:
    """Fig. 1 of the paper is a flowchart: a target friction law, an inversion that uses a friction model and
    calibrated contacts, a list of heights, a manufactured sample, and a measured law that closes the circle.
    Here it is run for a friction coefficient of {coefficient}, with the paper's material parameters, through
    the files that a user gets. The part and its measurement are simulated with the errors that the paper
    states: 0.9 µm in height, 5 µm in radius, 0.005° in alignment, 5 mN in load, and 1 mN and 1 % in friction
    force.
    """
    title = f"Fig. 1: the flow for a friction coefficient of {COEFFICIENT}"
    rows = [*_heights(), *_law(), *_part()]
    return Claim(title, rows, {"flow": Picture(_figure)}, {"coefficient": COEFFICIENT})


def _heights() -> Iterator[Row]:
    """Check the target, and the heights that are read on their steps."""
    design, table = designed()
    slope = COEFFICIENT / friction_of_slope(design.template)
    yield near("1 target: slope m of the rescaled law", design.fits[0][0].slope, slope, ROUNDING, RESCALED)
    # levels stand at the middle of the steps above the offset
    limits, step = design.limits, paper()["fig4"]["level_step_um"]
    middles = 1e3 * limits.offset + step * (np.arange(int(1e3 * limits.max_height / step)) + 0.5)
    off = np.abs(1e3 * table.height[:, None] - middles).min(axis=1).max()
    yield below("2 heights: largest distance from the middle of a step [µm]", float(off), 1e-9, LEVELS)


def _law() -> Iterator[Row]:
    """Compare the predicted law and the line through it with numpy and scipy."""
    design, table = designed()
    branch, modulus = design.fits[0][0], table.material.composite_modulus
    factor, loads = friction_of_slope(table), np.linspace(*branch.load_range, 100)
    law, name = mf.friction_law(table, load=modulus * loads), "3 predicted law"
    force = factor * modulus * independent.areas(table.height, loads, RADIUS)
    worst = float(np.abs(law.friction_force / force - 1.0).max())
    yield below(f"{name}: largest relative difference of the friction force F = σB A0", worst, ROUNDING, SUMS)
    line, second = law.fit(branch.load_range), float(independent.fitted_slope(table.height, loads, RADIUS))
    half = float(stats.t.ppf(0.84, len(loads) - 2) * stats.linregress(loads, law.area).stderr)
    found = line.slope_interval[1] - line.slope
    yield near(f"{name}: half of the 68 % interval of the slope", found, half, 1e-8 * half, LINE)
    yield near(f"{name}: fitted slope", line.slope, second, ROUNDING * second, SUMS)


def _part() -> Iterator[Row]:
    """Compare the made part with its draws, and its measured law with the true one and with the target."""
    design, table = designed()
    (part, drawn), (low, high) = made(), design.fits[0][0].load_range
    worst = float(np.abs(1e3 * (part.height - table.height) - drawn).max())
    words = "largest difference of the heights from those that were drawn [µm]"
    yield below(f"4 made part: {words}", worst, WRITTEN_UM, DRAWN)
    loads = part.material.composite_modulus * np.linspace(low, high, 100)
    before, after = (mf.friction_law(each, load=loads).fit((low, high)).slope for each in (table, part))
    most = SIGMAS * paper()["manufacturing"]["slope_sd_below_at_0p9um"]
    yield below(f"4 made part: change of the slope, {SIGMAS:g} s.d.", abs(after / before - 1.0), most, MADE)
    slope, sd = _slope(mf.calibration.compare(measured(), design), (low, high))
    name, sd, factor = f"5 measured law, {SIGMAS:g} s.d.", SIGMAS * sd, friction_of_slope(part)
    yield near(f"{name}: slope", slope, after, sd, TRUE)
    yield near(f"{name}: friction coefficient", factor * slope, COEFFICIENT, factor * sd, WANTED)


@panels(6.0, 3.6)
def _figure(ax):
    """Predicted law of the designed heights, measured points of the made part with their errors, and a line
    of the target slope; the points follow the slope, with the intercept that the paper explains.
    """
    law, points = designed()[0].law, measured()
    ax.plot(law.load, law.friction_force, color=ACHIEVED, label="predicted")
    style = {"fmt": "o", "color": MEASURED, "label": "measured"}
    ax.errorbar(points.load, points.friction_force, points.friction_force_sd, points.load_sd, **style)
    ends, middle = np.array([0.1, 0.9]), float(np.interp(0.45, law.load, law.friction_force))
    ax.plot(ends, middle + COEFFICIENT * (ends - 0.45), color=TARGET, label=f"slope {COEFFICIENT}")
    ax.set(xlabel="load  P [N]", ylabel="friction force  F [N]", xlim=(0.0, 1.0), ylim=(0.0, 1.8))
