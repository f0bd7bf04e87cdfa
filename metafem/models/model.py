"""The model protocol and what a model returns."""

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
        What was promised for this surface, where that is looser than the model's own tolerance.
    notes : tuple of Note
        What a reader of the law must know of the solution.
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
    """Equilibrium of one surface under one load.

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
        What was skipped and by which bound, and what the model leaves out.
    field : ContactField
        Pressure, gap and displacement on cells, of `BoundaryElements` alone; any other model raises
        InvalidInput.

    Notes
    -----
    The base between the summits sinks with them. A load on asperity j displaces the whole surface, the base
    beside asperity i as much as its summit: by u_i, the sum over the other asperities and over what the
    block adds to a half-space's answer to its own load. What is left beside asperity i is then
    ``separation + u_i``, and where it is in contact that is ``h_i - d_i``, its height less its indentation.
    The base gap is the least of these: the separation itself for independent asperities, and more by the
    common sinking in the mean field. The contact's own Hertzian displacement of the ground around it, and
    that of its cap's foot, are not counted: both only widen the gap. Base that lies beside the array does not
    sink with it; a plane that reaches far beyond the array touches there at zero separation.

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
        """What a person calls the model, also as ``--model``."""
        ...

    @property
    def couples(self) -> bool:
        """Whether contacts change one another's load, so that A0(P) depends on the sites."""
        ...

    @property
    def gradient_model(self) -> Sensitive:
        """Model whose sensitivities an inversion under this one uses: itself where it has its own."""
        ...

    @property
    def reference(self) -> Interacting:
        """What this model is judged by: asperities that interact by order 3, on its substrate."""
        ...

    def solve(self, surface: Surface, approach: float) -> ContactState:
        """Equilibrium at a given approach [mm]."""
        ...

    def solve_load(self, surface: Surface, load: float) -> ContactState:
        """Equilibrium under a given rescaled load P/E* [mm^2]."""
        ...

    def curve(self, surface: Surface, load: FloatArray) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2], (k,)."""
        ...

    def curve_at(self, surface: Surface, approach: FloatArray) -> Curve:
        """Equilibria at increasing approaches [mm], (k,)."""
        ...


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """A law at loads (k,) and how its area changes with the heights (n,) at fixed load.

    Attributes
    ----------
    curve : Curve
    gradient : ndarray, (k, n)
        dA0/dh [mm].
    indentation : ndarray, (k, n)
        Of each asperity [mm]; an open one has its gap, negative.
    """

    curve: Curve
    gradient: FloatArray
    indentation: FloatArray


class Sensitive(Model, Protocol):
    """A model with the derivatives of its law by the heights."""

    def sensitivity(self, surface: Surface, load: FloatArray) -> Sensitivity:
        """Law at increasing rescaled loads P/E* (k,), and how it changes with each height at fixed load."""
        ...
