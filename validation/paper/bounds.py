"""The friction coefficients that a material pair and a workshop can reach."""

from __future__ import annotations

import metafem as mf
from metafem.inversion.height_density import slope_excess
from validation.check import Claim, near
from validation.paper.surfaces import template
from validation.published import PAPER, paper


def claim() -> Claim:
    """Compute both bounds with the paper's parameters, and the limits of the slope."""
    printed = paper()
    smallest = printed["bounds"]["smallest_friction_coefficient"]
    largest = printed["bounds"]["largest_friction_coefficient"]
    limits = mf.Limits(0.120, height_sd=printed["sample"]["depth_precision_um"] / 1e3)
    low, high = mf.achievable_friction_coefficients(template("fig4_red"), limits)
    where = f"{PAPER}, supplementary text"
    checks = [
        near("smallest friction coefficient", low, smallest, 0.005, where),
        near("largest friction coefficient", high, largest, 0.005, where),
        near("the same to four digits: smallest", low, 1.104, 5e-4, "independent computation"),
        near("the same to four digits: largest", high, 3.032, 5e-4, "independent computation"),
        near("excess of the slope at h_m/λ = 1e-9", float(slope_excess(1e-9)), 1e-10, 1e-19, "series: x/10"),
    ]
    return Claim("Bounds on the friction coefficient", checks)
