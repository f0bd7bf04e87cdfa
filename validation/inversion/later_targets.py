"""Targets of later papers: powers of the load, and caps of other shapes.

Of these papers only the abstracts were available: Fu et al. (2026), doi:10.48550/arXiv.2605.19555; Mouton and
Mélot (2025), doi:10.48550/arXiv.2511.03735; Bilotto et al. (2026), doi:10.48550/arXiv.2605.11012, on general
axisymmetric asperities.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.drawing import QUIET
from metafem.reference import hertz
from validation.check import REQUIRED, Claim, Picture, Row, above, below, near
from validation.figures import panels
from validation.methods import independent
from validation.methods.caps import Caps, areas
from validation.paper.surfaces import template
from validation.sources import closed_form, known_input, publication

# Many designs, of which some cannot be reached.
SLOW = True

RADIUS, COUNT = 0.526, 64

# Range of loads of the power laws [mm²], and heights that are tall enough for them [mm].
RANGE, LIMITS = (0.1, 0.4), mf.Limits(0.27, offset=0.05)

EXPONENTS = (2.0 / 3.0, 0.8, 1.0, 1.2, 1.35)

# Exponents of power caps and of laws that spheres cannot have with them: flatter tops than spheres.
CAPS = ((4.0, 0.5), (3.0, 0.6), (1.5, 0.9))

# Misfit of a law that counts as reached, and halvings of the interval of the largest exponent.
REACHED, HALVINGS = 0.01, 6

FU = publication("10.48550/arXiv.2605.19555", "abstract: exponents from 2/3 to 1.35")
ENDS = closed_form(hertz, "2/3 + ln(N^(1/3))/ln(P2/P1): one contact at the first load, N equal at the last")
LAST = closed_form(hertz, "3/2 β (P2/P1)^(3β−2) = N: no law is steeper than N equal contacts (Hölder)")
PUT_IN = known_input("exponent of the target")


@cache
def designed(exponent: float, radii: tuple[float, ...] | None = None) -> mf.Design:
    """Return the design of a power law, with spheres of one radius or of some radii."""
    return mf.design(mf.PowerLaw(exponent, RANGE), template("fig4_red"), limits=LIMITS, tools=radii)


@cache
def capped(shape: float, exponent: float) -> mf.Design:
    """Return the design of a power law with power caps."""
    model = mf.Independent(contact=mf.Elastic(mf.Power(shape)))
    return mf.design(mf.PowerLaw(exponent, RANGE), template("fig4_red"), model, LIMITS)


@cache
def largest_exponent(radii: tuple[float, ...] | None = None) -> float:
    """Return the largest exponent that a design reaches within 1 %, by halving an interval."""
    low, high = 1.35, 2.5
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        try:
            met = designed(middle, radii).misfit <= REACHED
        except mf.Infeasible:
            met = False
        low, high = (middle, high) if met else (low, middle)
    return low


def area_at(load: float, radius: float = RADIUS) -> float:
    """Return the area of one contact at a load P/E* [mm²], by Hertz's law."""
    unit, _ = hertz(1.0, radius)
    return float(np.pi * (load / unit) ** (2.0 / 3.0))


def exponent_between(load: FloatArray, area: FloatArray) -> float:
    """Return the exponent of the power law through laws (k,) by least squares of the logarithms."""
    return float(np.polyfit(np.log(load), np.log(area), 1)[0])


def claim() -> Claim:
    """Three later papers design further laws. The power laws that an optimisation found there are designed
    here to better than 1 %; two bounds explain why the exponents end where they do. Caps of other shapes have
    powers that spheres cannot have: flat ones less than 2/3, and cones have friction in proportion to the
    load for any heights.
    """
    figures = {"powers of the load": Picture(_laws)}
    return Claim("Targets of later papers", [*_powers(), *_caps()], figures)


def _powers() -> Iterator[Row]:
    load = np.geomspace(*RANGE, 30)
    for exponent in EXPONENTS:
        name, design = f"power {exponent:.3g} of the load", designed(exponent)
        found = exponent_between(load, independent.areas(design.surface.height, load, RADIUS))
        yield below(f"{name}: misfit", design.misfit, REACHED, REQUIRED)
        yield near(f"{name}: exponent of the law of the heights, by bisection", found, exponent, 2e-3, PUT_IN)
    reached = largest_exponent()
    ends, last = bounds()
    yield above("largest exponent within 1 %", reached, 1.35, FU)
    yield below("the same against the bound by both ends", reached, ends, ENDS)
    yield below("the same against the bound by the last slope", reached, last, LAST)


def bounds() -> tuple[float, float]:
    """Return what no exponent of one radius exceeds: by the areas at both ends, and by the last slope."""
    from scipy.optimize import brentq

    ratio = RANGE[1] / RANGE[0]
    ends = np.log(COUNT * area_at(RANGE[1] / COUNT) / area_at(RANGE[0])) / np.log(ratio)
    return float(ends), float(brentq(lambda b: 1.5 * b * ratio ** (3.0 * b - 2.0) - COUNT, 2.0 / 3.0, 3.0))


def _caps() -> Iterator[Row]:
    load = np.geomspace(*RANGE, 30)
    for shape, exponent in CAPS:
        design = capped(shape, exponent)
        area = areas(Caps(RADIUS, shape), design.surface.height, load)
        name = f"caps of power {shape:g}, power {exponent:g} of the load"
        yield below(f"{name}: misfit", design.misfit, REACHED, REQUIRED)
        yield near(f"{name}: exponent by bisection", exponent_between(load, area), exponent, 2e-3, PUT_IN)


@panels(7.0, 4.2)
def _laws(ax):
    """Rescaled friction over rescaled load on logarithmic axes, on which a power law is a straight line. The
    designs (lines) must follow the targets (dots) between the dotted loads. Their exponents range from 2/3,
    which any fixed number of spheres has, to 1.35.
    """
    load = np.geomspace(0.5 * RANGE[0], 1.5 * RANGE[1], 200)
    for i, exponent in enumerate(EXPONENTS):
        design = designed(exponent)
        area = independent.areas(design.surface.height, load, RADIUS)
        ax.loglog(load, area, color=f"C{i}", label=f"{exponent:.3g}")
        ax.loglog(design.target_law.load, design.target_law.lower, "o", ms=2, color="black", zorder=3)
    for end in RANGE:
        ax.axvline(end, color=QUIET, lw=0.8, ls=":")
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("rescaled friction  F/(σB) [mm²]")
    ax.figure.legend(frameon=False, fontsize=8, loc="outside right upper", title="exponent")
