"""Table S1: numbers of asperities on the height levels of the two linear laws."""

from __future__ import annotations

import numpy as np

from metafem.drawing import new_figure
from validation.check import Claim, near
from validation.paper.surfaces import fig4
from validation.published import PAPER, paper, table


def claim() -> Claim:
    """Design both surfaces from their slopes and count the asperities on each level."""
    printed, parameters = table("table_s1"), paper()["fig4"]
    checks = []
    for colour in ("blue", "red"):
        design = fig4(colour)
        counts = np.zeros_like(printed["height"])
        levels = (design.parameters["levels"] - design.limits.offset) * 1e3
        counts[np.searchsorted(printed["height"], levels - 1.0)] = design.parameters["counts"]
        wrong = np.count_nonzero(counts != printed[f"count_{colour}"])
        scale = design.parameters["scale"] * 1e3
        checks += [
            near(f"{colour}: levels with another number of asperities", wrong, 0, 0, f"{PAPER}, Table S1"),
            near(f"{colour}: scale λ [µm]", scale, parameters[colour]["scale_um"], 0.5, f"{PAPER}, Table S1"),
        ]
    return Claim("Table S1: levels of the linear laws", checks, {"numbers": _figure})


def _figure():
    figure = new_figure(7.0, 3.2)
    for ax, colour in zip(figure.subplots(1, 2, sharey=True), ("blue", "red"), strict=True):
        design, printed = fig4(colour), table("table_s1")
        levels = (design.parameters["levels"] - design.limits.offset) * 1e3
        ax.bar(
            levels, design.parameters["counts"], width=5.0, color=f"tab:{colour}", alpha=0.5, label="designed"
        )
        ax.plot(printed["height"], printed[f"count_{colour}"], "k_", ms=8, label="Table S1")
        ax.set_xlabel("height above the offset [µm]")
        ax.legend(frameon=False)
    figure.axes[0].set_ylabel("asperities")
    return figure
