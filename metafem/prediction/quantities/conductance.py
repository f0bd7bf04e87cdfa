"""Electrical or thermal conductance of a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, span
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.notes import Note, late, when_read
from metafem.prediction.friction_law import friction_law
from metafem.prediction.quantities.given import given
from metafem.surface import Surface


@dataclass(frozen=True, eq=False, repr=False)
class Conductance(Value):
    """Conductance of the contacts of one surface under one model, as arrays (k,) at increasing loads.

    Attributes
    ----------
    load : ndarray
        Normal load P [N].
    rescaled_conductance : ndarray
        ``(rho_1 + rho_2) G/2`` [mm], which on a half-space is the stiffness k/E* (Barber's identity).
    conductance : ndarray
        G in the inverse unit of the resistivities divided by length: S for ohm mm, W/K for mm K/W.
    model : Model
    notes : tuple of Note
        Those of the friction law at the same loads: where the model leaves its range. They are computed when
        first read.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> mf.conductance(surface, load=[0.1, 0.2], resistivity=2.0)
    <Conductance: 2 loads 0.1 to 0.2 N, rescaled 1.548 to 1.951 mm, Independent()>
    """

    load: FloatArray
    rescaled_conductance: FloatArray
    conductance: FloatArray
    model: Model
    notes: tuple[Note, ...] = late(())

    def __post_init__(self) -> None:
        for values in (self.load, self.rescaled_conductance, self.conductance):
            values.flags.writeable = False

    def __repr__(self) -> str:
        ends = [
            span(values[[0, -1]], unit)
            for values, unit in ((self.load, "N"), (self.rescaled_conductance, "mm"))
        ]
        return f"<Conductance: {len(self.load)} loads {ends[0]}, rescaled {ends[1]}, {self.model!r}>"


def conductance(
    surface: Surface,
    model: Model | None = None,
    *,
    load: ArrayLike,
    resistivity: float,
    plane_resistivity: float = 0.0,
) -> Conductance:
    """Return the electrical or thermal conductance between the block and the plane, at normal loads.

    Currents flow through the contact areas of the model alone. Independent contacts are discs in parallel,
    ``G = sum_i 4 a_i/(rho_1 + rho_2)``. Interacting contacts are discs whose potentials displace each other;
    resolved contacts carry the currents of their cells at a common potential. On a half-space the result
    agrees with Barber's identity ``G = 2 k/(E* (rho_1 + rho_2))`` for all elastic contacts without adhesion.
    On a bonded layer the base of the block has the potential 0, and its influence is that of
    `metafem.substrate.GroundedLayer`; the plane is a half-space. The conductance is that between the plane
    far away and the block far away, or its base.
    Barber, Proc. R. Soc. A 459, 53 (2003), doi:10.1098/rspa.2002.1038.

    Parameters
    ----------
    surface : Surface
    model : Model, optional
        Model of the contacts; default: `Independent()`. Interacting models need the substrate `HalfSpace` or
        `BondedLayer`.
    load : array_like, (k,)
        Normal loads P [N], at least 0; they are sorted.
    resistivity : float
        Resistivity rho_1 of the block, at least 0: electrical [ohm mm] or thermal [mm K/W].
    plane_resistivity : float
        Resistivity rho_2 of the plane in the same unit, at least 0; default: 0, an ideal conductor.

    Returns
    -------
    Conductance

    Raises
    ------
    InvalidInput
        If a value is out of range, both resistivities are zero, or the model has no conductance.
    NotConverged
        If a residual exceeds the model's tolerance.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> model = mf.Interacting()
    >>> found = conductance(surface, model, load=[0.2], resistivity=1.5, plane_resistivity=0.5)
    >>> found.conductance.round(4), round(mf.equilibrium(surface, model, load=0.2).stiffness / 1.36, 4)
    (array([1.523]), 1.523)
    """
    solver, loads = given(surface, model, load)
    own = check.number("resistivity", resistivity, at_least=0.0)
    total = own + check.number("plane_resistivity", plane_resistivity, at_least=0.0)
    refuse_if(total == 0.0, "resistivity and plane_resistivity are both 0: the conductance is infinite")
    refuse_if(
        not hasattr(solver, "conductance"),
        f"the model {solver.name} has no conductance; use independent, half-space or layer",
    )
    found = cast("Any", solver).conductance(surface, loads, own / total)
    newtons = np.array(surface.material.composite_modulus * loads)
    notes = when_read(_notes, surface, solver, newtons, size=surface.count + newtons.size)
    return Conductance(newtons, found, 2.0 * found / total, solver, notes)


def _notes(surface: Surface, model: Model, load: FloatArray) -> tuple[Note, ...]:
    """Return the notes of the friction law at positive loads [N]."""
    pressed = load[load > 0.0]
    return friction_law(surface, model, load=pressed).notes if pressed.size else ()
