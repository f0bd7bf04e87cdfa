"""The law of one surface under models of increasing detail, and for other assignments of heights to sites."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem.errors import MetafemError, NotConverged
from metafem.inversion import Design
from metafem.models import Independent, Interacting
from metafem.models.model import contact_of
from metafem.notes import from_lines, information
from metafem.prediction import friction_law
from metafem.progress import doing, each
from metafem.studies.dataset import Variables, dataset
from metafem.studies.draws import generator_of, seed_of
from metafem.substrate import BondedLayer, HalfSpace

if TYPE_CHECKING:
    import xarray as xr

# Random assignments are solved at every n-th load of the design's law, at about this number of loads.
RANDOM_LOADS = 20

# Why the true block is left out of a report.
NOT_KEPT = (
    "the true block is left out: its influence between these sites takes about a minute; "
    "`metafem study fidelity` computes it"
)


@doing("comparing the models")
def fidelity(design: Design) -> xr.Dataset:
    """Return A0(P) and delta(P) of a design under all models.

    The models are "independent", order 3 on the "half-space", the bonded "layer", the "layer with pedestals"
    and the true "block", and that of the design if it is another one. All have the contact law of the design
    with its largest order of interaction. The influence of the true block is computed by finite elements once
    (half a minute for 64 asperities) and stored on disk.

    Parameters
    ----------
    design : Design

    Returns
    -------
    xarray.Dataset
        ``area`` [mm^2], ``separation`` [mm], ``area_change`` [-] (relative to independent asperities) and
        ``sinking`` [mm] (the decrease of the separation), over ``model`` and ``rescaled_load`` [mm^2], with
        the coordinate ``load`` [N]. The attribute ``notes`` has one line for each model that was left out,
        with the reason.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> fidelity(design).model.values.tolist()
    ['independent', 'half-space']
    """
    return compared(design, wait=True)


def compared(design: Design, *, wait: bool) -> xr.Dataset:
    """Return the dataset of `fidelity`; if `wait` is False, without the true block."""
    surface, law, notes = design.surface, design.law, []
    contact = contact_of(law.model)
    coupled = partial(Interacting, contact.largest_order, contact=contact)
    models = {"half-space": coupled(HalfSpace())}
    if surface.block is None:
        notes.append(information("the layer and the true block are left out: the surface has no block"))
    else:
        models["layer"] = coupled(BondedLayer())
        models["layer with pedestals"] = coupled(BondedLayer(), pedestal=True)
        if wait:
            from metafem.fe import Block3D  # imports scikit-fem; no other model needs it

            models["block"] = coupled(Block3D())
        else:
            notes.append(information(NOT_KEPT))
    laws = {"independent": friction_law(surface, Independent(contact), load=law.load)}
    for name, model in each("law", list(models.items())):
        try:
            laws[name] = friction_law(surface, model, load=law.load)
        except MetafemError as reason:
            notes.append(information(f"the {name} is left out: {reason}"))
    if law.model not in [found.model for found in laws.values()]:
        laws[law.model.name] = law
    area = np.array([found.area for found in laws.values()])
    separation = np.array([found.separation for found in laws.values()])
    axes = ("model", "rescaled_load")
    variables: Variables = {
        "area": (axes, area),
        "separation": (axes, separation),
        "area_change": (axes, area / area[0] - 1.0),
        "sinking": (axes, separation[0] - separation),
    }
    loads = {"rescaled_load": law.rescaled_load, "load": ("rescaled_load", law.load)}
    return dataset("fidelity", variables, {"model": list(laws), **loads}, notes)


@doing("comparing assignments of heights to sites")
def interaction(design: Design, *, assignments: int = 1000, rng: Any = 0) -> xr.Dataset:
    """Compare A0(P) and delta(P) of coupled asperities with those of independent ones.

    The assignment of asperities to sites affects the law of coupled asperities, but not the law of
    independent ones. The study therefore also computes the change for random assignments of the design's
    asperities to its sites.

    Parameters
    ----------
    design : Design
    assignments : int
        Number of random assignments; default: 1000.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Returns
    -------
    xarray.Dataset
        ``area_change`` [-] and ``sinking`` [mm], the decrease of the separation, over ``substrate``
        ("half-space", and "layer" if there is a block) and the ``rescaled_load`` [mm^2] of the design's law,
        with the coordinate ``load`` [N]. The contact law is that of the design, at its largest order of
        interaction. ``assignment_rms`` [-] is the root mean square change of each random assignment
        (``assignment``) over every fifth load.

    Raises
    ------
    NotConverged
        If a model has no solution for an assignment.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> dict(interaction(design, assignments=5).sizes)
    {'substrate': 1, 'rescaled_load': 100, 'assignment': 5}
    """
    count, seed = check.integer("assignments", assignments, at_least=1), seed_of(rng)
    surface, law, found = design.surface, design.law, compared(design, wait=False)
    substrates = {"half-space": HalfSpace(), "layer": BondedLayer()}
    names = [name for name in substrates if name in found["model"]]
    few = slice(None, None, -max(1, len(law.rescaled_load) // RANDOM_LOADS))  # from the last load down
    load, area = law.rescaled_load[few][::-1], found["area"].values[0, few][::-1]
    # a random stream other than that of `design`: with the same seed, the first permutation of that stream
    # would undo the assignment of the design, and the heights would be sorted
    random, sites = generator_of(seed, 0), np.arange(surface.count)
    placed = [surface.only(random.permutation(sites), position=surface.position) for _ in range(count)]
    spread, contact = [], contact_of(law.model)
    for name in names:
        model = Interacting(contact.largest_order, substrates[name], contact)
        moved = [model.areas(part, load, part.height[None])[0] for part in each("assignment", placed)]
        if not np.isfinite(moved).all():
            raise NotConverged("the model has no solution for an assignment of the heights to the sites")
        spread.append(np.sqrt(((moved / area - 1.0) ** 2).mean(axis=1)))
    coupled = found.sel(model=names)
    variables: Variables = {
        "area_change": (("substrate", "rescaled_load"), coupled["area_change"].values),
        "sinking": (("substrate", "rescaled_load"), coupled["sinking"].values),
        "assignment_rms": (("substrate", "assignment"), spread),
    }
    loads = {"rescaled_load": law.rescaled_load, "load": ("rescaled_load", law.load)}
    coordinates = {"substrate": names, **loads}
    notes = [note for note in from_lines(found.attrs["notes"]) if "true block" not in note.text]
    return dataset("interaction", variables, coordinates, notes, seed=str(seed), draws=count)
