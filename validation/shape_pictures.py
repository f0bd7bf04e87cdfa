"""The pictures of the guide's page on shapes: profiles of caps, and the area of one contact of each."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import metafem as mf
from metafem.drawing import finished, new_figure, svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = Path(__file__).parent / "guide"

MATERIAL = mf.Material(1.36)
RADIUS = 0.5  # [mm]

# Radius within which the top of a cap is nearly flat [mm].
EDGE = 0.15


def flat_top(rho):
    """Return the depth [mm] of a paraboloid whose top is nearly flat, at distances rho [mm]."""
    return rho**6 / (rho**4 + EDGE**4) / (2.0 * RADIUS)


CAPS = {
    "sphere": mf.Sphere(),
    "paraboloid": mf.Paraboloid(),
    "power 1.2": mf.Power(1.2),
    "power 4": mf.Power(4.0),
    "profile, flat top": mf.Profile(flat_top, extent=0.45),
}


def caps_figure() -> Figure:
    """Draw the profiles of five caps of R = 0.5 mm, and the areas of one contact of each."""
    figure = new_figure(9.0, 3.6)
    left, right = figure.subplots(1, 2)
    load = np.geomspace(1e-3, 0.1, 41)  # [N]
    for name, cap in CAPS.items():
        end = float(cap.foot_radius(np.array([0.12]), np.array([RADIUS]))[0])
        rho = end * np.linspace(0.0, 1.0, 101)
        left.plot(rho, -cap.depth_at(rho, RADIUS), label=name)
        surface = mf.Surface([[0.0, 0.0]], [0.12], RADIUS, MATERIAL, cap=cap)
        law = mf.friction_law(surface, mf.Independent(contact=mf.Elastic()), load=load)
        exponent = np.log(law.area[1] / law.area[0]) / np.log(load[1] / load[0])
        right.loglog(law.load, law.area, label=f"{name}: exponent {exponent:.2f}")
    left.set(xlabel="distance from the axis [mm]", ylabel="depth below the summit [mm]")
    right.set(xlabel="load of one contact [N]", ylabel="area [mm²]", ylim=(1e-3, 0.6))
    left.legend(frameon=False)
    right.legend(frameon=False, title="at the smallest load")
    return finished(figure)


# Exponents of power laws over a range of loads P/E* [mm²], of which spheres of one radius reach those from
# 2/3 to about 1.44.
EXPONENTS, LOADS = (0.35, 0.5, 2.0 / 3.0, 1.0, 1.35, 1.8), (0.1, 0.4)


def laws_figure() -> Figure:
    """Draw designs of power laws with caps of exponents from 1.2 to 6, and the exponents that they use."""
    template = mf.Surface.square_lattice(0.12, radius=RADIUS, material=MATERIAL)
    limits, tools = mf.Limits(0.27, offset=0.05), mf.PowerRange(1.2, 6.0)
    figure = new_figure(9.0, 3.6)
    left, right = figure.subplots(1, 2)
    for i, exponent in enumerate(EXPONENTS):
        design = mf.design(mf.PowerLaw(exponent, LOADS), template, limits=limits, tools=tools)
        load = np.geomspace(*LOADS, 30)
        law = design.law.model.curve(design.surface, load).area
        label = f"{exponent:.2f}: misfit {100.0 * design.misfit:.2g} %"
        left.loglog(load, law / law[0], color=f"C{i}", label=label)
        left.loglog(LOADS, np.array([1.0, (LOADS[1] / LOADS[0]) ** exponent]), "o", ms=4, color=f"C{i}")
        used = [getattr(design.surface.cap.one(k), "exponent", 2.0) for k in range(design.surface.count)]
        value, count = np.unique(used, return_counts=True)
        right.scatter(np.full(len(value), exponent), value, 4.0 * count, color=f"C{i}")
    left.set(xlabel="rescaled load P/E* [mm²]", ylabel="friction over the first")
    left.legend(frameon=False, title="exponent of the target")
    right.set(xlabel="exponent of the target", ylabel="exponents of the caps (size: number)")
    return finished(figure)


def renew_pictures() -> None:
    """Write the pictures into the folder of the guide."""
    (FOLDER / "laws.svg").write_text(svg(laws_figure(), "Power laws by caps of several exponents"), "utf-8")
    (FOLDER / "caps.svg").write_text(svg(caps_figure(), "Caps and the areas of their contacts"), "utf-8")


if __name__ == "__main__":
    renew_pictures()
