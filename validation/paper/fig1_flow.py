"""Fig. 1: the design strategy from a friction coefficient to the measured law of the made part, step by step.

Each step starts from what the step before wrote: the specification, the result folder, the table of heights,
the table of the mould, and the table of measured forces.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

import metafem as mf
from metafem import reference
from metafem.drawing import ACHIEVED, MEASURED, TARGET
from validation.check import Check, Claim, Picture, Result, above, below, near, reported
from validation.figures import panels
from validation.methods import independent
from validation.paper.surfaces import RADIUS, friction_of_slope
from validation.published import paper
from validation.scenes.flow import COEFFICIENT, Flow, flow
from validation.sources import closed_form, known_input, second_method

# Standard deviations that separate agreement from an error in a single draw.
SIGMAS = 3.0

# Tables are written with thirteen digits: 1e-13 of 200 µm.
WRITTEN_UM = 1e-10

# Rounding of lengths, loads and areas in sums of 64 terms.
ROUNDING = 1e-10

RESCALED = known_input("target of the flow, m = μ E*/(σB) as in the Fig. 4 caption")
SAMPLE = known_input("sites of the specification, a lattice of 8 × 8 as in the paper")
LEVELS = known_input("steps of the specification, 6 µm as in the paper")
MADE = known_input("three times 0.5 %, the bound that the paper states for the s.d. of the slope at 0.9 µm")
DENSITY = closed_form(reference.slope, "eq. S3, slope of the exponential density")
FORCES = second_method(independent.areas, "σB times the areas of the heights, eq. S1, with numpy")
LINE = second_method(stats.linregress, "Student's quantile times the standard error of the slope, with scipy")
DRAWN = known_input("the draws that the check puts in, and the tilt x tan φ + y tan φ of the paper's SM")
SUMS = second_method(independent.fitted_slope, "line through the law of the heights, eq. S1, with numpy")
KEPT = known_input("the design as it was before saving")
TRUE = known_input("true law of the made part, on which the errors of the forces are drawn")
WITHIN = known_input("manufacturing limits of the specification")
WANTED = known_input("target of this check")


def claim() -> Claim:
    """Fig. 1 of the paper is a flowchart: a target friction law, an inversion that uses a friction model and
    calibrated contacts, a list of heights, a manufactured sample, and a measured law that closes the circle.
    Here it is run for a friction coefficient of {coefficient}, with the paper's material parameters, through
    the files that a user gets. The part and its measurement are simulated with the errors that the paper
    states: 0.9 µm in height, 5 µm in radius, 0.005° in alignment, 5 mN in load, and 1 mN and 1 % in friction
    force.
    """
    found = flow()
    rows = [*_target(found), *_heights(found), *_files(found), *_part(found)]
    title = f"Fig. 1: the flow for a friction coefficient of {COEFFICIENT}"
    return Claim(title, rows, {"flow": Picture(_figure)}, {"coefficient": COEFFICIENT})


def _slope(design: mf.Design) -> float:
    ((branch, _),) = design.fits
    return branch.slope


def _target(found: Flow) -> list[Check | Result]:
    template = found.specification.template
    slope = COEFFICIENT / friction_of_slope(template)
    scale = float(found.design.parameters["scale"])
    height = found.specification.limits.max_height
    return [
        near("1 target: slope m of the rescaled law", _slope(found.design), slope, ROUNDING, RESCALED),
        near("2 inversion: slope of the density with the scale λ",
             reference.slope(scale, RADIUS, height), slope, ROUNDING, DENSITY),
        reported("2 inversion: scale λ [µm]", 1e3 * scale, "mf.design"),
    ]  # fmt: skip


def _heights(found: Flow) -> list[Check]:
    limits, height = found.specification.limits, found.design.surface.height
    step = paper()["fig4"]["level_step_um"]
    # levels stand at the middle of the steps above the offset
    off = (1e3 * (height - limits.offset) / step - 0.5) % 1.0
    top, middles = 1e3 * (limits.offset + limits.max_height), np.arange(len(limits.levels)) + 0.5
    return [
        near("3 heights: number of asperities", len(height), paper()["fig4"]["asperities"], 0, SAMPLE),
        below("3 heights: tallest [µm]", 1e3 * float(height.max()), top, WITHIN),
        above("3 heights: lowest [µm]", 1e3 * float(height.min()), 1e3 * limits.offset, WITHIN),
        below("3 heights: largest difference of a level from the middle of its step [µm]",
              float(np.abs(1e3 * (limits.levels - limits.offset) - step * middles).max()), 1e-9, LEVELS),
        near("3 heights: largest distance from a level [µm]",
             step * float(np.minimum(off, 1.0 - off).max()), 0.0, 1e-9, LEVELS),
    ]  # fmt: skip


def _files(found: Flow) -> list[Check]:
    design, ((branch, fit),) = found.design, found.design.fits
    heights, modulus = design.surface.height, design.surface.material.composite_modulus
    again = mf.friction_law(found.table, load=design.law.load)
    loads = np.linspace(*branch.load_range, 100)
    line = mf.friction_law(found.table, load=modulus * loads)
    found_line = line.fit(branch.load_range)
    slope = found_line.slope
    second = float(independent.fitted_slope(heights, loads, RADIUS))
    worst = np.abs(again.area / design.law.area - 1.0).max()
    factor = friction_of_slope(design.surface)
    force = factor * modulus * independent.areas(heights, design.law.load / modulus, RADIUS)
    return [
        near("files: designs that differ after saving and loading", found.loaded != design, 0, 0, KEPT),
        below("files: largest difference of the heights in heights.csv [µm]",
              1e3 * np.abs(found.table.height - heights).max(), WRITTEN_UM, KEPT),
        below("files: largest difference of depths in mould.csv from the heights [µm]",
              1e3 * np.abs(found.mould - heights).max(), WRITTEN_UM, KEPT),
        below("4 predicted law of heights.csv: largest difference from the design's law",
              worst, ROUNDING, KEPT),
        below("4 predicted law: largest relative difference of the friction force F = σB A0",
              float(np.abs(design.law.friction_force / force - 1.0).max()), ROUNDING, FORCES),
        near("4 predicted law: friction coefficient of the fitted slope", fit.friction_coefficient,
             second * factor, 0.005 * second * factor, SUMS),
        near("4 predicted law: half of the 68 % interval of the slope", found_line.slope_interval[1] - slope,
             *_interval(loads, line.area), LINE),
        near("4 predicted law: fitted slope", slope, second, ROUNDING * second, SUMS),
        near("4 predicted law: fitted slope in the design", fit.slope, second, 0.005 * second, SUMS),
    ]  # fmt: skip


def _part(found: Flow) -> list[Check | Result]:
    ((branch, _),) = found.design.fits
    loads = found.made.material.composite_modulus * np.linspace(*branch.load_range, 100)
    laws = (mf.friction_law(surface, load=loads) for surface in (found.table, found.made))
    designed, made = (law.fit(branch.load_range).slope for law in laws)
    feature, factor = found.feature, friction_of_slope(found.made)
    truth = _line(found.made, found.measured, branch.load_range)
    scatter = paper()["manufacturing"]["slope_sd_below_at_0p9um"]
    moved = 1e3 * (found.made.height - found.table.height)
    return [
        below("5 made part: largest difference of the heights from those that were drawn [µm]",
              float(np.abs(moved - drawn_errors(found.table)).max()), WRITTEN_UM, DRAWN),
        reported("5 made part: s.d. of the errors of the heights [µm]", float(moved.std()),
                 "draw with 0.9 µm, and a tilt of 0.005° about both axes"),
        below(f"5 made part: change of the slope, {SIGMAS:g} s.d.", abs(made / designed - 1.0),
              SIGMAS * scatter, MADE),
        near(f"6 measured law: slope, {SIGMAS:g} s.d.", feature.value, truth, SIGMAS * feature.sd, TRUE),
        near(f"6 measured law: friction coefficient, {SIGMAS:g} s.d.", feature.value * factor, COEFFICIENT,
             SIGMAS * feature.sd * factor, WANTED),
        reported("6 measured law: standard deviation of the friction coefficient", feature.sd * factor,
                 "mf.calibration.compare"),
    ]  # fmt: skip


def _interval(load: np.ndarray, area: np.ndarray) -> tuple[float, float]:
    """Return half of the 68 % interval of the slope of a line, and its rounding."""
    half = float(stats.t.ppf(0.84, len(load) - 2) * stats.linregress(load, area).stderr)
    return half, 1e-8 * half


def drawn_errors(surface: mf.Surface) -> np.ndarray:
    """Return the errors of the heights (n,) [µm] of the made part: the same draws, and the tilt."""
    sample, rng = paper()["sample"], np.random.default_rng(1)
    rng.standard_normal(surface.count)  # of the radii
    scatter = sample["depth_precision_um"] * rng.standard_normal(surface.count)
    tilt = np.tan(np.radians(sample["alignment_precision_deg"]))
    return scatter + 1e3 * tilt * surface.position.sum(axis=1)


def _line(made: mf.Surface, measured: mf.calibration.MeasuredLaw, load_range: tuple[float, float]) -> float:
    """Return the slope of least squares of the made part's true law at the measured loads of a branch."""
    low, high = load_range
    x = measured.rescaled_load
    x = x[(x >= low) & (x <= high)]
    area = mf.friction_law(made, load=made.material.composite_modulus * x).area
    return float(np.polyfit(x, area, 1)[0])


