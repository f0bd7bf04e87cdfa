"""The equilibrium of one surface at one load, in N."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import InvalidInput, NotConverged, refuse_if
from metafem.models import ContactField, Independent, Model, Status
from metafem.models.curve import ModelError
from metafem.models.model import checked_model
from metafem.notes import Note, late, printed_count
from metafem.prediction.validity import NOT_ESTIMATED, REMEDY, judged
from metafem.surface import Surface


@dataclass(frozen=True, eq=False, repr=False)
class ContactState(Value):
    """Equilibrium of one surface at one load.

    Attributes
    ----------
    load : float
        Normal load P [N], the sum over the asperities.
    area : float
        Real contact area A0 [mm^2].
    separation : float
        Distance from the undeformed base plane to the rigid plane [mm].
    approach : float
        Height of the tallest summit minus separation [mm], accurate also at light loads.
    stiffness : float
        Normal contact stiffness, the increase of P per decrease of the separation [N/mm]; not negative.
    asperity_load, asperity_area : ndarray, (n,)
        Load [N] and area [mm^2] of each asperity.
    residual : float
        ``max(max |F_i| / max d, |sum P_i - P| / P)`` [-] with the errors F_i [mm] of the equations of the
        contacts, recomputed on this state.
    status : Status
    model : object
        The model that was solved.
    base_gap : float
        Smallest distance between the plane and the displaced base near a summit [mm]; see Notes.
    notes : tuple of Note
        Approximations made in the solution, with their bounds, and estimates of neglected effects.
    model_error : ModelError
        Estimated relative error of A0(P), compared with resolved contacts on the same substrate; computed
        when it is first read. It is nan if it cannot be estimated; its `source` states the reason.
    field : ContactField
        Pressure, gap and displacement on the cells of `BoundaryElements`; other models raise InvalidInput.

    Notes
    -----
    A load on one asperity displaces the entire surface, including the base between the summits.
    Summit i and the base near it have the same displacement u_i: the sum of the displacements by the other
    asperities plus the regular self term of the block. The gap near asperity i is ``separation + u_i``. For
    an asperity in contact, this gap is ``h_i - d_i``, its height minus its indentation. The base gap is the
    smallest gap. For independent asperities, the base gap is the separation. The gap
    excludes the Hertzian displacement around the contact and the displacement of the
    cap's foot, which would both increase the gap. Far outside the array the base is not displaced: a plane
    that extends that far touches the base there at zero separation.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([0.12, 0.1], (1, 2), radius=0.526, material=mf.Material(1.36))
    >>> state = mf.equilibrium(surface, load=0.01)
    >>> state.asperity_area.round(3)
    array([0.055, 0.022])
    >>> state
    <ContactState: load 0.01 N, area 0.07696 mm^2, separation 0.08672 mm, stiffness ..., in contact ...>
    """

    load: float
    area: float
    separation: float
    approach: float
    stiffness: float
    asperity_load: FloatArray
    asperity_area: FloatArray
    residual: float
    status: Status
    model: Model
    base_gap: float
    notes: tuple[Note, ...] = late(())
    model_error: ModelError = late(NOT_ESTIMATED)
    _field: ContactField | None = None

    @property
    def field(self) -> ContactField:
        """Pressure, gap and displacement on the cells; raises InvalidInput for models without cells."""
        if self._field is None:
            words = "has no pressure field; solve with metafem.BoundaryElements(cell=...)"
            raise InvalidInput(f"{self.model!r} {words}")
        return self._field

    def __repr__(self) -> str:
        closed = f"{np.count_nonzero(self.asperity_area > 0.0):,} of {len(self.asperity_area):,}"
        return (
            f"<ContactState: load {self.load:.4g} N, area {self.area:.4g} mm^2, "
            f"separation {self.separation:.4g} mm, stiffness {self.stiffness:.4g} N/mm, in contact {closed}, "
            f"model {self.model!r}, status {self.status.name.lower()}, residual {self.residual:.1e}, "
            f"{printed_count(self)}>"
        )


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
    words = "exactly one of load, approach and separation must be given; got"
    refuse_if(len(named) != 1, f"{words} {named or 'none'}")
    value = check.number(named[0], given[named[0]], at_least=None if load is None else 0.0)
    modulus, top = surface.material.composite_modulus, float(surface.height.max())
    if load is not None:
        curve = solver.curve(surface, np.array([value / modulus]))
    else:
        curve = solver.curve(surface, approach=np.array([value if separation is None else top - value]))
    last, reached = curve.last, float(curve.approach[0])
    notes = (*curve.notes, *last.notes)
    state = ContactState(
        load=modulus * float(curve.load[0]),
        area=float(curve.area[0]),
        separation=top - reached if separation is None else value,
        approach=reached,
        stiffness=modulus * float(curve.stiffness[0]),
        asperity_load=modulus * last.load,
        asperity_area=last.area,
        residual=float(curve.residual[0]),
        status=curve.status,
        model=last.model,
        base_gap=last.base_gap,
        _field=None if last.field is None else replace(last.field, pressure=modulus * last.field.pressure),
        **judged(surface, solver, curve, notes),
    )
    if not curve.converged:
        reason = "; ".join([f"residual {state.residual:.2g}", *map(str, notes)])
        raise NotConverged(f"{state.status.value}: {reason}; {REMEDY}", state)
    return state
