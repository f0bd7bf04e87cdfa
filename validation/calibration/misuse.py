"""Mistakes in measured data and in their use: which are refused or named, and what the others change."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.calibration import MeasuredLaw, Sample, fit_compression, shear, shear_record, shear_strength
from metafem.drawing import ACHIEVED, QUIET, TARGET
from validation.check import Claim, Picture, Row, near, reported
from validation.figures import panels
from validation.paper.surfaces import fig4
from validation.scenes.compression_tests import ENERGY, MODULUS, RADII, RADIUS, compression_tests, loads
from validation.scenes.outliers import REPETITIONS, held, last_outlying, repeated, steady, with_outlier
from validation.scenes.sheared_contacts import STRENGTH, sheared
from validation.sources import known_input

SLOW = True

CONTACTS = 5

MISTAKE = known_input("a mistake put into synthetic data, which must be refused or named")
HIDDEN = "the value that is found; nothing in the data contradicts it"


@dataclass(frozen=True)
class Outcome:
    """Whether a mistake was refused or named, and E* or σ over the true value where there is one."""

    refused: bool
    named: bool
    ratio: float | None = None


@cache
def outcomes() -> dict[str, Outcome]:
    """Return the outcome of each mistake."""
    rng = np.random.default_rng(0)
    load, area = (each[0] for each in compression_tests(1, CONTACTS, ENERGY, rng))
    before, after, force = sheared(rng, contacts=CONTACTS)[0]
    surface, x = fig4("red").surface, np.linspace(0.0, 1.0, 101)
    law = mf.friction_law(surface, load=np.linspace(0.05, 0.4, 10))
    measured = MeasuredLaw(
        law.load, friction_force=law.friction_force, material=surface.material, friction=surface.friction
    )

    def pressed(load, area, radius=RADIUS, contacts=CONTACTS) -> Outcome:
        found = fit_compression(load, area, radius, Sample(contacts=contacts))
        named = not found.verdict.fits or any(
            "would fit where a table says" in str(note) for note in found.notes
        )
        return Outcome(False, named, found.composite_modulus / MODULUS)

    def slid(before, after, force) -> Outcome:
        found = shear(before, after, force)
        fits = found.area_verdict.fits and found.friction_verdict.fits
        return Outcome(False, not fits or bool(found.notes), found.shear_strength / STRENGTH)

    def pulled(displacement, force) -> Outcome:
        return Outcome(False, bool(shear_record(displacement, force).notes))

    def full(load_min) -> Outcome:
        return Outcome(False, False, shear_strength(measured, surface, load_min).shear_strength / STRENGTH)

    calls: dict[str, Callable[[], Outcome]] = {
        "area of five contacts given as that of one": lambda: pressed(load, area, contacts=1),
        "areas in µm²": lambda: pressed(load, 1e6 * area),
        "loads in mN": lambda: pressed(1e3 * load, area),
        "loads in N, read as mN": lambda: pressed(1e-3 * load, area),
        "exact loads in mN": lambda: pressed(1e3 * 5.0 * loads(RADII), 5.0 * np.pi * RADII**2),
        "contact radii in place of areas": lambda: pressed(load, np.sqrt(area / np.pi)),
        "loads and areas exchanged": lambda: pressed(area, load),
        "areas in another order than the loads": lambda: pressed(load, rng.permutation(area)),
        "zero of the load off by 50 mN": lambda: pressed(load + 0.05, area),
        "loads of the other sign": lambda: pressed(-load, area),
        "one load off by 6 standard deviations": lambda: pressed(load + 0.03 * (load == load.max()), area),
        "a missing load": lambda: pressed(np.append(np.nan, load[1:]), area),
        "areas before and under shear exchanged": lambda: slid(after, before, force),
        "friction forces in mN": lambda: slid(before, after, 1e3 * force),
        "friction forces in another order": lambda: slid(before, after, force[::-1]),
        "zero of the friction force off by 50 mN": lambda: slid(before, after, force + 0.05),
        "a record that ends before sliding": lambda: pulled(x[:20], np.minimum(x, 0.14)[:20]),
        "a record without a peak": lambda: pulled(x, np.minimum(x, 0.2)),
        "a record with the displacement in µm": lambda: pulled(1e3 * x, np.minimum(x, 0.15)),
        "σ from loads at which asperities are open": lambda: full(0.05),
        "the diameter in place of the radius": lambda: pressed(load, area, 2.0 * RADIUS),
        "areas under shear in place of those before": lambda: pressed(load, 0.85 * area),
        "all areas 5 % too large": lambda: pressed(load, 1.05 * area),
    }
    found = {}
    for name, call in calls.items():
        try:
            found[name] = call()
        except mf.InvalidInput:
            found[name] = Outcome(True, True)
    return found


# Share of intervals that hold the true value, and the standard deviations within which a share is as stated.
COVERED, WITHIN = 0.68, 3.0

LEVEL = known_input("four tests at 1 % each")
STATED = known_input("intervals of 68 %; three standard deviations of a share of 300 calibrations")
FIT = "share of 300 calibrations to three tests of 20 loads"

# Mistakes that leave loads and areas in agreement with the law.
UNSEEN = (
    "the diameter in place of the radius",
    "areas under shear in place of those before",
    "all areas 5 % too large",
)


def claim() -> Claim:
    """A calibration should not return a number for data that contradict its law. Usual mistakes are made in
    synthetic data: wrong units, exchanged columns, zeros that are off, too few contacts, incomplete records.
    They are refused with a message that names the value, or the result states that the law does not fit.
    Three mistakes change areas or radius by one factor; no fit can recognise them, and their effect is
    stated. An outlier of four standard deviations of a load does most harm at the largest load: there the
    interval of least squares holds E* in about half of the cases.
    """
    rows: list[Row] = []
    for name, found in outcomes().items():
        if name in UNSEEN:
            rows.append(reported(f"not noticed: {name}: E* over the true one", found.ratio or np.nan, HIDDEN))
        else:
            rows.append(near(f"{name}: refused or named (1)", float(found.named), 1.0, 0.0, MISTAKE))
    count = sum(each.refused for each in outcomes().values())
    rows.append(reported("mistakes that are refused", float(count), f"of {len(outcomes())} that were made"))
    for contacts in (1, CONTACTS):
        rows += _statistics(contacts)
    return Claim("Mistakes in measured data", rows, {"what mistakes do to E* and σ": Picture(_figure)})


def _statistics(contacts: int) -> Iterator[Row]:
    """Return how often 300 calibrations notice what is wrong, and how often their intervals hold E*."""
    case = f"{contacts} contact{'s' * (contacts > 1)}"
    clean, outlier = repeated(steady, contacts), repeated(with_outlier, contacts)
    yield near(f"{case}, nothing wrong: noticed", clean.noticed, 0.04, WITHIN * spread(0.04), LEVEL)
    yield near(f"{case}, nothing wrong: E* held", clean.covered, COVERED, WITHIN * spread(COVERED), STATED)
    yield reported(f"{case}, an outlier: not noticed by any test", 1.0 - outlier.noticed, FIT)
    for where, scene in (("anywhere", with_outlier), ("at the largest load", last_outlying)):
        name = f"{case}, an outlier {where}: least squares hold E*"
        yield reported(name, held(scene, contacts), FIT)


def spread(share: float) -> float:
    """Return the standard deviation of a share of 300 calibrations."""
    return float(np.sqrt(share * (1.0 - share) / REPETITIONS))


@panels(8.0, 4.6, subplot_kw={"xscale": "log"})
def _figure(ax):
    """E* or σ found from data with a mistake, over the true value. Grey crosses are refused and have no
    value. Blue points come with a statement that the law does not fit, or with a warning. Red points look
    right: such mistakes cannot be seen in loads, areas and forces, and must be excluded by other means.
    """
    found = outcomes()
    places = -np.arange(len(found))
    for place, (name, each) in zip(places, found.items(), strict=True):
        ink = QUIET if each.refused else TARGET if name in UNSEEN else ACHIEVED
        ax.plot(each.ratio or 1.0, place, "x" if each.refused else "o", color=ink, ms=5)
    ax.axvline(1.0, color=QUIET, lw=0.8, ls=":")
    ax.set_xlim(0.1, 3e3)
    ax.set_yticks(places, list(found), fontsize=8)
    ax.set_xlabel("E* or σ over the true value")
