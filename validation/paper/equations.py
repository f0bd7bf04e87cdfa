"""Equations S1 to S8, compared with numerical integration and with their printed forms."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import metafem as mf
from metafem import reference
from metafem.inversion.density import ExponentialDensity
from validation.check import Check, Claim, below
from validation.methods.densities import mean_power
from validation.methods.independent import sums
from validation.paper.surfaces import fig3, template
from validation.sources import closed_form, known_input, second_method

RADIUS, COUNT, TOP = 0.526, 64, 0.120
QUADRATURE = 1e-11  # accuracy of scipy.integrate.quad, asked for 1e-12
PRINTED = 1e-12  # rounding error of the printed forms for x above 0.1

# Arguments h_m/λ of the densities with one branch, and scale [mm], crossover height [mm] and weight of those
# with two.
ARGUMENTS = (1e-3, 0.1, 1.0, 3.0, 13.3, 100.0)
BRANCHES = ((0.03568, 0.015338, 0.14941), (0.03568, 0.011179, 0.24956), (0.02, 0.05, 3.0))

# Separations of the integrals of eq. S2 [mm].
SEPARATIONS = (0.0, 0.01, 0.06, 0.11)


def claim() -> Claim:
    """The design evaluates the paper's equations in forms that lose no digits. Here each is compared with its
    printed form, or with numerical integration: the two lines of eq. S1 at the designed points of Fig. 3, the
    integrals of eq. S2 for six densities of one branch and three of two, the slope and intercept of eqs. S3
    to S5, and both lines of eq. S8. The largest relative errors over all cases are listed.
    """
    plain = [ExponentialDensity(TOP / x, TOP) for x in ARGUMENTS]
    branched = [ExponentialDensity(scale, TOP, height, weight) for scale, height, weight in BRANCHES]
    slopes = [d.asymptotic_slope(RADIUS) / reference.slope(d.scale, RADIUS, TOP) for d in plain[1:]]
    intercepts = [
        d.intercept(COUNT, RADIUS) / reference.intercept(d.scale, RADIUS, TOP, COUNT) for d in plain[2:]
    ]
    firsts = [d.asymptotic_slopes(RADIUS)[0] / reference.slope(d.scale, RADIUS, TOP) for d in branched]
    seconds = [d.asymptotic_slopes(RADIUS)[1] / reference.second_slope(*_printed(d)) for d in branched]
    loads = [
        d.crossover_load(COUNT, RADIUS) / reference.crossover_load(*_printed(d), COUNT) for d in branched
    ]
    printed = (
        ("S3 to S5: slope m", slopes, reference.slope, "eqs. S3 to S5 as printed"),
        ("intercept α", intercepts, reference.intercept, "α as printed in SM, quasi-linear friction law"),
        ("S7: first slope m_1", firsts, reference.slope, "eq. S7, eqs. S3 to S5 as printed"),
        ("S8: second slope m_2", seconds, reference.second_slope, "first line of eq. S8 as printed"),
        ("S8: crossover load P_c", loads, reference.crossover_load, "second line of eq. S8 as printed"),
    )
    checks = [
        _points_equations(),
        *_integrals("one branch", plain, [(TOP / x, 0.0, 1.0) for x in ARGUMENTS]),
        *_integrals("two branches", branched, BRANCHES),
        *(
            below(f"{name}, relative error", np.abs(np.subtract(ratios, 1.0)).max(), PRINTED,
                  closed_form(function, words))
            for name, ratios, function, words in printed
        ),
    ]  # fmt: skip
    return Claim("Equations S1 to S8", checks)


def _printed(d: ExponentialDensity) -> tuple[float, float, float, float, float]:
    return d.scale, RADIUS, d.max_height, d.crossover_height, d.weight


def _points_equations() -> Check:
    """S1 holds if the law of the designed heights, summed here, passes through the points."""
    design, radius = fig3(), float(template("fig3").radius[0])
    worst = 0.0
    for load, friction in zip(design.target.rescaled_load, design.target.rescaled_friction, strict=True):
        state = mf.equilibrium(design.surface, load=load * design.surface.material.composite_modulus)
        area, carried = sums(design.surface.height - state.separation, radius)
        worst = max(worst, abs(area / friction - 1.0), abs(carried / load - 1.0))
    source = second_method(sums, "the printed points, and both sums of eq. S1 over the designed heights")
    return below("S1: both lines at the solution, relative error", worst, 1e-9, source)


def _integrals(
    name: str, densities: Sequence[ExponentialDensity], parameters: Sequence[tuple[float, float, float]]
) -> list[Check]:
    """Compare mass, area and load of densities with quadrature."""
    worst = dict.fromkeys(("A0", "P"), 0.0)
    mass = max(abs(float(density.mass(0.0, TOP)) - 1.0) for density in densities)
    for density, (scale, height, weight) in zip(densities, parameters, strict=True):
        for delta in SEPARATIONS:
            for what, power in (("A0", 1.0), ("P", 1.5)):
                expected = mean_power(scale, power, delta, TOP, height, weight)
                worst[what] = max(worst[what], abs(float(density.moment(power, delta)) / expected - 1.0))
    source = second_method(mean_power, "eq. S2 with the density of eq. S6, by quadrature")
    return [
        below(f"S6, {name}: mass of the density minus 1", mass, QUADRATURE,
              known_input("identity: the mass of a probability density is 1")),
        *(
            below(f"S2, {name}: {what}, relative error", error, QUADRATURE, source)
            for what, error in worst.items()
        ),
    ]  # fmt: skip
