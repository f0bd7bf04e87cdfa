"""Equations S1 to S8, compared with numerical integration and with their printed forms."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import quad

import metafem as mf
from metafem.inversion.height_density import PiecewiseExponential, TruncatedExponential, TwoBranchExponential
from metafem.reference import height_densities as printed
from validation.check import Check, Claim, below
from validation.paper.surfaces import fig3, template
from validation.published import PAPER

RADIUS, COUNT, TOP = 0.526, 64, 0.120
QUADRATURE = 1e-9  # accuracy of scipy.integrate.quad for integrands with a root at one end
PRINTED = 1e-9  # rounding error of the printed forms for x above 1e-3

INTERCEPT = f"{PAPER}, SM, building a quasi-linear friction law, α"


def claim() -> Claim:
    """Compare each closed form with an integral or with its printed form."""
    plain = [TruncatedExponential(TOP / x, TOP) for x in (1e-3, 0.1, 1.0, 3.0, 13.3, 100.0)]
    branched = [
        TwoBranchExponential(0.03568, TOP, 0.015338, 0.14941),
        TwoBranchExponential(0.03568, TOP, 0.011179, 0.24956),
        TwoBranchExponential(0.02, TOP, 0.05, 3.0),
    ]
    checks = [
        _points_equations(),
        *_integrals("truncated exponential", plain),
        *_integrals("two branches", branched),
    ]
    worst = max(abs(d.asymptotic_slope(RADIUS) / printed.slope(d.scale, RADIUS, TOP) - 1) for d in plain[1:])
    checks.append(below("S3–S5: slope against the printed form", worst, PRINTED, f"{PAPER}, eqs. S3 to S5"))
    worst = max(
        abs(d.intercept(COUNT, RADIUS) / printed.intercept(d.scale, RADIUS, TOP, COUNT) - 1)
        for d in plain[2:]
    )
    checks.append(below("intercept against the printed form", worst, PRINTED, INTERCEPT))
    for name, value in (("m_2", _second_slope_error), ("P_c", _crossover_error)):
        checks.append(
            below(
                f"S8: {name} against the printed form", max(map(value, branched)), PRINTED, f"{PAPER}, eq. S8"
            )
        )
    return Claim("Equations S1 to S8", checks)


def _points_equations() -> Check:
    """S1 holds if the law of the designed heights, summed here, passes through the points."""
    design, radius = fig3(), float(template("fig3").radius[0])
    height, worst = design.surface.height, 0.0
    for load, friction in zip(design.target.rescaled_load, design.target.rescaled_friction, strict=True):
        state = mf.equilibrium(design.surface, load=load * design.surface.material.composite_modulus)
        depth = np.clip(height - state.separation, 0.0, None)
        area, carried = np.pi * radius * depth.sum(), 4 / 3 * np.sqrt(radius) * (depth**1.5).sum()
        worst = max(worst, abs(area / friction - 1.0), abs(carried / load - 1.0))
    return below(
        "S1: both lines at the solution, relative", worst, 1e-9, f"{PAPER}, eq. S1, summed over the heights"
    )


def _integrals(name: str, densities: list[PiecewiseExponential]) -> list[Check]:
    worst = dict.fromkeys(("mass", "A0", "P"), 0.0)
    for density in densities:
        worst["mass"] = max(worst["mass"], abs(float(density.mass(0.0, TOP)) - 1.0))
        for delta in (0.0, 0.01, 0.06, 0.11):
            for what, power in (("A0", 1.0), ("P", 1.5)):
                closed = float(density.moment(power, delta))
                worst[what] = max(worst[what], abs(closed / _moment(density, power, delta) - 1.0))
    return [
        below(
            f"S2, {name}: {what} against quadrature",
            error,
            QUADRATURE,
            "eq. S2 integrated by scipy.integrate.quad",
        )
        for what, error in worst.items()
    ]


def _moment(density: PiecewiseExponential, power: float, delta: float) -> float:
    """Mean of (h - delta)^power by quadrature in t, h = delta + t^2, where the integrand is smooth."""

    def integrand(t: float) -> float:
        return 2.0 * t ** (2.0 * power + 1.0) * float(density.density(delta + t * t))

    ends = sorted({0.0, *(max(p.low - delta, 0.0) ** 0.5 for p in density.pieces), (TOP - delta) ** 0.5})
    return sum(quad(integrand, a, b, epsrel=1e-12, epsabs=0.0)[0] for a, b in pairwise(ends))


def _second_slope_error(d: TwoBranchExponential) -> float:
    form = printed.second_slope(d.scale, RADIUS, d.max_height, d.crossover_height, d.weight)
    return abs(d.asymptotic_slopes(RADIUS)[1] / form - 1.0)


def _crossover_error(d: TwoBranchExponential) -> float:
    form = printed.crossover_load(d.scale, RADIUS, d.max_height, d.crossover_height, d.weight, COUNT)
    return abs(d.crossover_load(COUNT, RADIUS) / form - 1.0)
