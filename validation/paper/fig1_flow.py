"""Fig. 1: the design strategy from a friction coefficient to the measured law of the made part, step by step.

Each step starts from what the step before wrote: the specification, the result folder, the table of heights,
the table of the mould, and the table of measured forces.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats

import metafem as mf
from metafem import files, reference
from metafem.drawing import ACHIEVED, MEASURED, TARGET
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods import independent
from validation.paper.surfaces import RADIUS, friction_of_slope
from validation.published import paper
from validation.sources import closed_form, known_input, second_method

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
DENSITY = closed_form(reference.slope, "eq. S3, slope of the exponential density")
SUMS = second_method(independent.areas, "law of the heights and lines through it, eq. S1, with numpy")
LINE = second_method(stats.linregress, "Student's quantile times the standard error of the slope, with scipy")
DRAWN = known_input("the draws that the check puts in, and the tilt x tan φ + y tan φ of the paper's SM")
KEPT = known_input("the design as it was before saving")
TRUE = known_input("true law of the made part, on which the errors of the forces are drawn")
WITHIN = known_input("manufacturing limits of the specification")
WANTED = known_input("target of this check")


class Flow(NamedTuple):
    """What each step hands on; mould: depths of the holes, by site [mm]."""

    specification: files.Specification
    design: mf.Design
    loaded: mf.Design
    table: mf.Surface
    mould: np.ndarray
    made: mf.Surface
    measured: mf.calibration.MeasuredLaw
    slope: tuple[float, float]


@cache
def flow() -> Flow:
    """Run all steps in a temporary folder."""
    with tempfile.TemporaryDirectory() as name:
        folder, result = Path(name), Path(name, "result")
        text = files.demo_text("linear").replace("slope = 6.87 ", f"friction_coefficient = {COEFFICIENT} ")
        (folder / "wanted.toml").write_text(text, "utf-8")
        specification = mf.read_spec(folder / "wanted.toml")
        design = specification.design()
        mf.save(design, result, specification=specification)
        loaded = mf.load(result)
        given = {"friction": loaded.template.friction, "block": loaded.template.block}
        table = files.read_surface(result / "heights.csv", loaded.template.material, **given)
        lines = [each for each in (result / "mould.csv").read_text("utf-8").splitlines() if each[0] != "#"]
        rows = np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8")
        holes = np.sort(rows[rows["kind"] == "asperity"], order="site")
        made = _made(table.replaced(height=holes["depth_mm"]))
        measured = _measured(made, folder / "measured.csv")
        slope = _slope(mf.calibration.compare(measured, loaded), design.fits[0][0].load_range)
    return Flow(specification, design, loaded, table, holes["depth_mm"], made, measured, slope)


def _slope(found: mf.calibration.Comparison, ends: tuple[float, float]) -> tuple[float, float]:
    """Return the slope of the measured points between two loads P/E*, and its standard deviation."""
    x, y = found.measured.rescaled_load, found.measured.rescaled_friction
    chosen = (x >= ends[0]) & (x <= ends[1])
    centred = np.where(chosen, x - x[chosen].mean(), 0.0)
    weight = centred / (centred**2).sum()
    return float(weight @ y), float(np.sqrt(weight @ found.covariance @ weight))


def _made(surface: mf.Surface) -> mf.Surface:
    """Return a part with the paper's errors of heights, radii and alignment."""
    sample, rng = paper()["sample"], np.random.default_rng(1)
    angle = np.radians(sample["alignment_precision_deg"])
    radius = surface.radius + 1e-3 * sample["radius_sd_um"] * rng.standard_normal(surface.count)
    perturbed = surface.perturbed(1e-3 * sample["depth_precision_um"], rng)
    return perturbed.replaced(radius=radius).tilted(angle, angle)


