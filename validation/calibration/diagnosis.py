"""What explains a measured law, on parts whose errors are drawn from the stated priors."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasuredLaw, MeasurementErrors, Priors, explain
from metafem.calibration.bounded_interval import WIDTH
from metafem.drawing import ACHIEVED, MEASURED_BESIDE, QUIET, diagnosis, new_figure
from validation.check import Check, Claim, Picture, Row, above, below, near, reported
from validation.figures import panels
from validation.paper.surfaces import template
from validation.scenes.repeated_estimates import TRUTH
from validation.sources import known_input

# Longer than a few seconds: thousands of parts.
SLOW = True

# Drawn parts: measured with the area of each contact, and by friction over load alone; the benchmark draws
# 2,000 of both.
PARTS, FORCE_PARTS = 1000, 200

# Parts whose caps differ, and the caps of neighbouring asperities.
CAP_PARTS = 100
CAPS = mf.Power(1.6), mf.Power(3.0, 2.0), mf.Sphere(), mf.Power(2.5)

# The loads of Fig. 4 [N], and the noise of the paper.
LOADS, NOISE = np.linspace(0.03, 0.6, 20), MeasurementErrors()

# Errors of the whole part and of the calibration; single asperities are as designed.
COMMON = Priors(height_sd=0.0, radius_sd=0.0)
ALONE, BY_PROFILE = mf.Independent(), mf.Independent(mf.Elastic())

NOMINAL = known_input("nominal 68 % of the intervals, for parts whose errors are drawn from the priors")
MADE = known_input("errors of the synthetic part")
LAYER = known_input("the synthetic part interacts through the layer, and must not seem independent")
IDENTICAL = known_input(
    "identity: E*, σB and the height scale are three factors of one curve F = σB A0(P/E*)"
)
FOUND = f"mean of {PARTS} synthetic parts, measured with the area of each contact"
MIXED = f"nominal 68 % within three standard errors of {CAP_PARTS} parts whose caps differ"
ALONE_FOUND = f"{FORCE_PARTS} synthetic parts, measured by friction over load alone"


class Trial(NamedTuple):
    """Errors of one part, and the means and standard deviations found."""

    truth: FloatArray
    mean: FloatArray
    sd: FloatArray


@cache
def design(mixed: bool = False) -> mf.Surface:
    """Return 64 exponential heights at random sites of the paper's lattice, as those of Fig. 4.

    mixed: whether the caps differ; otherwise they are spheres.
    """
    quantile = (np.arange(64) + 0.5) / 64.0
    heights = 0.05 - 0.0357 * np.log1p(-quantile * -math.expm1(-0.27 / 0.0357))
    found = template("fig4_red").replaced(height=np.random.default_rng(0).permutation(heights))
    return found.replaced(cap=CAPS * 16) if mixed else found


def part(rng: np.random.Generator, mixed: bool) -> tuple[FloatArray, mf.Surface, float]:
    """Return drawn errors, the made surface and its factor of sigma B."""
    sd = [COMMON.angle_sd, COMMON.angle_sd, COMMON.height_scale_sd, COMMON.composite_modulus_sd]
    errors = np.array([*sd, COMMON.friction_sd]) * rng.standard_normal(5)
    surface = design(mixed)
    material = mf.Material((1.0 + errors[3]) * surface.material.composite_modulus)
    made = surface.replaced(height=(1.0 + errors[2]) * surface.height, material=material)
    return errors, made.tilted(errors[0], errors[1]), 1.0 + errors[4]


def measured(surface: mf.Surface, friction: float, rng: np.random.Generator, areas: bool) -> MeasuredLaw:
    """Return the law of a part as measured with the paper's noise."""
    nominal = design()
    model = ALONE if surface.cap == mf.Sphere() else BY_PROFILE
    curve = model.curve(surface, LOADS / surface.material.composite_modulus)
    indentation = curve.approach[:, None] - (surface.height.max() - surface.height)
    contact, summits = model.contact.bound(surface), model.contact.summits(surface)
    area = contact.area(contact.contact_radius(indentation, summits))
    force = friction * nominal.friction.shear_strength * nominal.friction.area_ratio * area.sum(axis=1)
    load = LOADS + NOISE.of_load(LOADS) * rng.standard_normal(LOADS.shape)
    force += NOISE.of_friction_force(force) * rng.standard_normal(LOADS.shape)
    # an area below its error may come out negative: such a contact is not seen
    area = np.maximum(area + NOISE.of_area(area) * rng.standard_normal(area.shape), 0.0)
    given = {"friction_force": force} | ({"asperity_area": area} if areas else {})
    return MeasuredLaw(load, **given, material=nominal.material, friction=nominal.friction)


