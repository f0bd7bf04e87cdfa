"""What adhesion and the shape of the caps change in the laws of the surfaces of Figs. 3 to 5.

The paper fits E* and the adhesion energy w to single contacts by JKR's theory, and predicts by Hertz's law.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from validation.check import Check, Claim, near, reported
from validation.paper.surfaces import fig4, fig5, surfaces
from validation.published import PAPER, paper

# The tests of this claim carry the mark "slow".
SLOW = True

# Loads P/E* [mm²], from the lightest measured ones to loads beyond full contact of all surfaces.
LOADS = 0.7 * np.arange(1, 21) / 20

# The paper's adhesion energy, and three times that [N/mm].
ENERGY = paper()["sample"]["adhesion_energy_mJ_per_m2"] * 1e-6
LAWS = {
    "w = 9 mJ/m²": mf.JKR(ENERGY),
    "w = 27 mJ/m²": mf.JKR(3.0 * ENERGY),
    "spheres": mf.SphericalCap(),
    "spheres with w = 9 mJ/m²": mf.JKR(ENERGY, mf.SphericalCap()),
    "soft caps": None,  # of the table, for each material
}

# Part of the table's range that is left for what the law of the surface indents more than Hertz's.
MARGIN = 0.1

# P/E* and A of a soft cap at large strain, in mm² for E* = 1 MPa.
TABLE = Path(__file__).parents[2] / "meshes" / "soft_cap.csv"

# Rms change of A0 in percent. tests/validation/test_expected_numbers.py computes it.
RMS = {
    ("Fig. 3", "w = 9 mJ/m²"): 5.87,
    ("Fig. 3", "w = 27 mJ/m²"): 10.57,
    ("Fig. 3", "spheres"): 3.66,
    ("Fig. 4 blue", "w = 9 mJ/m²"): 8.54,
    ("Fig. 4 blue", "w = 27 mJ/m²"): 15.42,
    ("Fig. 4 blue", "spheres"): 1.95,
    ("Fig. 4 red", "w = 9 mJ/m²"): 6.83,
    ("Fig. 4 red", "w = 27 mJ/m²"): 12.23,
    ("Fig. 4 red", "spheres"): 2.48,
    ("Fig. 5 blue", "w = 9 mJ/m²"): 8.58,
    ("Fig. 5 blue", "w = 27 mJ/m²"): 15.59,
    ("Fig. 5 blue", "spheres"): 2.04,
    ("Fig. 5 red", "w = 9 mJ/m²"): 8.76,
    ("Fig. 5 red", "w = 27 mJ/m²"): 15.96,
    ("Fig. 5 red", "spheres"): 1.93,
}
NUMPY = "sums of JKR's closed form and of Sneddon's, by tests/validation/test_expected_numbers.py"
THIS = "independent asperities, this check"

# Force at which the paper states the largest effect of adhesion [N], and that effect.
LIGHT, STATED = 0.01, 0.02
CLAIMED = f"{PAPER}, SM, calibration of individual microcontacts: less than 2 % above 0.01 N"


def model(name: str, material: mf.Material) -> mf.Independent:
    """Return independent asperities of a law."""
    if LAWS[name] is not None:
        return mf.Independent(contact=LAWS[name])
    indentation, load, area = np.loadtxt(TABLE, delimiter=",", skiprows=1).T
    return mf.Independent(contact=mf.TabulatedContact(indentation, load * material.composite_modulus, area))


@cache
def changes(surface: str, name: str, coupled: bool = False) -> np.ndarray:
    """Relative change of A0 at the loads (k,); nan beyond the range of the table."""
    found = surfaces()[surface]
    force = found.material.composite_modulus * LOADS
    chosen = model(name, found.material)
    before = mf.friction_law(found, load=force)
    most = float(chosen.contact.largest_indentation(found.radius[0]))
    within = found.height.max() - before.separation < (1.0 - MARGIN) * most
    if coupled:
        chosen = mf.Interacting(contact=chosen.contact)
        before = mf.friction_law(found, mf.Interacting(), load=force)
    change = np.full(len(LOADS), np.nan)
    change[within] = mf.friction_law(found, chosen, load=force[within]).area / before.area[within] - 1.0
    return change


def rms(change: np.ndarray) -> float:
    """Root mean square over the loads."""
    return float(np.sqrt(np.nanmean(change**2)))


def slopes(design: mf.Design, chosen: mf.Independent) -> list[float]:
    """Slopes of the law of a design's surface over the ranges of its branches."""
    modulus, found = design.surface.material.composite_modulus, []
    for branch, _ in design.fits:
        low, high = branch.load_range
        law = mf.friction_law(design.surface, chosen, load=modulus * np.linspace(low, high, 100))
        found.append(law.fit((low, high)).slope)
    return found


