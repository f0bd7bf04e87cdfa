"""Expected misfits of robust designs, and the study of all errors at once against plain draws."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from validation.timing import Row, took

# The source paper's template, and errors of its heights and of the plane.
TEMPLATE = mf.Surface.square_lattice(
    0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.404, 0.85),
    block=mf.Block(20.0, 20.0, 7.2),
)  # fmt: skip
HEIGHT_SD, ANGLE = 0.003, math.radians(0.05)
TOLERANCES = mf.Tolerances(height_sd=HEIGHT_SD, angle=ANGLE)
LAYER = mf.Interacting(substrate=mf.BondedLayer())

LAWS = {
    "slope 6.87": mf.LinearLaw(6.87),
    "slope 9.46": mf.LinearLaw(9.46),
    "power 1.1": mf.PowerLaw(1.1, (0.05, 0.2)),
    "power 0.9": mf.PowerLaw(0.9, (0.1, 0.4)),
}

# Pairs of draws of both signs on which robust and plain designs are compared here.
PAIRS = 2000

# Designs of the study with the largest allowed misfit, and plain draws at each value.
ALLOWED = {"slope 6.87": 0.04, "power 0.9": 0.006}
DRAWS, PLAIN_DRAWS = 10_000, 100_000


def rows() -> Iterator[Row]:
    """Measure robust designs on the bonded layer, on draws that are made here."""
    for name, target in LAWS.items():
        plain = mf.design(target, TEMPLATE, LAYER)
        taken, robust = took(partial(mf.design, target, TEMPLATE, LAYER, robust=TOLERANCES))
        before, after = (_squares(design, 99) for design in (plain, robust))
        gain, error = (before - after).mean(), (before - after).std(ddof=1) / math.sqrt(PAIRS)
        share = robust.parameters["irreducible_share"]
        what = f"robust design, {name}, layer"
        yield Row(f"{what}: time", 30.0, taken, "s")
        yield Row(f"{what}: three errors of the gain over the gain", 1.0, 3.0 * error / gain)
        yield Row(f"{what}: expected misfit, plain", math.sqrt(before.mean()), math.sqrt(after.mean()))
        yield Row(f"{what}: share that no heights remove", 1.0, float(share))


def long_rows() -> Iterator[Row]:
    """Measure the probability to meet the target and the largest tolerances, against plain draws."""
    for name, allowed in ALLOWED.items():
        design = mf.design(LAWS[name], TEMPLATE)
        options = {"requirement": mf.studies.Requirement(allowed), "draws": DRAWS}
        taken, study = took(partial(mf.studies.combined, design, TOLERANCES, **options))
        share = _share(design, allowed, HEIGHT_SD, ANGLE)
        error = math.hypot(math.sqrt(share * (1.0 - share) / PLAIN_DRAWS), float(study.probability_error))
        what = f"all errors, {name}"
        apart = abs(float(study.probability) - share) / error
        yield Row(f"{what}: time", 60.0, taken, "s")
        yield Row(f"{what}: probability {share:.3f}, difference", 3.0, apart, "errors")
        for tolerance, factor, of_factor in zip(
            study.tolerance.values.tolist(), study.factor.values, study.factor_error.values, strict=True
        ):
            if not math.isfinite(factor):
                continue
            made = {"height_sd": HEIGHT_SD, "angle": ANGLE}
            changed = made if tolerance == "all" else {tolerance: made[tolerance]}

            def at(times: float, made=made, changed=changed, design=design, allowed=allowed) -> float:
                return _share(design, allowed, **{**made, **{k: times * v for k, v in changed.items()}})

            found, step = at(factor), 0.05 * factor
            rate = (at(factor + step) - at(factor - step)) / (2.0 * step)
            error = math.hypot(rate * of_factor, math.sqrt(0.09 / PLAIN_DRAWS))
            words = f"{what}: 90 % at {factor:.3f} of {tolerance}, difference"
            yield Row(words, 3.0, abs(found - 0.9) / error, "errors")


def _heights(surface: mf.Surface, count: int, height_sd: float, angle: float, seed: int) -> np.ndarray:
    """Return errors of the heights (count, n) [mm]."""
    random = np.random.default_rng(seed)
    slope = np.tan(random.uniform(-1.0, 1.0, (count, 2)) * angle)
    return height_sd * random.standard_normal((count, surface.count)) + slope @ surface.position.T


def _squares(design: mf.Design, seed: int) -> np.ndarray:
    """Return the squared misfit of made surfaces, the mean of each pair of both signs."""
    surface, law = design.surface, design.target_law
    error = _heights(surface, PAIRS, HEIGHT_SD, ANGLE, seed)
    areas = LAYER.areas(surface, law.load, surface.height + np.concatenate([error, -error]))
    return np.array([law.misfit(area) ** 2 for area in areas]).reshape(2, -1).mean(axis=0)


def _share(design: mf.Design, allowed: float, height_sd: float, angle: float) -> float:
    """Return the share of plain draws whose misfit is at most the allowed one."""
    surface, law = design.surface, design.target_law
    height = surface.height + _heights(surface, PLAIN_DRAWS, height_sd, angle, 98)
    misfit = np.array([law.misfit(area) for area in mf.Independent().areas(surface, law.load, height)])
    for branch, _ in design.fits:
        areas = mf.Independent().areas(surface, branch.load, height)
        slope = np.polyfit(branch.load, areas.T, 1)[0]
        misfit = np.maximum(misfit, np.abs(slope / branch.slope - 1.0))
    return float((misfit <= allowed).mean())
