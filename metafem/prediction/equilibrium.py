"""The equilibrium of a surface at a given load, approach or separation."""

from __future__ import annotations

from dataclasses import replace

from metafem import _validate as check
from metafem._calls import checked_call
from metafem.errors import InvalidInput, NotConverged
from metafem.models.independent import Independent
from metafem.models.model import ContactState, Model, Status
from metafem.models.validity import REMEDY, state_notes
from metafem.notes import when_read
from metafem.surface import Surface


@checked_call
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
        Default: `Independent()`.
    load : float, optional
        Normal load P [N], at least 0.
    approach : float, optional
        Tallest summit minus separation [mm]; with a negative value there is no contact.
    separation : float, optional
        Distance of the plane from the undeformed base plane [mm]. Exactly one of the three must be given.

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
    check.instance("surface", surface, Surface, "a metafem.Surface")
    check.instance("model", solver, Model, "a model such as metafem.Independent(); loads go by load=")
    given = {"load": load, "approach": approach, "separation": separation}
    named = [name for name, value in given.items() if value is not None]
    if len(named) != 1:
        raise InvalidInput(
            f"exactly one of load, approach and separation must be given; got {named or 'none'}"
        )
    if load is not None:
        newtons = check.number("load", load, at_least=0.0)
        state = solver.solve_load(surface, newtons / surface.material.composite_modulus)
    elif approach is not None:
        state = solver.solve(surface, check.number("approach", approach))
    else:
        distance = check.number("separation", separation)
        state = replace(solver.solve(surface, float(surface.height.max()) - distance), separation=distance)
    if state.status is not Status.CONVERGED:
        reason = "; ".join([f"residual {state.residual:.2g}", *map(str, state.notes)])
        raise NotConverged(f"{state.status.value}: {reason}; {REMEDY}", state)
    return replace(state, notes=when_read(state_notes, surface, solver, state))