def drawn_errors(surface: mf.Surface) -> np.ndarray:
    """Return the errors of the heights (n,) [µm] of the made part: the same draws, and the tilt."""
    sample, rng = paper()["sample"], np.random.default_rng(1)
    rng.standard_normal(surface.count)  # of the radii
    scatter = sample["depth_precision_um"] * rng.standard_normal(surface.count)
    tilt = np.tan(np.radians(sample["alignment_precision_deg"]))
    return scatter + 1e3 * tilt * surface.position.sum(axis=1)


def _measured(made: mf.Surface, path: Path) -> mf.calibration.MeasuredLaw:
    """Write a table of forces with the paper's errors, and read it."""
    error, rng = paper()["force_error"], np.random.default_rng(2)
    true = mf.friction_law(made, load=FORCES).friction_force
    sd = np.hypot(error["friction_N"], error["friction_relative"] * true)
    load = FORCES + error["normal_N"] * rng.standard_normal(len(FORCES))
    force = true + sd * rng.standard_normal(len(FORCES))
    np.savetxt(
        path, np.column_stack([load, force]), "%.17g", ",", header="load_N,friction_force_N", comments=""
    )
    return files.read_measured_law(path, made.material, made.friction)


def claim() -> Claim:
    """Fig. 1 of the paper is a flowchart: a target friction law, an inversion that uses a friction model and
    calibrated contacts, a list of heights, a manufactured sample, and a measured law that closes the circle.
    Here it is run for a friction coefficient of {coefficient}, with the paper's material parameters, through
    the files that a user gets. The part and its measurement are simulated with the errors that the paper
    states: 0.9 µm in height, 5 µm in radius, 0.005° in alignment, 5 mN in load, and 1 mN and 1 % in friction
    force.
    """
    rows = [*_heights(), *_files(), *_law(), *_part()]
    title = f"Fig. 1: the flow for a friction coefficient of {COEFFICIENT}"
    return Claim(title, rows, {"flow": Picture(_figure)}, {"coefficient": COEFFICIENT})


def _heights() -> Iterator[Row]:
    """Check the target, the density and the heights on their steps."""
    design, limits = flow().design, flow().specification.limits
    slope = COEFFICIENT / friction_of_slope(flow().specification.template)
    yield near("1 target: slope m of the rescaled law", design.fits[0][0].slope, slope, ROUNDING, RESCALED)
    density = reference.slope(float(design.parameters["scale"]), RADIUS, limits.max_height)
    yield near("2 inversion: slope of the density with the scale λ", density, slope, ROUNDING, DENSITY)
    height, step = 1e3 * design.surface.height, paper()["fig4"]["level_step_um"]
    top = 1e3 * (limits.offset + limits.max_height)
    yield below("3 heights: tallest [µm]", float(height.max()), top, WITHIN)
    # levels stand at the middle of the steps above the offset
    middles = 1e3 * limits.offset + step * (np.arange(len(limits.levels)) + 0.5)
    off = np.abs(1e3 * limits.levels - middles).max()
    yield below(
        "3 heights: largest difference of a level from the middle of its step [µm]", off, 1e-9, LEVELS
    )
    off = np.abs(height[:, None] - middles).min(axis=1).max()
    yield below("3 heights: largest distance from a level [µm]", float(off), 1e-9, LEVELS)


def _files() -> Iterator[Row]:
    """Compare what is read with what was written."""
    design, heights = flow().design, flow().design.surface.height
    yield near("files: designs that differ after saving and loading", flow().loaded != design, 0, 0, KEPT)
    for name, read in (("heights.csv", flow().table.height), ("mould.csv", flow().mould)):
        worst = 1e3 * np.abs(read - heights).max()
        yield below(f"files: largest difference of {name} from the heights [µm]", worst, WRITTEN_UM, KEPT)
    again = mf.friction_law(flow().table, load=design.law.load)
    worst = np.abs(again.area / design.law.area - 1.0).max()
    yield below(
        "4 predicted law of heights.csv: largest difference from the design's law", worst, ROUNDING, KEPT
    )


