"""Laws beyond the paper's: friction proportional to the load, other tool radii, heights on steps."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import new_figure
from metafem.inversion.bounds import Bounds
from metafem.inversion.radii import Radii
from metafem.inversion.strategies.proportional import line_range
from validation.check import LINE_REQUIRED, REQUIRED, Check, Claim, below
from validation.paper.surfaces import template
from validation.published import PAPER
from validation.scenes.models import MODELS

SLOPE = 7.0

# Heights tall enough for all laws here [mm], and the paper's step of Fig. 4.
HEIGHT, STEP = 0.27, 0.006

STEPPED = {
    "three operating points": mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]),
    "power 0.8": mf.PowerLaw(0.8, (0.1, 0.4)),
    "power 1.2": mf.PowerLaw(1.2, (0.1, 0.4)),
    "slopes 9.5, then 7": mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26)),
}

# A friction coefficient below the least one of the paper's radius and heights, and three tool radii [mm].
LOW_COEFFICIENT, TOOLS = 0.9, [0.2, 0.3, 0.526]


@cache
def proportional(model: str) -> mf.Design:
    """Return the surface whose friction is proportional to the load."""
    lattice, limits = template("fig4_red"), mf.Limits(HEIGHT)
    ends = mf.achievable_load_range(mf.LinearLaw(SLOPE), lattice, limits)
    return mf.design(mf.LinearLaw(SLOPE, ends), lattice, MODELS[model], limits)


def claim() -> Claim:
    """Design each law and compare it with its target."""
    checks = []
    for name, model in MODELS.items():
        result = proportional(name)
        low, high = result.target.load_range
        load = np.geomspace(low, high, 200)
        ratio = model.curve(result.surface, load).area / (SLOPE * load)
        most = float(np.abs(ratio - 1.0).max())
        checks.append(
            below(
                f"friction proportional to load, {name}: largest deviation at 200 loads", most, 0.01, REQUIRED
            )
        )
    first, last = line_range(mf.LinearLaw(SLOPE), Bounds(mf.Hertz(), Radii.of(0.526), 64, 1.0))
    reached = high / low
    checks.append(
        Check(
            "largest over smallest load of that range",
            float(reached),
            f"at least 25, at most {last / first:.3g}",
            bool(25.0 <= reached <= last / first),
            "upper bound: one Hertz contact at the first load, 64 at the last; lower: requirement",
        )
    )
    for name, target in STEPPED.items():
        limits = mf.Limits(HEIGHT, height_step=STEP)
        misfit = mf.design(target, template("fig4_red"), limits=limits).misfit
        checks.append(below(f"{name}, on steps of 6 µm: misfit", misfit, 0.01, REQUIRED))
    pair = template("fig4_red")
    target = mf.LinearLaw.from_friction_coefficient(LOW_COEFFICIENT, pair.material, pair.friction)
    found = mf.design(target, pair, limits=mf.Limits(0.12, height_sd=0.0009), radii=TOOLS, common_radius=True)
    radius_source = (
        f"{PAPER}, lower bound 3π/4 √(R/h_m) σB/E* of μ: R below 0.35 mm, here a tool of 0.2 or 0.3 mm"
    )
    checks += [
        below(f"μ = {LOW_COEFFICIENT:g} with the best tool: misfit", found.misfit, 0.1, LINE_REQUIRED),
        below("its radius [mm]", found.parameters["radius"], 0.3, radius_source),
    ]
    return Claim("Laws of any shape, steps and tools", checks, {"proportional": _ratio})


def _ratio():
    figure = new_figure(8.0, 3.4)
    ax = figure.add_subplot()
    for name, model in MODELS.items():
        result = proportional(name)
        low, high = result.target.load_range
        load = np.geomspace(0.5 * low, 2.0 * high, 300)
        ax.semilogx(load, model.curve(result.surface, load).area / load, label=name)
    ax.axhline(SLOPE, color="grey", lw=0.8, ls="--", label="target")
    for end in (low, high):
        ax.axvline(end, color="grey", lw=0.8, ls=":")
    ax.set_ylim(0.8 * SLOPE, 1.2 * SLOPE)
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("A0 E*/P")
    ax.legend(frameon=False)
    return figure
