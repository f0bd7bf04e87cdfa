"""Laws beyond the paper's: friction proportional to the load, and heights on steps."""

from __future__ import annotations

from functools import cache

import numpy as np

import metafem as mf
from metafem.inversion import achievable_load_range
from metafem.reference import hertz
from validation.check import REQUIRED, Claim, Picture, Row, below
from validation.figures import panels
from validation.paper.surfaces import template
from validation.scenes.models import MODELS
from validation.sources import Source, closed_form

# Longer than a few seconds: three designs of many sampled loads.
SLOW = True

SLOPE, RADIUS, COUNT = 7.0, 0.526, 64

# Heights tall enough for all laws here [mm], and the paper's step of Fig. 4.
HEIGHT, STEP = 0.27, 0.006

STEPPED = {
    "three operating points": mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]),
    "power 0.8": mf.PowerLaw(0.8, (0.1, 0.4)),
    "power 1.2": mf.PowerLaw(1.2, (0.1, 0.4)),
    "slopes 9.5, then 7": mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26)),
}


@cache
def proportional(model: str) -> mf.Design:
    """Return the surface whose friction is proportional to the load."""
    lattice, limits = template("fig4_red"), mf.Limits(HEIGHT)
    ends = achievable_load_range(mf.LinearLaw(SLOPE), lattice, limits)
    return mf.design(mf.LinearLaw(SLOPE, ends), lattice, MODELS[model], limits)


@cache
def stepped(name: str) -> mf.Design:
    """Return a design whose heights are multiples of the paper's step."""
    return mf.design(STEPPED[name], template("fig4_red"), limits=mf.Limits(HEIGHT, height_step=STEP))


def claim() -> Claim:
    """The paper's linear laws have an intercept. Here a surface is designed whose friction is proportional to
    the load over most of the range that 64 asperities can have, under each model. Laws of other shapes are
    designed on height steps of 6 µm as the paper's mould had.
    """
    checks: list[Row] = []
    for name, model in MODELS.items():
        result = proportional(name)
        low, high = result.target.load_range
        load = np.geomspace(low, high, 200)
        ratio = model.curve(result.surface, load).area / (SLOPE * load)
        where = f"friction proportional to load, {name}: largest deviation at 200 loads"
        checks.append(below(where, float(np.abs(ratio - 1.0).max()), 0.01, REQUIRED))
    checks.append(below("largest over smallest load of that range", high / low, *_widest()))
    for name in STEPPED:
        checks.append(below(f"{name}, on steps of 6 µm: misfit", stepped(name).misfit, 0.01, REQUIRED))
    figures = {"friction over load, designed to be constant": Picture(_ratio)}
    return Claim("Laws of any shape, and steps", checks, figures)


def _widest() -> tuple[float, Source]:
    """Return the largest ratio of loads of a line through the origin, with its source."""
    # the radius of the contact that has the slope A/P = 3 π R/(4 a)
    a = 0.75 * np.pi * RADIUS / SLOPE
    first = hertz(a, RADIUS)[0]
    # the slope of 64 equal contacts is 2/3 of A/P, and no law is steeper at that load and area (Hölder)
    last = 2.0 / 3.0 * COUNT * first
    return last / first, closed_form(hertz, "one contact at the first load, 2N/3 times it at the last")


@panels(8.0, 3.4)
def _ratio(ax):
    """Rescaled friction over rescaled load, which a friction force in proportion to the load makes constant.
    Between the dotted loads each surface must follow the dashed target under the model for which it was
    designed; below the first one contact has too much friction, beyond the last all asperities are in
    contact.
    """
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