def claim() -> Claim:
    """Compute the changes of the areas and of the slopes."""
    checks = _one_contact()
    for surface in surfaces():
        for name in LAWS:
            change, label = changes(surface, name), f"{surface}, {name}"
            if (surface, name) in RMS:
                expected = RMS[surface, name]
                checks.append(
                    near(f"{label}: rms change of A0 [%]", 1e2 * rms(change), expected, 0.005, NUMPY)
                )
            else:
                checks.append(reported(f"{label}: rms change of A0 [%]", 1e2 * rms(change), THIS))
            worst = change[np.nanargmax(np.abs(change))]
            checks.append(reported(f"{label}: largest change of A0 [%]", 1e2 * worst, THIS))
    for surface in ("Fig. 5 blue", "Fig. 5 red"):
        name = next(iter(LAWS))
        value = rms(changes(surface, name, coupled=True))
        label = f"{surface}, {name}, with interaction: rms change of A0 [%]"
        checks.append(reported(label, 1e2 * value, "order 3 on a half-space, this check"))
    for figure, design in (("4", fig4), ("5", fig5)):
        for colour in ("blue", "red"):
            found = design(colour)
            before = slopes(found, mf.Independent())
            for name in LAWS:
                after = slopes(found, model(name, found.surface.material))
                for i, (old, new) in enumerate(zip(before, after, strict=True)):
                    which = f" {i + 1}" if len(before) > 1 else ""
                    label = f"Fig. {figure} {colour}, {name}: change of the fitted slope{which} [%]"
                    checks.append(reported(label, 1e2 * (new / old - 1.0), THIS))
    return Claim("Adhesion and the shape of caps change A0(P)", checks, {"changes": _figure})


def _one_contact() -> list[Check]:
    """Compare one contact by JKR's theory and by Hertz's law, as the paper does."""
    material = surfaces()["Fig. 3"].material
    one = mf.Surface([[0.0, 0.0]], [0.1], 0.526, material)
    force = np.concatenate([[LIGHT], np.geomspace(0.02, 0.5, 400)])
    adhesive, plain = (
        mf.friction_law(one, chosen, load=force).area
        for chosen in (mf.Independent(contact=mf.JKR(ENERGY)), mf.Independent())
    )
    change = adhesive / plain - 1.0
    pull = 3.0 * np.pi * ENERGY * 0.526
    exact = (1.0 + (pull + np.sqrt(2.0 * pull * LIGHT + pull**2)) / LIGHT) ** (2.0 / 3.0) - 1.0
    name = f"one contact at {LIGHT} N, w = 9 mJ/m²: change of A [%]"
    return [
        near(name, 1e2 * change[0], 1e2 * exact, 1e-9, "JKR's closed form, doi:10.1098/rspa.1971.0141"),
        reported("the same, as the paper states it: less than [%]", 1e2 * STATED, CLAIMED),
        reported("load above which the change is less than 2 % [N]", force[change > STATED][-1], THIS),
    ]


def _figure():
    figure = new_figure(9.0, 3.4)
    for ax, surface in zip(figure.subplots(1, 2, sharey=True), ("Fig. 4 blue", "Fig. 5 blue"), strict=True):
        for name in LAWS:
            ax.plot(LOADS, 1e2 * changes(surface, name), label=name)
        ax.axhline(0.0, color="grey", lw=0.8)
        ax.set(xlabel="rescaled load  P/E* [mm²]", title=surface)
    figure.axes[0].set_ylabel("change of A0 [%]")
    figure.axes[0].legend(frameon=False)
    return figure