@panels(9.0, 3.2, columns=2)
def _figure(law, measured):
    """4: predicted law and target slope. 6: measured points of the made part, and the line of the target
    slope; the points follow the slope, with the intercept that the paper explains.
    """
    found = flow()
    law.plot(found.design.law.load, found.design.law.friction_force, color=ACHIEVED, label="predicted")
    _draw_slope(law, found.design.law)
    _forces(law, "4 predicted law")
    style = {"fmt": "o", "ms": 3.5, "lw": 0.8, "color": MEASURED, "label": "measured"}
    points = found.measured
    measured.errorbar(points.load, points.friction_force, points.friction_force_sd, points.load_sd, **style)
    _draw_slope(measured, mf.friction_law(found.made))
    _forces(measured, "6 law of the made part")


def _forces(ax, title: str) -> None:
    ax.set(xlabel="load  P [N]", ylabel="friction force  F [N]", xlim=(0.0, 1.0), ylim=(0.0, 1.8))
    ax.set_title(title, fontsize=9)


def _draw_slope(ax, law: mf.FrictionLaw) -> None:
    """Draw a line of the target slope through the middle of a law."""
    middle = float(np.interp(0.45, law.load, law.friction_force))
    ends = np.array([0.1, 0.9])
    ax.plot(ends, middle + COEFFICIENT * (ends - 0.45), color=TARGET, label=f"slope {COEFFICIENT}")
