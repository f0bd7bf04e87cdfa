"""The effect of elastic interaction on the law of a design, also for random assignments to sites."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps import Caps
from metafem.errors import NotConverged
from metafem.inversion import Design
from metafem.models import Independent, Interacting
from metafem.models.model import contact_of
from metafem.progress import doing, each
from metafem.studies.sampling.dataset import dataset, described
from metafem.studies.sampling.points import entropy
from metafem.substrate import BondedLayer, HalfSpace, Substrate
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

IndexArray = NDArray[np.intp]

# Number of assignments that are solved between two reports of progress.
AT_ONCE = 100

# Random assignments are solved at every n-th load of the design's law, at about this number of loads.
RANDOM_LOADS = 20

# Orders of interaction that are compared, as far as the contact law supports them.
ORDERS = (1, 3)


@doing("comparing assignments of heights to sites")
def interaction(design: Design, *, placements: int = 1000, rng: Any = 0) -> xr.Dataset:
    """Compare A0(P) and delta(P) of coupled asperities with those of independent ones.

    The assignment of asperities to sites affects the law of coupled asperities, but not the law of
    independent ones. The study therefore also computes the change for random assignments of the design's
    asperities to its sites, and for an assignment with the tallest asperities in the centre.

    Parameters
    ----------
    design : Design
    placements : int
        Number of random assignments; default: 1000.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Returns
    -------
    xarray.Dataset
        ``area_change`` [-] and ``sinking`` [mm], the decrease of the separation, over ``substrate``
        ("half-space", and "layer" if there is a block), ``order`` (1, and 3 if the contact law allows it) and
        the ``rescaled_load`` [mm^2] of the design's law, with the coordinate ``load`` [N]. The contact law is
        that of the design. ``centred_change`` [-] is the change with the tallest asperities in the centre, at
        the largest order. ``placement_rms`` [-] is the root mean square change of each random assignment
        (``placement``) over every fifth load, at the largest order.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> dict(interaction(design, placements=5).sizes)
    {'substrate': 1, 'order': 2, 'rescaled_load': 100, 'placement': 5}
    """
    count = check.integer("placements", placements, at_least=1)
    seed = entropy(rng)
    # a random stream other than that of `design`: with the same seed, the first permutation of that stream
    # would undo the assignment of the design, and the heights would be sorted
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(0,)))
    surface = design.surface
    rescaled = design.law.rescaled_load
    few = np.arange(len(rescaled))[:: -max(1, len(rescaled) // RANDOM_LOADS)][::-1]
    substrates: dict[str, Substrate] = {"half-space": HalfSpace()}
    if surface.block is not None:
        substrates["layer"] = BondedLayer()
    law = contact_of(design.law.model)
    orders = [order for order in ORDERS if order <= law.largest_order]
    independent = Independent(contact=law).curve(surface, rescaled)
    nearest = np.argsort(((surface.position - surface.position.mean(axis=0)) ** 2).sum(axis=1), kind="stable")
    tallest = np.argsort(-surface.height, kind="stable")
    centred = np.empty(surface.count, dtype=int)
    centred[nearest] = tallest
    random_orders = [random.permutation(surface.count) for _ in range(count)]

    change, sinking, centre, spread = [], [], [], []
    for name in each("substrate", list(substrates)):
        substrate = substrates[name]
        models = [Interacting(order=order, substrate=substrate, contact=law) for order in orders]
        curves = [model.curve(surface, rescaled) for model in models]
        change.append([curve.area / independent.area - 1.0 for curve in curves])
        sinking.append([curve.approach - independent.approach for curve in curves])
        model = models[-1]
        centre.append(_areas(model, surface, [centred], rescaled)[0] / independent.area - 1.0)
        moved = _areas(model, surface, random_orders, rescaled[few]) / independent.area[few] - 1.0
        spread.append(np.sqrt((moved**2).mean(axis=1)))
    axes = ("substrate", "order", "rescaled_load")
    variables = {
        "area_change": (axes, np.array(change)),
        "sinking": (axes, np.array(sinking)),
        "centred_change": (axes[::2], np.array(centre)),
        "placement_rms": (("substrate", "placement"), np.array(spread)),
    }
    load = rescaled * surface.material.composite_modulus
    coordinates = {
        "substrate": list(substrates),
        "order": orders,
        "rescaled_load": rescaled,
    }
    found = dataset("interaction", variables, coordinates, seed=seed, draws=count)
    return found.assign_coords(load=("rescaled_load", load, described("load")))


def _areas(
    model: Interacting, surface: Surface, orders: list[IndexArray], rescaled: FloatArray
) -> FloatArray:
    """Return A0 (m, k) [mm^2] of m assignments of the asperities to the sites, at k rescaled loads."""
    if isinstance(surface.cap, Caps):
        placed = [surface.only(order, position=surface.position) for order in orders]
        areas = [model.areas(part, rescaled, part.height[None]) for part in each("assignment", placed)]
    else:
        varied = np.ptp(surface.radius) > 0.0
        parts = [np.array(orders[k : k + AT_ONCE]) for k in range(0, len(orders), AT_ONCE)]
        areas = [
            model.areas(surface, rescaled, surface.height[part], surface.radius[part] if varied else None)
            for part in each("assignments, part", parts)
        ]
    if not all(np.isfinite(part).all() for part in areas):
        raise NotConverged("the model has no solution for an assignment of the heights to the sites")
    return np.concatenate(areas)
