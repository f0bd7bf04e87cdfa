"""The protocol of all models, and their results."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import InvalidInput
from metafem.models.boundary_elements.field import ContactField
from metafem.notes import Note, counted, late_notes
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.models.interacting.model import Interacting


class Status(Enum):
    """How a solution ended; the value is the message."""

    CONVERGED = "converged: the residual is within the model's tolerance"
    NOT_CONVERGED = "not converged: the residual exceeds the model's tolerance"


@dataclass(frozen=True, eq=False)
class Curve:
    """Equilibria of one surface along a list of loads or approaches, all arrays (k,).

    Attributes
    ----------
    approach : ndarray
        Tallest summit minus separation [mm].
    load : ndarray
        Rescaled load P/E* [mm^2], recomputed at the approach.
    area : ndarray
        Real contact area [mm^2].
    stiffness : ndarray
        Derivative of the rescaled load by the approach [mm].
    residual : ndarray
        Largest relative error of the equations (0: none) on what is returned.
    tolerance : float
        Tolerance of the residual for this surface, where it is larger than that of the model.
    notes : tuple of Note
        Approximations of the solution.
    """

    approach: FloatArray
    load: FloatArray
    area: FloatArray
    stiffness: FloatArray
    residual: FloatArray
    tolerance: float = 0.0
    notes: tuple[Note, ...] = ()

    @classmethod
    def joined(cls, parts: list[Curve]) -> Curve:
        """Return one curve from consecutive ones."""

        def whole(name: str) -> FloatArray:
            return np.concatenate([getattr(part, name) for part in parts])

        return cls(
            whole("approach"),
            whole("load"),
            whole("area"),
            whole("stiffness"),
            whole("residual"),
            max(part.tolerance for part in parts),
            tuple(dict.fromkeys(note for part in parts for note in part.notes)),
        )


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
        Distance of the plane from the undeformed base plane [mm].
    approach : float
        Tallest summit minus separation [mm]; keeps its digits at light loads.
    stiffness : float
        Normal contact stiffness, dP per decrease of the separation [N/mm], not negative.
    asperity_load, asperity_area : ndarray, (n,)
        Load [N] and area [mm^2] of each asperity.
    residual : float
        ``max(max |F_i| / max d, |sum P_i - P| / P)``, recomputed on this state.
    status : Status
    model : object
        The model that was solved.
    base_gap : float
        Smallest distance left between the plane and the base plane beside a summit [mm], see below.
    notes : tuple of Note
        Approximations of the solution with their bounds, and estimates of what the model neglects.
    field : ContactField
        Pressure, gap and displacement on the cells of `BoundaryElements`; InvalidInput is raised for any
        other model.

    Notes
    -----
    The base between the summits is displaced with them. A load on asperity j displaces the whole surface, and
    the base beside asperity i as much as its summit: by u_i, the sum over the other asperities and over the
    regular self term of the block. The gap beside asperity i is then ``separation + u_i``; for an asperity in
    contact that is ``h_i - d_i``, its height minus its indentation. The base gap is the smallest of these.
    For independent asperities it is the separation; the mean field adds the uniform displacement.
    The Hertzian displacement around the contact itself, and that of the foot of its cap, are not included;
    both increase the gap. The base outside the array is not displaced: a plane that extends far beyond the
    array touches it there at zero separation.

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
    notes: tuple[Note, ...] = late_notes()
    _field: ContactField | None = None

    @property
    def field(self) -> ContactField:
        """Pressure, gap and displacement on cells; raises InvalidInput for models without cells."""
        if self._field is None:
            raise InvalidInput(
                f"{self.model!r} has no pressure field; solve with metafem.BoundaryElements(cell=...)"
            )
        return self._field

    def __repr__(self) -> str:
        closed = int((self.asperity_area > 0.0).sum())
        return (
            f"<ContactState: load {self.load:.4g} N, area {self.area:.4g} mm^2, separation "
            f"{self.separation:.4g} mm, {closed} of {len(self.asperity_area)} asperities in contact, "
            f"{self.model!r}, {self.status.name.lower()}, residual {self.residual:.1e}, "
            f"{counted(self.notes)}>"
        )


@runtime_checkable
class Model(Protocol):
    """A frozen value that turns a surface and a load into an equilibrium."""

    @property
    def tolerance(self) -> float:
        """Largest residual of a converged state."""
        ...

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``."""
        ...

    @property
    def couples(self) -> bool:
        """Whether contacts interact, so that A0(P) depends on the sites."""
        ...

    @property
    def gradient_model(self) -> Sensitive:
        """Model whose sensitivities an inversion under this one uses: itself if it has sensitivities."""
        ...

    @property
    def reference(self) -> Interacting:
        """Model with which this one is compared: `Interacting` of order 3 on its substrate."""
        ...

    def solve(self, surface: Surface, approach: float) -> ContactState:
        """Equilibrium at a given approach [mm]."""
        ...

    def solve_load(self, surface: Surface, load: float) -> ContactState:
        """Equilibrium at a given rescaled load P/E* [mm^2]."""
        ...

    def curve(self, surface: Surface, load: FloatArray) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2], (k,)."""
        ...

    def curve_at(self, surface: Surface, approach: FloatArray) -> Curve:
        """Equilibria at increasing approaches [mm], (k,)."""
        ...


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """A law at loads (k,) with the derivatives of its area by the heights (n,) at fixed load.

    Attributes
    ----------
    curve : Curve
    gradient : ndarray, (k, n)
        dA0/dh [mm].
    indentation : ndarray, (k, n)
        Indentation of each asperity [mm]; for an open one its gap, negative.
    """

    curve: Curve
    gradient: FloatArray
    indentation: FloatArray


class Sensitive(Model, Protocol):
    """A model with the derivatives of its law by the heights."""

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads P/E* (k,), with dA0/dh of each height at fixed load.

        height: summit heights (n,) [mm] in place of the surface's own; they are not checked.
        """
        ...
