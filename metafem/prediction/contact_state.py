"""The equilibrium of one surface at one load, in N."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.drawing import card
from metafem.errors import InvalidInput
from metafem.models import ContactField, Model, Status
from metafem.models.curve import ModelError
from metafem.notes import Note, late, printed_count
from metafem.prediction.validity import NOT_ESTIMATED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Millinewtons per newton.
MILLINEWTONS = 1e3


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
    <ContactState: load 0.01 N, area 0.07696 mm^2, separation 0.08672 mm, 2 of 2 asperities in contact, ...>
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
            raise InvalidInput(
                f"{self.model!r} has no pressure field; solve with metafem.BoundaryElements(cell=...)"
            )
        return self._field

    def __repr__(self) -> str:
        facts = self._facts()
        parts = [f"{name} {facts[name]}" for name in ("load", "area", "separation")]
        return (
            f"<ContactState: {', '.join(parts)}, {facts['in contact']}, {self.model!r}, "
            f"{self.status.name.lower()}, residual {facts['residual']}, {facts['notes']}>"
        )

    def _repr_html_(self) -> str:
        """Return the HTML representation for notebooks."""
        loads = self.asperity_load[self.asperity_area > 0.0]

        def distribution(ax: Axes) -> None:
            card.distribution(ax, MILLINEWTONS * loads, "load of an asperity in contact [mN]")

        draw = self._field.plot if self._field is not None else distribution
        shown = self._field is not None or len(loads) >= card.FEWEST
        return card.card("Contact state", self._facts(), draw if shown else None)

    def _facts(self) -> dict[str, str]:
        """Return the quantities for the printed summary."""
        closed = int(np.count_nonzero(self.asperity_area > 0.0))
        return {
            "load": f"{self.load:.4g} N",
            "area": f"{self.area:.4g} mm^2",
            "separation": f"{self.separation:.4g} mm",
            "stiffness": f"{self.stiffness:.4g} N/mm",
            "in contact": f"{closed:,} of {len(self.asperity_area):,} asperities in contact",
            "model": repr(self.model),
            "status": self.status.value,
            "residual": f"{self.residual:.1e}",
            "notes": printed_count(self),
        }
