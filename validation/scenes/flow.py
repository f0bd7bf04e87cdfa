"""The design strategy of Fig. 1 through the files of each step, with the errors of the paper."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import metafem as mf
from metafem import files
from validation.published import paper

# The friction coefficient to be designed, within the bounds of the paper and not one of its own.
COEFFICIENT = 1.5

# Loads of the measurement [N]: twelve points up to those of the paper's red law.
FORCES = np.linspace(0.08, 0.95, 12)


@dataclass(frozen=True)
class Flow:
    """What each step hands on."""

    specification: files.Specification
    design: mf.Design
    loaded: mf.Design
    table: mf.Surface  # read from heights.csv
    mould: np.ndarray  # depths of the holes, by site [mm]
    made: mf.Surface
    measured: mf.calibration.MeasuredLaw  # read from its table
    feature: mf.calibration.Feature  # slope of the measured law


@cache
def flow() -> Flow:
    """Run all steps in a temporary folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = files.demo_text("linear").replace("slope = 6.87 ", f"friction_coefficient = {COEFFICIENT} ")
        (folder / "wanted.toml").write_text(text, "utf-8")
        specification = mf.read_spec(folder / "wanted.toml")
        design = specification.design()
        mf.save(design, folder / "result", specification=specification)
        loaded = mf.load(folder / "result")
        sample = loaded.template
        table = files.read_surface(
            folder / "result" / "heights.csv", sample.material, friction=sample.friction, block=sample.block
        )
        mould = _mould(folder / "result" / "mould.csv")
        made = _made(table.replaced(height=mould))
        measured = _measured(made, folder / "measured.csv")
        (feature,) = mf.calibration.compare(measured, loaded).features
    return Flow(specification, design, loaded, table, mould, made, measured, feature)


def _mould(path: Path) -> np.ndarray:
    """Return the depths of the holes for asperities [mm], in the order of their sites."""
    lines = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
    rows = np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8")
    asperities = rows[rows["kind"] == "asperity"]
    return np.asarray(asperities["depth_mm"][np.argsort(asperities["site"])])


def _made(surface: mf.Surface) -> mf.Surface:
    """Return a part with the paper's errors of heights, radii and alignment."""
    sample, rng = paper()["sample"], np.random.default_rng(1)
    angle = np.radians(sample["alignment_precision_deg"])
    radius = surface.radius + 1e-3 * sample["radius_sd_um"] * rng.standard_normal(surface.count)
    perturbed = surface.perturbed(1e-3 * sample["depth_precision_um"], rng)
    return perturbed.replaced(radius=radius).tilted(angle, angle)


def _measured(made: mf.Surface, path: Path) -> mf.calibration.MeasuredLaw:
    """Write a table of forces with the paper's errors, and read it."""
    error, rng = paper()["force_error"], np.random.default_rng(2)
    true = mf.friction_law(made, load=FORCES).friction_force
    sd = np.hypot(error["friction_N"], error["friction_relative"] * true)
    load = FORCES + error["normal_N"] * rng.standard_normal(len(FORCES))
    force = true + sd * rng.standard_normal(len(FORCES))
    rows = [f"{x!r},{y!r}" for x, y in zip(load.tolist(), force.tolist(), strict=True)]
    path.write_text("\n".join(["load_N,friction_force_N", *rows]), "utf-8")
    assert made.friction is not None
    return files.read_measured_law(path, made.material, made.friction)
