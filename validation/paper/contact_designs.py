"""The surfaces of Figs. 3 to 5 designed again under adhesive contacts, spheres and soft caps.

The densities of Figs. 4 and 5 are those of contacts without adhesion. Heights on the steps of Fig. 4 stay
where their density places them; without steps they are refined.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from validation.check import Check, Claim, reported
from validation.paper.contact_laws import model
from validation.paper.surfaces import fig3, fig4, fig5

# The tests of this claim carry the mark "slow".
SLOW = True

NAMES = ("w = 9 mJ/m²", "w = 27 mJ/m²", "spheres", "soft caps")

# The table of the soft cap ends below the indentations of Fig. 3.
LEFT_OUT = {("Fig. 3", "soft caps")}

THIS = "designs for independent asperities, this check"


@cache
def designs() -> dict[str, mf.Design]:
    """Return the designs under Hertz's law."""
    found = {"Fig. 3": fig3()}
    for figure, design in (("Fig. 4", fig4), ("Fig. 5", fig5)):
        found |= {f"{figure} {colour}": design(colour) for colour in ("blue", "red")}
    for colour in ("blue", "red"):
        printed = found[f"Fig. 4 {colour}"]
        limits = replace(printed.limits, height_step=None)
        found[f"Fig. 4 {colour} without steps"] = mf.design(printed.target, printed.template, limits=limits)
    return found


@cache
def again(figure: str, name: str) -> mf.Design:
    """Return the design for the same target under another contact law."""
    before = designs()[figure]
    chosen = model(name, before.surface.material)
    return mf.design(before.target, before.template, chosen, before.limits)


def change(figure: str, name: str) -> np.ndarray:
    """Changes of the heights in their order from the tallest [µm], of as many as both surfaces have."""
    after, before = (
        np.sort(design.surface.height)[::-1] for design in (again(figure, name), designs()[figure])
    )
    count = min(len(after), len(before))
    return 1e3 * (after[:count] - before[:count])


def claim() -> Claim:
    """Compare the heights, and report how well the designs meet their targets."""
    checks: list[Check] = []
    for figure, before in designs().items():
        for name in NAMES:
            if (figure, name) in LEFT_OUT:
                continue
            after, moved, label = again(figure, name), change(figure, name), f"{figure}, {name}"
            if figure == "Fig. 3":  # the others use all sites
                more = after.surface.count - before.surface.count
                checks.append(reported(f"{label}: additional asperities", more, THIS))
            checks += [
                reported(f"{label}: rms change of the heights [µm]", np.sqrt((moved**2).mean()), THIS),
                reported(f"{label}: largest change of a height [µm]", np.abs(moved).max(), THIS),
                reported(f"{label}: misfit [%]", 1e2 * after.misfit, THIS),
            ]
        checks.append(reported(f"{figure}, Hertz: misfit [%]", 1e2 * before.misfit, THIS))
    return Claim("Adhesion and the shape of caps change the designed heights", checks, {"heights": _figure})


def _figure():
    figure = new_figure(9.0, 3.4)
    for ax, name in zip(figure.subplots(1, 2, sharey=True), ("Fig. 3", "Fig. 5 blue"), strict=True):
        for law in NAMES:
            if (name, law) not in LEFT_OUT:
                ax.plot(np.sort(again(name, law).surface.height)[::-1] * 1e3, label=law)
        ax.plot(np.sort(designs()[name].surface.height)[::-1] * 1e3, "k--", label="Hertz")
        ax.set(xlabel="asperity, from the tallest", title=name)
    figure.axes[0].set_ylabel("height [µm]")
    figure.axes[0].legend(frameon=False)
    return figure
