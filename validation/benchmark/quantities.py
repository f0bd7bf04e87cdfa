"""Stiffness, conductance and pull-off force against Barber's identity, resolved contacts and closed forms.

The exact stiffness is that of the Hessian of the energy of interacting contacts; the conductance is computed
from discs. On a layer, the discs of two methods of the influence are compared: the Hankel integral and the
series of images.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

import metafem as mf
from metafem.substrate import GroundedLayer
from validation.fidelity.order3_against_resolved import irregular
from validation.scenes.quantities import (
    BLOCK,
    CELL,
    ENERGY,
    LOADS,
    MATERIAL,
    RADIUS,
    THICKNESS,
    by_images,
    discs_by_images,
    error,
    exact_stiffness,
)
from validation.timing import Row, best

# Number of lattices of 64 adhesive asperities whose unloading is followed.
TRIALS = 20


def rows() -> Iterator[Row]:
    """Measure the errors of the quantities, and times."""
    surface = irregular().surface
    layered = surface.replaced(block=BLOCK)
    for order in (1, 3):
        model = mf.Interacting(order)
        exact = exact_stiffness(model, surface, LOADS)
        yield Row(
            f"conductance against the stiffness, order {order}",
            1e-10,
            error(model.conductance(surface, LOADS), exact),
        )
        yield Row(
            f"stiffness of curves against the exact derivative, order {order}",
            1e-4,
            error(model.curve(surface, LOADS).stiffness, exact),
        )
    alone = mf.Independent()
    yield Row(
        "conductance against the stiffness, independent",
        1e-10,
        error(alone.conductance(surface, LOADS), alone.curve(surface, LOADS).stiffness),
    )
    model, resolved = mf.Interacting(), mf.BoundaryElements(CELL)
    yield Row(
        "stiffness of order 3 against resolved contacts",
        1e-3,
        error(model.curve(surface, LOADS).stiffness, resolved.curve(surface, LOADS).stiffness),
    )
    model, resolved = (
        mf.Interacting(substrate=mf.BondedLayer()),
        mf.BoundaryElements(CELL, substrate=mf.BondedLayer()),
    )
    yield Row(
        "stiffness of order 3 against resolved contacts, bonded layer",
        1e-3,
        error(model.curve(layered, LOADS).stiffness, resolved.curve(layered, LOADS).stiffness),
    )
    for share in (1.0, 0.5):
        yield Row(
            f"conductance against resolved contacts, grounded layer of share {share:g}",
            1e-3,
            error(model.conductance(layered, LOADS, share), resolved.conductance(layered, LOADS, share)),
        )
    for load, value in zip(LOADS, model.conductance(layered, LOADS), strict=True):
        yield Row(f"rescaled conductance at P/E* = {load:g} mm^2, grounded layer", math.inf, value, "mm")
    yield Row(
        "conductance of order 1 by images against the integral",
        1e-10,
        error(
            mf.Interacting(1, substrate=mf.BondedLayer()).conductance(layered, LOADS),
            discs_by_images(layered),
        ),
    )
    r = np.geomspace(0.1, 5.0 * THICKNESS, 20)
    yield Row(
        "influence of the grounded layer by images against the integral, times r",
        1e-10,
        float(np.abs(r * (GroundedLayer(THICKNESS).regular(r) - by_images(r))).max()),
    )
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    single = 1.5 * math.pi * ENERGY * RADIUS
    for law in (mf.Independent(mf.JKR(ENERGY)), mf.Interacting(contact=mf.JKR(ENERGY))):
        yield Row(
            f"pull-off of one contact, {law.name.split(',')[0]}",
            1e-10,
            abs(mf.pull_off(one, law, load=0.01) / single - 1.0),
        )
    lattice = mf.Surface.square_lattice(
        0.1 + 0.003 * np.random.default_rng(0).random(64), radius=RADIUS, material=MATERIAL
    )
    far = lattice.replaced(position=1e4 * lattice.position)
    apart, adhesive = (
        mf.pull_off(s, m, load=0.1)
        for s, m in (
            (far, mf.Interacting(contact=mf.JKR(ENERGY))),
            (far, mf.Independent(mf.JKR(ENERGY))),
        )
    )
    yield Row("pull-off of 64 contacts far apart against independent ones", 1e-6, abs(apart / adhesive - 1.0))
    model = mf.Interacting()
    seconds = best(lambda: model.conductance(lattice, np.linspace(0.01, 0.5, 20)), 3)
    yield Row("conductance of 64 asperities at 20 loads, order 3", 1.0, seconds, "s")
    settled = 0
    for seed in range(TRIALS):
        uneven = lattice.replaced(height=0.1 + 0.003 * np.random.default_rng(seed).random(64))
        try:
            mf.pull_off(uneven, mf.Interacting(contact=mf.JKR(ENERGY)), load=0.1)
        except mf.NotConverged:
            continue
        settled += 1
    yield Row(f"share of {TRIALS} unloading paths that are not followed", 0.1, 1.0 - settled / TRIALS)
    seconds = best(lambda: mf.pull_off(lattice, mf.Interacting(contact=mf.JKR(ENERGY)), load=0.1), 1)
    yield Row("pull-off of 64 asperities, order 3", 10.0, seconds, "s")
