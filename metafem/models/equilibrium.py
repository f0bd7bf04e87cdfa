"""One equilibrium of one surface, under a load, an approach or a separation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from metafem import _validate as check
from metafem.errors import InvalidInput, NotConverged
from metafem.models.independent import Independent
from metafem.models.model import ContactState, LoadSolver, Model, Status
from metafem.surface import Surface


def equilibrium(
    surface: Surface,
    model: Model | None = None,
    *,
    load: float | None = None,
    approach: float | None = None,
    separation: float | None = None,
) -> ContactState:
    """Solve for the equilibrium of a surface pressed on the plane.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        `Independent()` unless told.
    load : float, optional
        Normal load P [N], not negative.
    approach : float, optional
        Tallest summit minus separation [mm]; negative values leave the contact open.
    separation : float, optional
        Distance of the plane from the undeformed base plane [mm]. Exactly one of the three is given.

    Returns
    -------
    ContactState

    Raises
    ------
    InvalidInput
        If none or several of load, approach and separation are given, or a value cannot be used.
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
    solver: Model = Independent() if model is None else model
    if not isinstance(surface, Surface):
        raise InvalidInput(f"surface = {surface!r:.60} must be a metafem.Surface")
    if not isinstance(solver, Model):
        raise InvalidInput(f"model = {model!r} must be a model such as metafem.Independent()")
    given = {"load": load, "approach": approach, "separation": separation}
    named = [name for name, value in given.items() if value is not None]
    if len(named) != 1:
        raise InvalidInput(
            f"exactly one of load, approach and separation must be given; got {named or 'none'}"
        )
    if load is not None:
        state = _under_load(surface, solver, check.number("load", load, at_least=0.0))
    elif approach is not None:
        state = solver.solve(surface, check.number("approach", approach))
    else:
        distance = check.number("separation", separation)
        state = replace(solver.solve(surface, float(surface.height.max()) - distance), separation=distance)
    if state.status is not Status.CONVERGED:
        raise NotConverged(f"{state.status.value}: residual {state.residual:.2g}", state)
    return state


def _under_load(surface: Surface, model: Model, load: float) -> ContactState:
    """Find the approach by the model's curve and report the load's error with the state's."""
    rescaled = load / surface.material.composite_modulus
    if isinstance(model, LoadSolver):
        state = model.solve_load(surface, rescaled)
    else:
        curve = model.curve(surface, np.array([rescaled]))
        state = model.solve(surface, float(curve.approach[0]))
    error = abs(state.load - load) / load if load > 0.0 else state.load
    return replace(state, residual=max(state.residual, error))