def _law() -> Iterator[Row]:
    """Compare the predicted law and the line through it with numpy and scipy."""
    design, ((branch, fit),) = flow().design, flow().design.fits
    heights, modulus = design.surface.height, design.surface.material.composite_modulus
    factor, loads = friction_of_slope(design.surface), np.linspace(*branch.load_range, 100)
    force = factor * modulus * independent.areas(heights, design.law.load / modulus, RADIUS)
    worst = float(np.abs(design.law.friction_force / force - 1.0).max())
    name = "4 predicted law"
    yield below(f"{name}: largest relative difference of the friction force F = σB A0", worst, ROUNDING, SUMS)
    law = mf.friction_law(flow().table, load=modulus * loads)
    line, second = law.fit(branch.load_range), float(independent.fitted_slope(heights, loads, RADIUS))
    half = float(stats.t.ppf(0.84, len(loads) - 2) * stats.linregress(loads, law.area).stderr)
    found, coefficient = line.slope_interval[1] - line.slope, second * factor
    yield near(f"{name}: half of the 68 % interval of the slope", found, half, 1e-8 * half, LINE)
    yield near(f"{name}: fitted slope", line.slope, second, ROUNDING * second, SUMS)
    yield near(f"{name}: fitted slope in the design", fit.slope, second, 0.005 * second, SUMS)
    yield near(f"{name}: friction coefficient of the fitted slope",
               fit.friction_coefficient, coefficient, 0.005 * coefficient, SUMS)  # fmt: skip


def _part() -> Iterator[Row]:
    """Compare the made part with its draws, and its measured law with the true one and with the target."""
    table, made, measured, (slope, sd) = flow().table, flow().made, flow().measured, flow().slope
    (low, high), modulus = flow().design.fits[0][0].load_range, made.material.composite_modulus
    moved = 1e3 * (made.height - table.height)
    worst = float(np.abs(moved - drawn_errors(table)).max())
    words = "largest difference of the heights from those that were drawn [µm]"
    yield below(f"5 made part: {words}", worst, WRITTEN_UM, DRAWN)
    loads = modulus * np.linspace(low, high, 100)
    before, after = (mf.friction_law(each, load=loads).fit((low, high)).slope for each in (table, made))
    scatter = SIGMAS * paper()["manufacturing"]["slope_sd_below_at_0p9um"]
    yield below(
        f"5 made part: change of the slope, {SIGMAS:g} s.d.", abs(after / before - 1.0), scatter, MADE
    )
    x = measured.rescaled_load
    x = x[(x >= low) & (x <= high)]
    truth = float(np.polyfit(x, mf.friction_law(made, load=modulus * x).area, 1)[0])
    factor, name = friction_of_slope(made), "6 measured law"
    yield near(f"{name}: slope, {SIGMAS:g} s.d.", slope, truth, SIGMAS * sd, TRUE)
    error = SIGMAS * sd * factor
    yield near(f"{name}: friction coefficient, {SIGMAS:g} s.d.", slope * factor, COEFFICIENT, error, WANTED)
    words = f"{name}: standard deviation of the friction coefficient"
    yield reported(words, sd * factor, "mf.calibration.compare")


@panels(6.0, 3.6)
def _figure(ax):
    """Predicted law of the designed heights, measured points of the made part with their errors, and a line
    of the target slope; the points follow the slope, with the intercept that the paper explains.
    """
    law, points = flow().design.law, flow().measured
    ax.plot(law.load, law.friction_force, color=ACHIEVED, label="predicted")
    style = {"fmt": "o", "ms": 3.5, "lw": 0.8, "color": MEASURED, "label": "measured"}
    ax.errorbar(points.load, points.friction_force, points.friction_force_sd, points.load_sd, **style)
    ends, middle = np.array([0.1, 0.9]), float(np.interp(0.45, law.load, law.friction_force))
    ax.plot(ends, middle + COEFFICIENT * (ends - 0.45), color=TARGET, label=f"slope {COEFFICIENT}")
    ax.set(xlabel="load  P [N]", ylabel="friction force  F [N]", xlim=(0.0, 1.0), ylim=(0.0, 1.8))