@cache
def trials(count: int, areas: bool, mixed: bool = False) -> Trial:
    """Return the errors of drawn parts, and what was found, (count, 5) each."""
    found = []
    for seed in range(count):
        rng = np.random.default_rng((seed, int(areas)))
        errors, surface, friction = part(rng, mixed)
        law, model = measured(surface, friction, rng, areas), BY_PROFILE if mixed else ALONE
        causes = explain(law, design(mixed), COMMON, model=model).causes
        found.append((errors, [one.mean for one in causes], [one.sd for one in causes]))
    return Trial(*map(np.array, zip(*found, strict=True)))


def covered(found: Trial) -> FloatArray:
    """Return the part of the 68 % intervals of each error that contain the truth."""
    return (np.abs(found.mean - found.truth) <= WIDTH * found.sd).mean(axis=0)


NAMES = ("tilt along x", "tilt along y", "height scale", "E*", "σB")


def claim() -> Claim:
    """Where a measured law differs from the design, `explain` finds which error explains it. Synthetic parts
    are tilted, scaled and made of another E* and σB, all drawn from the priors, and measured at 20 loads with
    the paper's noise; the true errors are therefore known. With the area of each contact all are found, with
    right intervals. From friction over load alone only one combination of E*, σB and the height scale can be
    found, and the result says so. The same holds for parts whose caps differ.
    """
    figures = {
        "coverage of the intervals": Picture(_coverages),
        "errors of a tilted part with a hole": Picture(_posteriors),
        "heights of that part": Picture(_heights),
    }
    rows = [*_coverage(), *_other_caps(), *_forces_alone(), *_recognised(), *_interaction()]
    return Claim("What explains a measured law", rows, figures)


def _coverage() -> Iterator[Row]:
    found = trials(PARTS, True)
    shares, bias = covered(found), ((found.mean - found.truth) / found.sd).mean(axis=0)
    left = found.sd.mean(axis=0) / found.truth.std(axis=0)
    for i, name in enumerate(NAMES):
        what = f"{name}: 68 % intervals that contain the truth, {PARTS} parts"
        yield near(what, shares[i], 0.68, 0.04, NOMINAL)
        yield below(f"{name}: bias over its standard deviation", abs(float(bias[i])), 0.2, TRUTH)
        yield reported(f"{name}: standard deviation found over that expected", float(left[i]), FOUND)


def _other_caps() -> Iterator[Row]:
    for name, share in zip(NAMES, covered(trials(CAP_PARTS, True, True)).tolist(), strict=True):
        what = f"{name}: 68 % intervals that contain the truth, {CAP_PARTS} parts whose caps differ"
        yield near(what, share, 0.68, 0.14, known_input(MIXED))


def _forces_alone() -> Iterator[Row]:
    for name, share in zip(NAMES, covered(trials(FORCE_PARTS, False)).tolist(), strict=True):
        what = f"{name}: 68 % intervals that contain the truth, from F(P) alone"
        yield reported(what, share, ALONE_FOUND)
    named = [{*one.change} for one in explained(False).unresolved]
    together = any({"composite_modulus", "friction"} <= names for names in named)
    scale = any("height_scale" in names for names in named)
    yield Check("E* and σB named as not told apart", float(together), "1", together, IDENTICAL)
    yield Check("height scale named as not determined", float(scale), "1", scale, IDENTICAL)


@cache
def explained(areas: bool, hole: float = 0.0, model: mf.Model = ALONE) -> mf.calibration.Explanation:
    """Return the explanation of a part tilted by 0.08 degrees, with a hole at its tallest asperity."""
    height = design().height.copy()
    height[height.argmax()] -= hole
    made = design().replaced(height=height).tilted(math.radians(0.08), 0.0)
    law = measured(made, 1.0, np.random.default_rng(1), areas)
    return explain(law, design(), model=model)


