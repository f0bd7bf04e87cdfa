"""The law of one surface under models of increasing detail, and for other assignments of heights to sites."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from metafem import _validate as check
from metafem.errors import InvalidInput, NotConverged, refuse_if
from metafem.inversion import Design
from metafem.models import Independent, Interacting
from metafem.models.model import contact_of, has_paraboloids
from metafem.notes import from_lines, information
from metafem.prediction import friction_law
from metafem.progress import doing, each
from metafem.studies.caps import caps_of, law_of_caps
from metafem.studies.dataset import Variables, dataset
from metafem.studies.draws import generator_of, seed_of
from metafem.substrate import BondedLayer, HalfSpace

if TYPE_CHECKING:
    import xarray as xr

# Explanation of the model "fe", stored in the notes of the dataset.
ELEMENTS = (
    "fe: each contact has the law of its true cap on the bonded block by small-strain finite elements, "
    "without interaction; compare it with independent. At large a/R small strain overestimates P(a), while "
    "finite strain gives less than Hertz's law: the change of A0 is an upper estimate there, and Hertz's law "
    "with a fitted modulus is more accurate"
)

# The table of caps reaches this multiple of Hertz's indentation: on the source paper's surfaces, pedestals
# add up to a fifth.
DEEPER = 1.2

# Random assignments are solved at every n-th load of the design's law, at about this number of loads.
RANDOM_LOADS = 20

# Why the true block is left out of a report.
NOT_KEPT = "its influence between these sites takes about a minute; `metafem study fidelity` computes it"


@doing("comparing the models")
def fidelity(design: Design, *, elements: bool = True) -> xr.Dataset:
    """Return A0(P) and delta(P) of a design under all models.

    The models are "independent", order 3 on the "half-space", the bonded "layer" and the true "block", that
    of the design if it is another one, and "fe". The influence of the true block is computed once (half a
    minute for 64 asperities) and stored on disk.

    "fe" denotes independent asperities with the contact law of the true spherical cap on the bonded block
    instead of Hertz's law: ``sum_i P_fe(a_i, h_i) = P`` with ``d_fe(a_i, h_i) = h_i - delta``. The contact
    law is interpolated between axisymmetric finite-element solutions (`metafem.fe.press`) at nine pairs of
    height and contact radius. It includes the effects of the shape of the cap, its pedestal, and the base and
    the sides of the block, but not of neighbouring asperities. The difference from "independent" is
    meaningful at small a/R. At large a/R the difference is an upper estimate: at a/R = 0.5, the load is 1.11
    times Hertz's load at small strain, but 0.978 times Hertz's load at finite strain.

    Parameters
    ----------
    design : Design
    elements : bool
        Whether to compute "fe", which takes about half a minute. With summits of several radii, "fe" is left
        out. Default: True.

    Returns
    -------
    xarray.Dataset
        ``area`` [mm^2], ``separation`` [mm], ``area_change`` [-] (relative to independent asperities) and
        ``sinking`` [mm] (the decrease of the separation), over ``model`` and ``rescaled_load`` [mm^2], with
        the coordinate ``load`` [N]. ``elements_error`` [-] is the largest relative error of load and
        indentation in the table of caps. The attribute ``notes`` has one line for each model that was left
        out, with the reason.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> fidelity(design, elements=False).model.values.tolist()
    ['independent', 'half-space']
    """
    return compared(design, elements=elements, wait=True)


def compared(design: Design, *, elements: bool, wait: bool) -> xr.Dataset:
    """Return the dataset of `fidelity`, and notes on what is left out.

    All models have the contact law of the design with its largest order of interaction. Left out are the
    layer and the true block if the surface has no block, the true block if `wait` is False, and models
    without a solution.
    """
    surface, law, error, notes = design.surface, design.law, float("nan"), []
    contact = contact_of(law.model)
    substrates: dict[str, Any] = {"half-space": HalfSpace()}
    if surface.block is None:
        notes.append(information("the layer and the true block are left out: the surface has no block"))
    else:
        from metafem.fe import Block3D  # imports scikit-fem; no other model needs it

        substrates |= {"layer": BondedLayer(), "true block": Block3D()}
    order = contact.largest_order
    laws = {"independent": friction_law(surface, Independent(contact), load=law.load)}
    for name, substrate in each("law", list(substrates.items())):
        try:
            refuse_if(name == "true block" and not wait, NOT_KEPT)
            model = Interacting(order, substrate, contact)
            laws[name.removeprefix("true ")] = friction_law(surface, model, load=law.load)
        except InvalidInput as reason:
            notes.append(information(f"the {name} is left out: {reason}"))
        except NotConverged as reason:
            why = f"order {order} has no solution up to {law.load[-1]:.4g} N ({reason})"
            notes.append(information(f"the {name} is left out: {why}"))
    if law.model not in [found.model for found in laws.values()]:
        laws[law.model.name] = law
    curves = {name: (found.area, found.separation) for name, found in laws.items()}
    if elements and not has_paraboloids(law.model):
        notes.append(information("fe is left out: its caps are spherical, to be compared with paraboloids"))
    elif elements:
        try:
            caps = caps_of(surface, DEEPER * (surface.height - laws["independent"].separation[-1]))
            curves["fe"] = law_of_caps(surface, caps, law.rescaled_load)
            error = caps.error
            notes.append(information(ELEMENTS))
        except InvalidInput as reason:
            notes.append(information(f"fe is left out: {reason}"))
    area, separation = np.array(list(curves.values())).transpose(1, 0, 2)
    axes = ("model", "rescaled_load")
    variables: Variables = {
        "area": (axes, area),
        "separation": (axes, separation),
        "area_change": (axes, area / area[0] - 1.0),
        "sinking": (axes, separation[0] - separation),
        "elements_error": ((), error),
    }
    loads = {"rescaled_load": law.rescaled_load, "load": ("rescaled_load", law.load)}
    return dataset("fidelity", variables, {"model": list(curves), **loads}, notes)


@doing("comparing assignments of heights to sites")
def interaction(design: Design, *, placements: int = 1000, rng: Any = 0) -> xr.Dataset:
    """Compare A0(P) and delta(P) of coupled asperities with those of independent ones.

    The assignment of asperities to sites affects the law of coupled asperities, but not the law of
    independent ones. The study therefore also computes the change for random assignments of the design's
    asperities to its sites.

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
        ("half-space", and "layer" if there is a block) and the ``rescaled_load`` [mm^2] of the design's law,
        with the coordinate ``load`` [N]. The contact law is that of the design, at its largest order of
        interaction. ``placement_rms`` [-] is the root mean square change of each random assignment
        (``placement``) over every fifth load.

    Raises
    ------
    NotConverged
        If a model has no solution for an assignment.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> dict(interaction(design, placements=5).sizes)
    {'substrate': 1, 'rescaled_load': 100, 'placement': 5}
    """
    count, seed = check.integer("placements", placements, at_least=1), seed_of(rng)
    surface, law, found = design.surface, design.law, compared(design, elements=False, wait=False)
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
        "placement_rms": (("substrate", "placement"), spread),
    }
    loads = {"rescaled_load": law.rescaled_load, "load": ("rescaled_load", law.load)}
    coordinates = {"substrate": names, **loads}
    notes = [note for note in from_lines(found.attrs["notes"]) if "true block" not in note.text]
    return dataset("interaction", variables, coordinates, notes, seed=str(seed), draws=count)
