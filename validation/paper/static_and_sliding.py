"""Static and sliding friction: the same rescaled law with σ and B of their own.

The paper states that peak and plateau of its records obey the same laws with slightly different σ and B, so
that the rescaled law is unchanged, but prints neither these values nor a record. The records here are
synthetic: the force rises to a peak of σB A0 and falls to a plateau of σ'B' A0, and the area falls from A0.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasuredLaw, ShearCalibration, at_peak, over_plateau, shear
from metafem.calibration.sheared import SLIDING as PLATEAU
from metafem.drawing import ACHIEVED, MEASURED, MEASURED_BESIDE, QUIET, TARGET
from validation.check import Claim, Picture, Row, below, near, reported
from validation.figures import panels
from validation.methods import independent
from validation.paper.surfaces import RADIUS, fig4
from validation.scenes.compression_tests import RADII
from validation.scenes.sheared_contacts import ERRORS
from validation.sources import known_input, second_method

# σ [MPa] and B of the peak, those of Fig. 4, red; and of the plateau, put in as slightly smaller.
STATIC, SLIDING = mf.Friction(0.358, 0.85), mf.Friction(0.335, 0.83)

# Pull of 1 mm with a force every 0.01 mm (0.1 mm/s at 10 Hz); displacement at the peak, length of its decay
# [mm].
PULL, PEAK, DECAY = np.linspace(0.0, 1.0, 101), 0.15, 0.02

# Noise of a force within one record, over its error bar: the latter is mostly common to a record.
WHITE = 0.02

LOADS = np.linspace(0.03, 0.6, 20)

# Loads at which all asperities of the surface are in contact [N].
FULL = np.linspace(0.8, 1.2, 5)

# Standard deviations within which a value counts as found; 99.7 % of correct ones are.
WITHIN = 3.0

TRUE = known_input("σ and B of the synthetic records, within three standard deviations")
RANGE = known_input("range of the evaluation, 100 to 200 µm after the peak as in the paper's SM")


# Both kinds of friction, with the true values.
KINDS = {"static": STATIC, "sliding": SLIDING}


Pull = tuple[FloatArray, FloatArray]

# What each kind of friction takes from a record.
VALUE = {"static": at_peak, "sliding": over_plateau}


def forces(records: list[Pull], kind: str) -> FloatArray:
    """Return the friction force of each record."""
    return np.array([VALUE[kind](PULL, force) for force, _ in records])


def areas(records: list[Pull], kind: str) -> FloatArray:
    """Return the contact area of each record at the friction force."""
    return np.array([VALUE[kind](PULL, force, area) for force, area in records])


def pulled(area: FloatArray, rng: np.random.Generator) -> list[Pull]:
    """Return forces and areas in records of contacts of areas before shear (k,) [mm²]."""
    rising = np.minimum(PULL / PEAK, 1.0)
    # from 0 at the peak to 1 on the plateau
    fallen = np.where(PULL > PEAK, 1.0 - np.exp(-np.maximum(PULL - PEAK, 0.0) / DECAY), 0.0)
    ratio = 1.0 - (1.0 - STATIC.area_ratio) * rising**2 - (STATIC.area_ratio - SLIDING.area_ratio) * fallen
    peak, plateau = (each.shear_strength * each.area_ratio for each in (STATIC, SLIDING))
    records = []
    for each in area.tolist():
        force = each * (peak * rising - (peak - plateau) * fallen)
        error = ERRORS.of_friction_force(np.array(each * peak))
        force = force + error * (rng.standard_normal() * rising + WHITE * rng.standard_normal(len(PULL)))
        areas = each * ratio
        areas = areas + ERRORS.of_area(areas) * rng.standard_normal(len(PULL))
        records.append((force, areas))
    return records


@cache
def calibrations() -> dict[str, ShearCalibration]:
    """Return the calibrations of static and sliding friction by one contact at 20 loads, three times."""
    records = pulled(np.pi * np.tile(RADII, 3) ** 2, np.random.default_rng(0))
    before = np.array([area[0] for _, area in records])
    return {kind: shear(before, areas(records, kind), forces(records, kind)) for kind in KINDS}


@cache
def measured() -> tuple[list[Pull], dict[str, MeasuredLaw]]:
    """Return the records of the surface of Fig. 4, red, and its two laws, rescaled by the calibrations."""
    surface, rng = fig4("red").surface, np.random.default_rng(1)
    records = pulled(mf.friction_law(surface, load=LOADS).area, rng)
    load = LOADS + ERRORS.of_load(LOADS) * rng.standard_normal(LOADS.shape)
    laws = {}
    for kind, found in calibrations().items():
        calibrated = {"material": surface.material, "friction": found.friction}
        laws[kind] = MeasuredLaw(load, friction_force=forces(records, kind), **calibrated)
    return records, laws


def claim() -> Claim:
    """The paper designs for the static friction and states that sliding friction obeys the same laws with
    slightly different σ and B. Synthetic records with a peak and a plateau are read by `at_peak` and
    `over_plateau`; each of both kinds is calibrated on single contacts, and rescales the law of the surface
    of Fig. 4, red. The forces differ, the rescaled laws do not: a design holds for either.
    """
    rows: list[Row] = []
    for name, true in KINDS.items():
        found = calibrations()[name]
        sd = WITHIN * np.sqrt(np.diag(found.covariance))
        rows += [
            near(f"{name} friction: B", found.area_ratio, true.area_ratio, sd[0], TRUE),
            near(f"{name} friction: σ [MPa]", found.shear_strength, true.shear_strength, sd[1], TRUE),
        ]
    records, laws = measured()
    low, high = PLATEAU
    rows += [
        near("sliding range, beginning [mm]", low, 0.1, 0.0, RANGE),
        near("sliding range, end [mm]", high, 0.2, 0.0, RANGE),
    ]
    height = fig4("red").surface.height
    line = second_method(independent.areas, "slope of the line through A0 of the heights at the same loads")
    slopes, errors = {}, {}
    rows += [each for friction in (STATIC, SLIDING) for each in _forces(friction)]
    for name, law in laws.items():
        wanted = np.polyfit(law.rescaled_load, independent.areas(height, law.rescaled_load, RADIUS), 1)[0]
        slopes[name], errors[name] = slope_of(law, calibrations()[name])
        tolerance = WITHIN * errors[name]
        rows.append(near(f"{name} friction, rescaled: slope", slopes[name], wanted, tolerance, line))
    # the forces of both have the errors of their own records, and share those of the load
    both = np.hypot(*errors.values())
    static, sliding = (found.shear_strength * found.area_ratio for found in calibrations().values())
    ratio = forces(records, "sliding") / forces(records, "static")
    rows += [
        near("rescaled slopes, sliding less static", slopes["sliding"] - slopes["static"], 0.0,
             WITHIN * both, SAME),
        reported("sliding over static friction force", ratio.mean(), "mean over 20 loads"),
        reported("sliding friction rescaled by σB of static friction: slope over that of static friction",
                 slopes["sliding"] / slopes["static"] * sliding / static,
                 "straight lines through the points"),
    ]  # fmt: skip
    figures = {"one record": Picture(_record), "laws of static and sliding friction": Picture(_laws)}
    return Claim("Static and sliding friction", rows, figures)


def _forces(friction: mf.Friction) -> list[Row]:
    """Compare forces of the design with σB times the areas of its heights, and rescale them again."""
    surface = fig4("red").surface.replaced(friction=friction)
    law, stress = mf.friction_law(surface, load=LOADS), friction.shear_strength * friction.area_ratio
    area = independent.areas(surface.height, law.load / surface.material.composite_modulus, RADIUS)
    calibrated = {"material": surface.material, "friction": friction}
    measured = MeasuredLaw(law.load, friction_force=stress * area, **calibrated)
    pairs = {
        "predicted force F = σB A0": (law.friction_force, stress * area),
        "rescaled friction F/(σB)": (law.rescaled_friction, area),
        "rescaled measured friction": (measured.rescaled_friction, area),
    }
    label = f"σ = {friction.shear_strength} MPa: largest relative difference of the"
    modulus = surface.material.composite_modulus
    whole = stress * independent.areas(surface.height, FULL / modulus, RADIUS)
    given = mf.calibration.shear_strength(
        MeasuredLaw(FULL, friction_force=whole, **calibrated), surface, FULL[0]
    )
    pairs["strength that full contact gives"] = given.shear_strength, friction.shear_strength
    return [
        below(f"{label} {what}", np.abs(found / expected - 1.0).max(), EXACT, FORCE)
        for what, (found, expected) in pairs.items()
    ]


# Rounding of sums of 64 terms.
EXACT = 1e-10

FORCE = second_method(independent.areas, "A0 of the heights, eq. S1, with numpy")
SAME = known_input("identity: both forces of the records are proportional to the same A0(P)")


def slope_of(law: MeasuredLaw, found: ShearCalibration) -> tuple[float, float]:
    """Return the slope of a line through rescaled points and its standard deviation, with that of σB."""
    sd = np.hypot(law.rescaled_friction_sd, 7.0 * law.rescaled_load_sd)  # errors of the load by the slope
    points = law.rescaled_load, law.rescaled_friction
    (slope, _), covariance = np.polyfit(*points, 1, w=1.0 / sd, cov="unscaled")
    inverse = np.array([1.0 / found.area_ratio, 1.0 / found.shear_strength])
    of_stress = np.sqrt(inverse @ found.covariance @ inverse)  # relative, of σB
    return float(slope), float(np.hypot(np.sqrt(covariance[0, 0]), slope * of_stress))


@panels(8.0, 3.0, columns=2)
def _record(force, area):
    """Left, a synthetic record of the tangential force: its peak is the static friction, its mean over the
    grey range, 100 to 200 µm after the peak, the sliding friction. Right, the sum of the contact areas, which
    falls as the force rises.
    """
    found = measured()[0][-1]
    place = PULL[found[0].argmax()]
    force.plot(PULL, found[0], color=MEASURED, lw=1.0)
    force.plot(place, at_peak(PULL, found[0]), "o", color=ACHIEVED, label="static friction")
    low, high = (place + end for end in PLATEAU)
    force.axvspan(low, high, color=QUIET, alpha=0.25, lw=0)
    force.plot(
        [low, high], 2 * [over_plateau(PULL, found[0])], color=MEASURED_BESIDE, label="sliding friction"
    )
    force.set(xlabel="tangential displacement [mm]", ylabel="tangential force [N]")
    area.plot(PULL, found[1], ".", ms=3, color=MEASURED)
    area.axvline(place, color=ACHIEVED, lw=0.8)
    area.axvspan(low, high, color=QUIET, alpha=0.25, lw=0)
    area.set(xlabel="tangential displacement [mm]", ylabel="contact area [mm²]")
    area.set_ylim(0.0)


@panels(8.0, 3.4, columns=2)
def _laws(forces, rescaled):
    """Left, friction force over load of the surface of Fig. 4, red: static and sliding friction differ.
    Right, both rescaled by their own σB: the points must fall on one curve, which is that of the heights
    (line).
    """
    for (name, law), ink in zip(measured()[1].items(), (ACHIEVED, MEASURED_BESIDE), strict=True):
        style = {"fmt": "o", "ms": 3, "color": ink, "label": name}
        forces.errorbar(law.load, law.friction_force, law.friction_force_sd, law.load_sd, **style)
        bars = law.rescaled_friction_sd, law.rescaled_load_sd
        rescaled.errorbar(law.rescaled_load, law.rescaled_friction, *bars, **style)
    load = np.linspace(0.005, 0.45, 100)
    area = independent.areas(fig4("red").surface.height, load, RADIUS)
    rescaled.plot(load, area, color=TARGET, lw=1.0, label="law of the heights")
    forces.set(xlabel="load P [N]", ylabel="friction force F [N]")
    rescaled.set(xlabel="rescaled load  P/E* [mm²]", ylabel="rescaled friction  F/(σB) [mm²]")
