"""Fig. 3: a law through three operating points."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem.report.figures import law_figure
from validation.check import Check, Claim, near
from validation.paper.surfaces import fig3, template
from validation.published import PAPER, paper

# Half of the last printed digit of the points.
LOAD_DIGIT, FRICTION_DIGIT = 5e-4, 5e-3

# Solution of eq. S1 for the printed points [µm]. tests/validation/test_expected_numbers.py solves it.
LEVELS, ADJUSTMENTS = (270.0, 180.4, 128.6), (240.8, 170.4, 107.4)

SOLVED = f"{PAPER}, eq. S1 for the printed points, solved by tests/validation/test_expected_numbers.py"
POINTS = f"{PAPER}, Fig. 3, operating points in SM"


def claim() -> Claim:
    """Design a surface from the operating points, and evaluate the printed one."""
    design, printed = fig3(), paper()["fig3"]
    found = design.parameters
    checks = [
        near(
            "largest relative error at the points",
            design.misfit,
            0,
            1e-9,
            f"{PAPER}, eq. S1: the law passes through the points",
        )
    ]
    for i in range(3):
        where = f"{PAPER}, SM, inversion scheme for operating points"
        checks += [
            near(f"n_{i + 1}", found["counts"][i], printed["counts"][i], 0, where),
            near(f"level {i + 1} [µm]", found["levels"][i] * 1e3, LEVELS[i], 0.05, SOLVED),
            near(
                f"adjustment {i + 1} [µm]",
                found["adjustment_heights"][i] * 1e3,
                ADJUSTMENTS[i],
                0.05,
                SOLVED,
            ),
        ]
    checks += _printed_surface(printed)
    return Claim("Fig. 3: three operating points", checks, {"law": lambda: law_figure(fig3())})


def _printed_surface(printed: dict) -> list[Check]:
    """Check that the law of the printed heights passes through the printed points, to the digits of both."""
    levels = np.repeat(printed["levels_um"], printed["counts"])
    height = np.concatenate([levels, printed["adjustment_um"]]) / 1e3
    lattice = template("fig3")
    surface = lattice.replaced(
        position=lattice.position[: len(height)], height=height, radius=lattice.radius[: len(height)]
    )
    modulus = surface.material.composite_modulus
    checks = []
    for load, friction in zip(printed["load_mm2"], printed["friction_mm2"], strict=True):
        at = [
            mf.equilibrium(surface, load=modulus * (load + step)).area
            for step in (-LOAD_DIGIT, 0, LOAD_DIGIT)
        ]
        tolerance = FRICTION_DIGIT + 0.5 * (at[2] - at[0])
        name = f"friction of the printed heights at P/E* = {load} [mm²]"
        checks.append(near(name, at[1], friction, tolerance, POINTS))
    return checks
