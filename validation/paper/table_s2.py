"""Table S2: the heights of the two bilinear laws."""

from __future__ import annotations

import numpy as np

from metafem.drawing import new_figure
from validation.check import Claim, below, near
from validation.paper.surfaces import fig5
from validation.published import PAPER, table

# Half of the last printed digit, and the effect of the last digits of the printed slopes and crossover loads.
HEIGHT_TOLERANCE_UM = 0.12

# Weight, crossover height [µm] and asperities above and below it: eqs. S7 and S8 for the printed targets.
# tests/validation/test_expected_numbers.py solves them.
EXPECTED = {"red": (0.14941, 15.338, 6, 58), "blue": (0.24956, 11.179, 12, 52)}

SCALE_UM = 35.680


def claim() -> Claim:
    """Design both surfaces from their slopes and crossover loads and compare the heights."""
    checks = []
    for colour, (weight, crossover, upper, lower) in EXPECTED.items():
        design = fig5(colour)
        found = design.parameters
        height = (found["crossover_height"] - design.limits.offset) * 1e3
        source = f"{PAPER}, eqs. S7 and S8 for Fig. 5, solved by tests/validation/test_expected_numbers.py"
        checks += [
            below(
                f"{colour}: largest difference of 64 heights [µm]",
                _difference(design, colour).max(),
                HEIGHT_TOLERANCE_UM,
                f"{PAPER}, Table S2",
            ),
            near(f"{colour}: weight u", found["weight"], weight, 5e-6, source),
            near(f"{colour}: crossover height [µm]", height, crossover, 5e-4, source),
            near(f"{colour}: asperities above the crossover", found["counts"][0], upper, 0, source),
            near(f"{colour}: asperities below the crossover", found["counts"][1], lower, 0, source),
            near(f"{colour}: scale λ [µm]", found["scale"] * 1e3, SCALE_UM, 5e-4, source),
        ]
    return Claim("Table S2: heights of the bilinear laws", checks, {"heights": _figure})


def _difference(design, colour: str) -> np.ndarray:
    return np.abs(np.sort(design.surface.height) * 1e3 - np.sort(table("table_s2")[colour]))


def _figure():
    figure = new_figure(6.0, 3.2)
    ax = figure.add_subplot()
    for colour in EXPECTED:
        ax.plot(_difference(fig5(colour), colour), ".", color=f"tab:{colour}", label=colour)
    ax.axhline(HEIGHT_TOLERANCE_UM, color="grey", lw=0.8)
    ax.set_xlabel("asperity, by height")
    ax.set_ylabel("difference from Table S2 [µm]")
    ax.legend(frameon=False)
    return figure