def _recognised() -> list[Row]:
    tilted, holed = explained(True), explained(True, 0.015)
    site = int(design().height.argmax())
    scaled = design().replaced(height=1.05 * design().height)
    scale = explain(measured(scaled, 1.0, np.random.default_rng(2), True), design(), model=ALONE)
    errors, unexplained = holed.single["height"], 1.0 - scale.shares["height_scale"]
    depth, within = -1e3 * errors.mean[site], 3e3 * errors.sd[site]
    return [
        below("tilted part: share of other errors", 1.0 - tilted.shares["tilt"], 0.3, MADE),
        below("scaled part: misfit that the scale does not explain", unexplained, 0.3, MADE),
        near("part with a hole: outliers", len(holed.outliers), 1, 0.0, MADE),
        near("its site", int(holed.outliers[0]), site, 0.0, MADE),
        near("its depth [µm]", depth, 15.0, within, MADE),
    ]


def _interaction() -> list[Row]:
    layer = mf.Interacting(substrate=mf.BondedLayer())
    made, rng = design().tilted(math.radians(0.03), 0.0), np.random.default_rng(3)
    states = [mf.equilibrium(made, layer, load=load) for load in LOADS[1::4]]
    area = np.array([state.asperity_area for state in states])
    load = LOADS[1::4] + NOISE.of_load(LOADS[1::4]) * rng.standard_normal(len(states))
    area = np.maximum(area + NOISE.of_area(area) * rng.standard_normal(area.shape), 0.0)
    found = explain(MeasuredLaw(load, asperity_area=area, material=made.material), design())
    angle, evidence = found["angle_x"], found.log_evidence
    odds = (evidence["layer"] - evidence["independent"]) / math.log(10.0)
    return [
        # a hundred to one
        above("part on a layer: log10 of the odds of the layer", odds, 2.0, LAYER),
        near("its tilt [°]", math.degrees(angle.mean), 0.03, math.degrees(3.0 * angle.sd), MADE),
    ]


@panels(6.0, 2.8)
def _coverages(ax) -> None:
    """Share of 68 % intervals that contain the true error. With the area of each contact (circles) all must
    lie in the grey band, 64 to 72 %. From friction over load alone (squares) the law is not linear in the
    errors, and the intervals are only approximate.
    """
    places = -np.arange(len(NAMES))
    ax.axvspan(0.64, 0.72, color=QUIET, alpha=0.25, lw=0)
    for found, label, marker, ink in (
        (trials(PARTS, True), "with the area of each contact", "o", ACHIEVED),
        (trials(FORCE_PARTS, False), "friction over load alone", "s", MEASURED_BESIDE),
    ):
        ax.plot(covered(found), places, marker, ms=5, color=ink, label=label)
    ax.set_yticks(places, NAMES)
    ax.set_xlim(0.0, 1.0)
    ax.set_xlabel("68 % intervals that contain the true error")
    ax.legend(frameon=False, fontsize=8, loc="lower left")


def _posteriors() -> Any:
    """What was found of a part that was tilted by 0.08° about one axis and has one asperity 15 µm too low:
    mean and 68 % interval of each error of the whole part, in units of its prior. Only the tilt along x is
    not 0.
    """
    figure = new_figure(6.0, 3.2, (1.3, 0.2, 0.6, 0.4))
    causes = explained(True, 0.015).causes
    prior = np.array([cause.prior_sd for cause in causes])
    mean, sd = (np.array([getattr(cause, name) for cause in causes]) / prior for name in ("mean", "sd"))
    diagnosis.posteriors(figure.add_subplot(), NAMES, mean, sd)
    return figure


def _heights() -> Any:
    """Errors of the single heights that were found for the same part, with their 68 % intervals. One asperity
    stands out by 15 µm, as it was made.
    """
    figure = new_figure(6.0, 3.2)
    errors = explained(True, 0.015).single["height"]
    diagnosis.heights(figure.add_subplot(), 1e3 * errors.mean, 1e3 * errors.sd, 1e3 * errors.prior_sd)
    return figure
