"""Bounds of the friction coefficient for a material pair and the manufacturing limits."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem import reference
from metafem.drawing import ACHIEVED, QUIET, TARGET
from metafem.inversion.density import ExponentialDensity, slope_excess
from validation.check import Claim, Picture, near
from validation.figures import panels
from validation.paper.pictures import INKS
from validation.paper.surfaces import RADIUS, friction_of_slope, template
from validation.published import paper
from validation.sources import closed_form, printed

TOP = 0.120

# Two evaluations of a closed form with different rounding.
ROUNDING = 1e-9


def claim() -> Claim:
    """The friction coefficient μ = σB/E* · m of a truncated exponential density of heights is computed over
    its scale λ, for σ = 0.358 MPa, B = 0.85, E* = 1.36 MPa, R = 526 µm and h_m = 120 µm. It falls towards the
    value of a uniform density as λ grows. The largest value belongs to the smallest λ that the workshop can
    make, ten standard deviations of its heights (9 µm), a rule of thumb of the paper.
    """
    numbers = paper()["bounds"]
    surface = template("fig4_red")
    limits = mf.Limits(TOP, height_sd=paper()["sample"]["depth_precision_um"] / 1e3)
    low, high = mf.achievable_friction_coefficients(surface, limits)
    factor = friction_of_slope(surface)
    finest = numbers["smallest_scale_um"] / 1e3
    where = "SM, bounds on achievable friction coefficients"
    tiny = 1e-9
    ends = {"smallest friction coefficient": low, "largest friction coefficient": high}
    checks = [
        *(
            near(name, value, numbers[name.replace(" ", "_")], 0.005, printed(where, name))
            for name, value in ends.items()
        ),
        near(
            "smallest friction coefficient, all digits", low,
            factor * reference.smallest_slope(RADIUS, TOP), ROUNDING,
            closed_form(reference.smallest_slope, "μ = σB/E* · 3π/4 √(R/h_m)"),
        ),
        near(
            "largest friction coefficient, all digits", high,
            factor * reference.slope(finest, RADIUS, TOP), ROUNDING,
            closed_form(reference.slope, "μ = σB/E* · m, eqs. S3 to S5 at λ = 9 µm"),
        ),
        near(
            "nearly uniform density, h_m/λ = 1e-9: slope over that of the uniform one, minus 1",
            float(slope_excess(tiny)), reference.slope_series(tiny), ROUNDING * tiny,
            closed_form(reference.slope_series, "series x/10 + 13 x²/1050 in x = h_m/λ"),
        ),
    ]  # fmt: skip
    return Claim("Bounds on the friction coefficient", checks, {"Friction coefficient": Picture(_figure)})


@panels(7.0, 3.6)
def _figure(ax):
    """Friction coefficient μ over the scale λ of the density [µm], on logarithmic axes. The curve runs
    between the two bounds that the paper prints (dashed lines, 1.10 and 3.03), and meets the upper one at λ =
    9 µm (dotted line). The square is the red surface of Fig. 4, designed for m = 6.87.
    """
    surface, numbers = template("fig4_red"), paper()["bounds"]
    factor = friction_of_slope(surface)
    scale = np.geomspace(0.005, 1.0, 200)
    slope = [ExponentialDensity(x, TOP).asymptotic_slope(RADIUS) for x in scale]
    ax.loglog(1e3 * scale, factor * np.array(slope), color=ACHIEVED, label="density of heights")
    for name in ("smallest", "largest"):
        label = "bounds printed in the paper" if name == "smallest" else None
        ax.axhline(numbers[f"{name}_friction_coefficient"], color=TARGET, ls="--", lw=1.2, label=label)
    ax.axvline(numbers["smallest_scale_um"], color=QUIET, ls=":", label="smallest scale that can be made")
    red = paper()["fig4"]["red"]
    coefficient, ink = factor * red["target_slope"], INKS["Fig. 4 red"]
    ax.plot(red["scale_um"], coefficient, "s", color=ink, label="Fig. 4, red surface")
    ax.set(xlabel="scale of the density  λ [µm]", ylabel="friction coefficient  μ")
    ax.set_yticks([1.0, 2.0, 3.0, 4.0], ["1", "2", "3", "4"])
    ax.minorticks_off()
