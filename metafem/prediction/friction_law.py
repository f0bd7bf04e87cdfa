"""Prediction of the friction law of a surface."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import NotConverged, refuse_if
from metafem.models import Curve, Independent, Model
from metafem.models.model import checked_model, contact_of, with_contact
from metafem.notes import when_read
from metafem.prediction.law import FrictionLaw
from metafem.prediction.validity import REMEDY, Validity
from metafem.surface import Surface

# Number of loads of the default grid.
GRID_POINTS = 100

# Indentation of the lowest asperity at the end of the default grid, over its radius; a/R is then 0.2.
GRID_INDENTATION = 0.04

# Largest approach of the default grid, over the largest height. The grid ends just before the rigid plane
# reaches the base plane.
CLEAR = 0.999

# Largest approach of the default grid, over the approach at which a contact without neighbours reaches the
# largest indentation of its law. The margin allows for rounding, and for the different displacements of
# interacting asperities.
WITHIN = 0.98


def friction_law(
    surface: Surface,
    model: Model | None = None,
    *,
    load: ArrayLike | None = None,
    separation: ArrayLike | None = None,
    unloading: bool = False,
) -> FrictionLaw:
    """Return the predicted friction law of a surface.

    Adhesive contacts form and break in jumps at different loads; `unloading` selects the states on unloading.
    All states are stable under load control, and the notes report the jumps. The unloading of plastic
    contacts is not known, and is refused.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Default: `Independent()`.
    load : array_like, (k,), optional
        Normal loads P [N], at least 0. Adhesive contacts on unloading may also have negative loads, down to
        the load at which the last contacts break.
    separation : array_like, (k,), optional
        Separations [mm]. Default, if neither loads nor separations are given: 100 loads. The largest load
        is that at which the lowest asperity is indented by 0.04 R, the plane reaches the base plane, or the
        approach is 98 % of that at which a contact reaches the largest indentation of its law, whichever
        comes first.
    unloading : bool
        Whether the states are those on unloading from the largest load; default: False. Elastic contacts
        without adhesion have the same law on loading and unloading.

    Returns
    -------
    FrictionLaw
        Law with the states in the order of increasing load.

    Raises
    ------
    InvalidInput
        If both loads and separations are given. For loads that are not finite, negative on loading, or below
        the pull-off load on unloading. For separations that are not finite, and for separations of adhesive
        contacts. For `unloading` if the model or the contact law does not support it, or adhesive contacts
        are open at the largest load.
    NotConverged
        If a residual exceeds the model's tolerance.

    Examples
    --------
    >>> from metafem import Material
    >>> surface = Surface.square_lattice([0.1, 0.12], (1, 2), radius=0.526, material=Material(1.36))
    >>> law = friction_law(surface, separation=[0.11, 0.09])
    >>> law.area.round(5)
    array([0.01652, 0.0661 ])
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    solver = checked_model(Independent() if model is None else model)
    refuse_if(load is not None and separation is not None, "only one of load and separation can be given")
    check.instance("unloading", unloading, bool, "True or False")
    law = contact_of(solver).bound(surface)
    refuse_if(
        unloading and not getattr(solver, "unloads", False),
        f"unloading = True: the model {solver.name} has no unloading; use independent, half-space or layer",
    )
    values: dict[str, FloatArray]
    distance = None
    if separation is not None:
        refuse_if(
            law.adhesive,
            "separation cannot be given with adhesive contacts: at a given separation their load falls "
            "where they jump into contact; give load",
        )
        distance = np.sort(check.array("separation", separation, shape=(None,)))[::-1]
        values = {"approach": surface.height.max() - distance}
    elif load is None:
        values = {"load": default_loads(surface, solver)}
    else:
        newtons = np.sort(check.loads("load", load, negative=unloading and law.adhesive))
        values = {"load": newtons / surface.material.composite_modulus}
    if not unloading:
        curve = solver.curve(surface, **values)
    else:
        curve = cast("Any", solver).curve(surface, **values, unloading=True)
    return law_of_curve(surface, solver, curve, values.get("load", curve.load), distance, unloading)


def default_loads(surface: Surface, model: Model) -> FloatArray:
    """Return the rescaled loads of the default grid [mm^2]."""
    contact = contact_of(model).bound(surface)
    described = (surface.gap + contact.largest_indentation(contact.summits(surface))).min()
    last = np.array([min(_grid_end(surface), WITHIN * described)])
    end = model.curve(surface, approach=last).load[0]
    if end <= 0.0:  # with adhesion the load may be negative there; use the load without adhesion
        end = with_contact(model, contact.without_adhesion).curve(surface, approach=last).load[0]
    return np.asarray(end * np.arange(1, GRID_POINTS + 1) / GRID_POINTS)


def law_of_curve(
    surface: Surface,
    model: Model,
    curve: Curve,
    rescaled_load: FloatArray,
    separation: FloatArray | None = None,
    unloading: bool = False,
) -> FrictionLaw:
    """Return the friction law of a model's curve; raise NotConverged if the curve has not converged."""
    if separation is None:
        separation = surface.height.max() - curve.approach
    validity, size = Validity(surface, model, curve, unloading), surface.count + curve.area.size
    law = FrictionLaw(
        rescaled_load=np.array(rescaled_load),
        area=curve.area,
        separation=np.array(separation),
        approach=curve.approach,
        rescaled_stiffness=curve.stiffness,
        residual=curve.residual,
        status=curve.status,
        model=model,
        material=surface.material,
        friction=surface.friction,
        notes=when_read(validity.notes, curve.notes, size=size),
        model_error=when_read(getattr, validity, "error", size=size),
        cell=surface.cell,
    )
    if not curve.converged:
        worst = curve.residual.max()
        raise NotConverged(f"{curve.status.value}: largest residual {worst:.2g}; {REMEDY}", law)
    return law


def _grid_end(surface: Surface) -> float:
    """Return the approach [mm] at which the default grid ends."""
    gaps = surface.gap
    lowest = int(gaps.argmax())
    end = float(gaps[lowest] + GRID_INDENTATION * surface.radius[lowest])
    top = float(surface.height.max())
    return min(end, CLEAR * top) if CLEAR * top > gaps[lowest] else end
