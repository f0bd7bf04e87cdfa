"""Equilibrium of a surface at a given load, approach or separation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem import _validate as check
from metafem.errors import NotConverged, refuse_if
from metafem.models import Independent, Model
from metafem.models.model import checked_model
from metafem.notes import when_read
from metafem.prediction.contact_state import ContactState
from metafem.prediction.validity import REMEDY, Validity
from metafem.surface import Surface


def equilibrium(
    surface: Surface,
    model: Model | None = None,
    *,
    load: float | None = None,
    approach: float | None = None,
    separation: float | None = None,
) -> ContactState:
    """Return the equilibrium of a surface pressed on the rigid plane.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Default: `Independent()`.
    load : float, optional
        Normal load P [N], at least 0.
    approach : float, optional
        Height of the tallest summit minus separation [mm]; there is no contact if it is negative.
    separation : float, optional
        Distance from the undeformed base plane to the rigid plane [mm]. Exactly one of load, approach and
        separation must be given.

    Returns
    -------
    ContactState

    Raises
    ------
    InvalidInput
        If not exactly one of load, approach and separation is given, or if its value is out of range.
    NotConverged
        If the residual exceeds the model's tolerance; the state is attached.

    Examples
    --------
    >>> from metafem import Material
    >>> surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, load=0.2)
    >>> round(state.area, 4), round(state.load, 12)
    (0.7474, 0.2)
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    solver = checked_model(Independent() if model is None else model)
    given = {"load": load, "approach": approach, "separation": separation}
    named = [name for name, value in given.items() if value is not None]
    refuse_if(
        len(named) != 1, f"exactly one of load, approach and separation must be given; got {named or 'none'}"
    )
    modulus = surface.material.composite_modulus
    top = float(surface.height.max())
    if load is not None:
        curve = solver.curve(surface, np.array([check.number("load", load, at_least=0.0) / modulus]))
    else:
        if separation is not None:
            separation = check.number("separation", separation)
        depth = check.number("approach", approach) if separation is None else top - separation
        curve = solver.curve(surface, approach=np.array([depth]))
    last, reached = curve.last, float(curve.approach[0])
    notes = (*curve.notes, *last.notes)
    validity = Validity(surface, solver, curve)
    state = ContactState(
        load=modulus * float(curve.load[0]),
        area=float(curve.area[0]),
        separation=top - reached if separation is None else separation,
        approach=reached,
        stiffness=modulus * float(curve.stiffness[0]),
        asperity_load=modulus * last.load,
        asperity_area=last.area,
        residual=float(curve.residual[0]),
        status=curve.status,
        model=last.model,
        base_gap=last.base_gap,
        notes=when_read(validity.notes, notes, size=surface.count) if curve.converged else notes,
        model_error=when_read(getattr, validity, "error", size=surface.count),
        _field=None if last.field is None else replace(last.field, pressure=modulus * last.field.pressure),
    )
    if not curve.converged:
        reason = "; ".join([f"residual {state.residual:.2g}", *map(str, notes)])
        raise NotConverged(f"{state.status.value}: {reason}; {REMEDY}", state)
    return state
