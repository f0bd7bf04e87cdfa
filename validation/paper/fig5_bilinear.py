"""Fig. 5: two bilinear laws."""

from __future__ import annotations

import metafem as mf
from metafem.report.figures import law_figure
from validation.check import Claim, below, near
from validation.paper.surfaces import fig5
from validation.published import PAPER, paper

# The fits of the discrete laws depend on the range of the loads, which the paper does not print. 10 % is the
# agreement that it reports for the ratio of the crossover loads, the largest deviation that it accepts.
DISCRETE = 0.10

ACCEPTED = f"{PAPER}, main text: 10 %, the largest deviation that it reports"
TARGET = f"{PAPER}, targets in SM, building a bilinear friction law"


def claim() -> Claim:
    """Compare the densities and the laws of 64 asperities with the targets."""
    checks = []
    for colour in ("red", "blue"):
        design = fig5(colour)
        target, radius = design.target, float(design.surface.radius[0])
        slopes = design.density.asymptotic_slopes(radius)
        crossover = design.density.crossover_load(design.surface.count, radius)
        touching = mf.equilibrium(design.surface, separation=design.parameters["crossover_height"])
        discrete = touching.load / design.surface.material.composite_modulus
        for i in (0, 1):
            checks.append(
                near(f"{colour}: slope m_{i + 1} of the density", slopes[i], target.slopes[i], 1e-9, TARGET)
            )
            deviation = abs(design.fits[i][1].slope / target.slopes[i] - 1.0)
            checks.append(
                below(
                    f"{colour}: deviation of the fitted slope {i + 1}",
                    deviation,
                    DISCRETE,
                    ACCEPTED,
                )
            )
        checks += [
            near(f"{colour}: crossover of the density", crossover, target.crossover_load, 1e-9, TARGET),
            below(
                f"{colour}: deviation of the crossover load of 64 asperities",
                abs(discrete / target.crossover_load - 1.0),
                DISCRETE,
                ACCEPTED,
            ),
        ]
    targets = [paper()["fig5"][colour]["crossover_load_mm2"] for colour in ("blue", "red")]
    checks.append(
        near(
            "ratio of the target crossover loads", targets[0] / targets[1], 1.94, 0.005, f"{PAPER}, main text"
        )
    )
    figures = {colour: lambda colour=colour: law_figure(fig5(colour)) for colour in ("red", "blue")}
    return Claim("Fig. 5: bilinear laws", checks, figures)
