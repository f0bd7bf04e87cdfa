"""Misfits and times of designs under contact laws other than Hertz's, with interaction on the half-space.

The targets are those of the three demos, the law of a random surface, and a power law. A single quartic cap
has more friction than the demos' lines at light loads: its linear law has heights up to 0.3 mm in place of
0.12 mm, and its bilinear law also a crossover at 0.5 mm^2 in place of 0.038 mm^2. The misfit of linear and
bilinear laws is the root mean square difference from the law of the height density, whose slopes are the
target's; the fitted slopes differ from them by as much as that law is bent. With adhesion the misfit may
exceed 0.2 % by the area with which one contact jumps in, over the area at the lightest load of the target.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from validation.scenes.random_laws import LATTICE, RADIUS
from validation.timing import Row, took

QUARTIC, ADHESIVE = mf.PowerCap(4), mf.JKR(9e-6)

# Largest misfit [-] and time of a design [s].
MISFIT, SECONDS = 2e-3, 0.5

# Targets of each law with the limits of their heights.
Targets = dict[str, tuple[mf.OperatingPoints | mf.LinearLaw | mf.BilinearLaw | mf.PowerLaw, mf.Limits]]
POINTS = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]), mf.Limits(0.27)
POWER = mf.PowerLaw(0.8, (0.1, 0.4)), mf.Limits(0.3, offset=0.05)
OF_QUARTIC: Targets = {
    "operating points": POINTS,
    "linear": (mf.LinearLaw(6.87), mf.Limits(0.3, offset=0.084)),
    "bilinear": (mf.BilinearLaw((7.15, 12.52), 0.5), mf.Limits(0.3, offset=0.05)),
    "power": POWER,
}
OF_PARABOLOIDS: Targets = {
    "operating points": POINTS,
    "linear": (mf.LinearLaw(6.87), mf.Limits(0.12, offset=0.084)),
    "bilinear": (mf.BilinearLaw((7.15, 12.52), 0.0380), mf.Limits(0.12, offset=0.05)),
    "power": POWER,
}


def rows() -> list[Row]:
    """Measure designs of quartic caps, and of adhesive paraboloids with the interaction of point loads."""
    return [
        *_designs("quartic cap", mf.Interacting(contact=QUARTIC)),
        *_designs("adhesion, independent", mf.Independent(contact=ADHESIVE)),
        *_designs("adhesion, order 1", mf.Interacting(order=1, contact=ADHESIVE)),
    ]


def long_rows() -> list[Row]:
    """Measure designs of adhesive paraboloids that interact by order 3."""
    return _designs("adhesion, order 3", mf.Interacting(contact=ADHESIVE))


def _designs(name: str, model: mf.Independent | mf.Interacting) -> Iterator[Row]:
    contact = model.contact.for_material(LATTICE.material)
    targets = dict(OF_QUARTIC if model.contact == QUARTIC else OF_PARABOLOIDS)
    height, load = np.random.default_rng(0).exponential(0.03, LATTICE.count), np.linspace(0.02, 0.5, 30)
    area = mf.Independent(contact=contact).areas(LATTICE, load, height[None])[0]
    targets["sampled"] = mf.SampledLaw(load, area), mf.Limits(0.3, offset=0.05)
    # the area with which a contact jumps in; none without adhesion
    jump = float(contact.area(contact.contact_radius(0.0, RADIUS)))
    for kind, (target, limits) in targets.items():
        runs = [took(partial(mf.design, target, LATTICE, model, limits)) for _ in range(2)]
        design = runs[-1][1]
        law = design.target_law
        misfit = design.misfit if law.pointwise else law.misfit(design.target_area)
        allowed = MISFIT + jump / float(law.law(design.target_area)[0])
        yield Row(f"{kind}, {name}: misfit", allowed, misfit)
        yield Row(f"{kind}, {name}: time", SECONDS, min(seconds for seconds, _ in runs), "s")
