"""Fig. 4: two linear laws of one material pair."""

from __future__ import annotations

from metafem.report.figures import law_figure
from validation.check import Claim, near
from validation.paper.surfaces import fig4
from validation.published import PAPER, paper

# Slopes over 25 to 100 % of the load at which the plane reaches the lowest height of the density. The paper
# does not print its range; tests/validation/test_expected_numbers.py fits the heights of Table S1 with numpy.
FITTED = {"blue": 9.42, "red": 6.91}

# The slope of the law of 64 asperities varies: the fit changes by this with the number of points.
SAMPLING = 0.01

TABLE = "line through the law of Table S1's heights, by tests/validation/test_expected_numbers.py"


def claim() -> Claim:
    """Fit the predicted laws and compare them with the targets and the measurements."""
    checks = []
    for colour, slope in FITTED.items():
        design, printed = fig4(colour), paper()["fig4"][colour]
        fit = design.fits[0][1]
        measured, error = printed["measured_slope"]
        friction, modulus = design.surface.friction, design.surface.material.composite_modulus
        coefficient = friction.shear_strength * friction.area_ratio / modulus * measured
        where = f"{PAPER}, Fig. 4 caption"
        checks += [
            near(
                f"{colour}: asymptotic slope of the density",
                design.density.asymptotic_slope(float(design.surface.radius[0])),
                printed["target_slope"],
                1e-9,
                f"{where}, target slope",
            ),
            near(f"{colour}: fitted slope of 64 asperities", fit.slope, slope, SAMPLING, TABLE),
            near(f"{colour}: fitted slope and measured slope", fit.slope, measured, error, f"{where}, m_f"),
            near(
                f"{colour}: friction coefficient from the measured slope",
                coefficient,
                printed["measured_friction_coefficient"],
                0.005,
                where,
            ),
        ]
    figures = {colour: lambda colour=colour: law_figure(fig4(colour)) for colour in FITTED}
    return Claim("Fig. 4: linear laws", checks, figures)
