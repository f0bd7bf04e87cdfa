"""Mistakes in measured data and in their use: which are refused or named, and what the others change."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

import metafem as mf
from metafem.calibration import MeasuredLaw, contact, shear, shear_record, shear_strength
from metafem.drawing import ACHIEVED, QUIET, TARGET, new_figure
from validation.check import Claim, Picture, Row, near, reported
from validation.paper.surfaces import fig4
from validation.scenes.compression_tests import ENERGY, MODULUS, RADIUS, compression_tests
from validation.scenes.sheared_contacts import STRENGTH, sheared
from validation.sources import known_input

CONTACTS = 5

MISTAKE = known_input("a mistake put into synthetic data, which must be refused or named")
HIDDEN = "the value that is found; nothing in the data contradicts it"

CAPTION = (
    "E* or σ found from data with a mistake, over the true value. Grey crosses are refused and have no "
    "value. Blue points come with a statement that the law does not fit, or with a warning. Red points look "
    "right: such mistakes cannot be seen in loads, areas and forces, and must be excluded by other means."
)


@dataclass(frozen=True)
class Outcome:
    """Whether a mistake was refused or named, and E* or σ over the true value where there is one."""

    refused: bool
    named: bool
    ratio: float | None = None


def _outcome(call: Callable[[], Outcome]) -> Outcome:
    try:
        return call()
    except mf.InvalidInput:
        return Outcome(True, True)


@cache
def outcomes() -> dict[str, Outcome]:
    """Return the outcome of each mistake."""
    rng = np.random.default_rng(0)
    loads, areas = compression_tests(1, CONTACTS, ENERGY, rng)
    load, area = loads[0], areas[0]
    before, after, force = sheared(rng, contacts=CONTACTS)[0]
    surface, x = fig4("red").surface, np.linspace(0.0, 1.0, 101)
    law = mf.friction_law(surface, load=np.linspace(0.05, 0.4, 10))
    measured = MeasuredLaw(
        law.load, friction_force=law.friction_force, material=surface.material, friction=surface.friction
    )

    def pressed(load, area, radius=RADIUS, contacts=CONTACTS) -> Outcome:
        found = contact(load, area, radius, contacts=contacts)
        return Outcome(False, not found.verdict.fits, found.composite_modulus / MODULUS)

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
        "contact radii in place of areas": lambda: pressed(load, np.sqrt(area / np.pi)),
        "loads and areas exchanged": lambda: pressed(area, load),
        "areas in another order than the loads": lambda: pressed(load, rng.permutation(area)),
        "zero of the load off by 50 mN": lambda: pressed(load + 0.05, area),
        "loads of the other sign": lambda: pressed(-load, area),
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
    return {name: _outcome(call) for name, call in calls.items()}


# Mistakes that leave loads and areas in agreement with the law.
UNSEEN = (
    "the diameter in place of the radius",
    "areas under shear in place of those before",
    "all areas 5 % too large",
)


def claim() -> Claim:
    """Make each mistake once."""
    rows: list[Row] = []
    for name, found in outcomes().items():
        if name in UNSEEN:
            rows.append(reported(f"{name}: E* over the true one", found.ratio or np.nan, HIDDEN))
        else:
            rows.append(near(f"{name}: refused or named (1)", float(found.named), 1.0, 0.0, MISTAKE))
    count = sum(each.refused for each in outcomes().values())
    rows.append(reported("mistakes that are refused", float(count), f"of {len(outcomes())} that were made"))
    return Claim(
        "Mistakes in measured data",
        rows,
        {"what mistakes do to E* and σ": Picture(_figure, CAPTION)},
        "A calibration should not return a number for data that contradict its law. Usual mistakes are made "
        "in synthetic data: wrong units, exchanged columns, zeros that are off, too few contacts, "
        "incomplete records. They are refused with a message that names the value, or the result states "
        "that the law does not fit. Three mistakes change areas or radius by one factor; no fit can "
        "recognise them, and their effect is stated.",
    )


def _figure():
    figure = new_figure(8.0, 4.6)
    ax = figure.add_subplot(xscale="log")
    found = outcomes()
    places = -np.arange(len(found))
    for place, (name, each) in zip(places, found.items(), strict=True):
        if each.ratio is None:
            ax.plot(1.0, place, "x" if each.refused else "o", color=QUIET if each.refused else ACHIEVED, ms=5)
        else:
            ax.plot(each.ratio, place, "o", color=TARGET if name in UNSEEN else ACHIEVED, ms=5)
    ax.axvline(1.0, color=QUIET, lw=0.8, ls=":")
    ax.set_xlim(0.1, 3e3)
    ax.set_yticks(places, list(found), fontsize=8)
    ax.set_xlabel("E* or σ over the true value")
    return figure
