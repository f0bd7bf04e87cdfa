"""Bounds of the friction coefficient for a material pair and the manufacturing limits."""

from __future__ import annotations

import metafem as mf
from metafem.inversion.height_density import slope_excess
from validation.check import Claim, near
from validation.paper.surfaces import template
from validation.published import PAPER, paper

# Both bounds by the closed forms of the paper. tests/validation/test_expected_numbers.py evaluates them.
TO_FOUR_DIGITS = (1.104, 3.032)


def claim() -> Claim:
    """Compute both bounds with the paper's parameters, and the slope of a nearly uniform density."""
    printed = paper()
    smallest = printed["bounds"]["smallest_friction_coefficient"]
    largest = printed["bounds"]["largest_friction_coefficient"]
    limits = mf.Limits(0.120, height_sd=printed["sample"]["depth_precision_um"] / 1e3)
    low, high = mf.achievable_friction_coefficients(template("fig4_red"), limits)
    where = f"{PAPER}, SM, bounds on achievable friction coefficients"
    checks = [
        near("smallest friction coefficient", low, smallest, 0.005, where),
        near("largest friction coefficient", high, largest, 0.005, where),
        near("smallest, to four digits", low, TO_FOUR_DIGITS[0], 5e-4, "closed form 3π/4 √(R/h_m) σB/E*"),
        near("largest, to four digits", high, TO_FOUR_DIGITS[1], 5e-4, f"{PAPER}, eq. S3 at λ = 9 µm"),
        near(
            "excess of the slope at h_m/λ = 1e-9",
            float(slope_excess(1e-9)),
            1e-10,
            1e-19,
            "series of eqs. S3 to S5 in x = h_m/λ: slope = 3π/4 √(R/h_m) (1 + x/10 + …)",
        ),
    ]
    return Claim("Bounds on the friction coefficient", checks)
