"""Automatic choice of the cheapest model whose error for a surface and load is within a tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.errors import MetafemError
from metafem.models.boundary_elements.model import (
    CELL_ERROR,
    MERGING_ERROR,
    BoundaryElements,
    resolvable,
)
from metafem.models.curve import Curve, ModelError, controlled
from metafem.models.independent import Independent, load_equation
from metafem.models.interacting.model import DENSE_LIMIT, Interacting
from metafem.models.load_equation import sunk
from metafem.models.model import WithoutGradients
from metafem.models.rungs import (
    DISPLACEMENTS,
    independent_error,
    order_3_error,
)
from metafem.notes import Level, Note, information
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface

# Factor of the cell if resolved contacts are computed again. The error is proportional to the square of the
# cell, within a fifth.
FINER = 0.9

# Minimum number of cells per radius of the largest contact.
FEWEST_CELLS = 10.0

UNSOLVED = ModelError(math.nan, "order 3 has no solution")

UNUSED_BLOCK = information("the surface's block is not used: the contacts are coupled through a half-space")


@dataclass(frozen=True)
class Automatic(WithoutGradients):
    """The cheapest model whose estimated error is within a tolerance.

    The models are `Independent`, `Interacting` of order 3, and `BoundaryElements`. They are solved in this
    order, and the error of each is estimated from its own solution:

    - independent asperities: the change of A0 by the displacements due to their loads;
    - order 3: a sum of (a/r)^5 over pairs of contacts, on a layer also a sum of (a/t)^5 over contacts, and
      for caps other than paraboloids the effect of the slopes of the neighbours' fields of the next order.

    The error of each model also includes the estimates for the models that follow it. Independent asperities
    are used only under load control. Their approach includes the sinking of the base, which is computed at
    some of the loads and interpolated between them.

    The contacts are resolved by sufficiently fine cells if the error of order 3 exceeds the tolerance, if
    contacts overlap, or if order 3 has no solution. The asperity models are still used at the lighter loads.
    Contacts cannot be resolved above 2000 asperities, in a periodic cell, or on substrates other than
    half-space and layer. Order 3 is used instead, and a warning states its estimated error.

    Contacts with adhesion or plasticity cannot be resolved either. Order 1 is used, its error is not
    estimated, and a warning says that the tolerance is not checked.

    Parameters
    ----------
    tolerance : float
        Largest relative error of A0(P), positive, compared with resolved contacts on the same substrate. The
        tolerance affects only the choice of the model. The equations are solved to the tolerance of that
        model.
    substrate : Substrate
        Default: `HalfSpace()`.
    contact : Contact
        Law of one contact; default: `Hertz()`.

    Raises
    ------
    InvalidInput
        For a tolerance that is not positive, or a substrate that cannot be used.
    NotConverged
        When solving, if the chosen model does not converge.

    Examples
    --------
    >>> from metafem import Material, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, Automatic(1e-3), load=0.5)
    >>> print(state.notes[0])
    chosen: order 3; its estimated error of A0(P) is 5.3e-06
    """

    title: ClassVar[str] = "automatic"

    tolerance: float = 1e-3
    substrate: Substrate = field(default_factory=HalfSpace)
    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        check.member(self, "tolerance", above=0.0)
        checked_contact(self.contact)
        _ = self.gradient_model  # raises InvalidInput for an unsuitable substrate

    @cached_property
    def _uncoupled(self) -> Independent:
        return Independent(self.contact)

    @cached_property
    def _point_loads(self) -> Interacting:
        return replace(self.gradient_model, order=1)

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,)."""
        unused = (UNUSED_BLOCK,) if surface.block is not None and self.substrate == HalfSpace() else ()
        if not resolvable(self.contact):
            alone = self.gradient_model.curve(surface, load, approach=approach)
            error = order_3_error(surface, alone.last.area, self.substrate, self.contact)
            text = f"chosen: order {self.gradient_model.order}; {error.source}: the tolerance is not checked"
            note = Note(text, Level.WARNING, bound=self.tolerance, remedies=("contact",))
            return alone.with_notes((note, *alone.notes, *unused), error)
        curve, error, title = self._asperities(surface, load, approach)
        if curve is not None and error <= self.tolerance:
            note = information(f"chosen: {title}; {_stated(error)}")
            return curve.with_notes((note, *curve.notes, *unused), error)
        if surface.cell or surface.count > DENSE_LIMIT or not isinstance(self.substrate, Radial):
            curve = curve or self.gradient_model.curve(surface, load, approach=approach)
            why = "resolved contacts are needed" if not surface.cell else "a periodic cell is not resolved"
            text = f"chosen: order 3; {_stated(error)}: {why}"
            note = self._note(text, error)
            return curve.with_notes((note, *curve.notes, *unused), error)
        reason = error.source
        if math.isfinite(error):
            reason = f"the estimated error of A0(P) by order 3 is {error:.1e}"
        curve = self._resolved(surface, *controlled(load, approach), self.substrate, error, reason)
        return curve.with_notes((*curve.notes, *unused))

    def _note(self, text: str, error: ModelError) -> Note:
        """Return a note with an estimated error, a warning unless this is within the tolerance."""
        level = Level.INFORMATION if error <= self.tolerance else Level.WARNING
        value = float(error) if math.isfinite(error) else None
        return Note(text, level, "error of order 3", value, self.tolerance, ("tolerance",))

    def _asperities(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None
    ) -> tuple[Curve | None, ModelError, str]:
        """Return the curve of the cheapest sufficient asperity model, its estimated error and its title.

        If none is sufficient, these are the curve, error and title of order 3; the curve is None if it fails.
        """
        if load is not None:
            curve, error = self._independent(surface, load)
            if curve is not None:
                return curve, error, "independent asperities"
        return *self._order_3(surface, load, approach), "order 3"

    def _independent(self, surface: Surface, load: FloatArray) -> tuple[Curve | None, ModelError]:
        """Return the curve of independent asperities on a sinking base, with its largest estimated error.

        If they do not converge or their error exceeds the tolerance, return None.
        """
        curve = self._uncoupled.curve(surface, load)
        if not curve.converged:
            return None, UNSOLVED
        if not curve.area.any():
            return curve, ModelError(0.0, "there is no contact")
        equation = load_equation(self.contact.bound(surface), self._uncoupled)
        bound = self.substrate.for_surface(surface)
        error, sinking = independent_error(equation, surface, bound, curve, self.tolerance)
        found = ModelError(error, DISPLACEMENTS)
        return sunk(curve, sinking) if error <= self.tolerance else None, found

    def _order_3(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None
    ) -> tuple[Curve | None, ModelError]:
        """Return the curve of order 3 with the estimated error of its last state; None if it fails."""
        try:
            curve = self.gradient_model.curve(surface, load, approach=approach)
        except MetafemError:
            return None, UNSOLVED
        if not curve.converged:
            return None, UNSOLVED
        return curve, order_3_error(surface, curve.last.area, self.substrate, self.contact)

    def _resolved(
        self,
        surface: Surface,
        values: FloatArray,
        by_load: bool,
        substrate: Radial,
        error: float,
        reason: str,
    ) -> Curve:
        """Return a curve of asperity models at light loads, and of resolved contacts from there on."""

        low, high = 0, len(values) - 1  # the error grows with the load: bisection
        while low < high:
            middle = (low + high) // 2
            _, estimate = self._order_3(surface, *_control(values[middle : middle + 1], by_load))
            low, high = (middle + 1, high) if estimate <= self.tolerance else (low, middle)
        parts = []
        if low:
            light, estimate, title = self._asperities(surface, *_control(values[:low], by_load))
            if light is not None:
                end = surface.material.composite_modulus * float(light.load[-1])
                note = information(f"chosen up to {end:.4g} N: {title}; {_stated(estimate)}")
                parts.append(light.with_notes((note, *light.notes), estimate))
            else:
                low = 0
        cell = self._cell(surface, *_control(values[low : low + 1], by_load), error)
        load, approach = _control(values[low:], by_load)
        model = BoundaryElements(cell, substrate, self.contact)
        heavy = model.curve(surface, load, approach=approach)
        if heavy.error is not None and heavy.error > self.tolerance:  # the contacts are smaller than assumed
            model = replace(model, cell=FINER * cell * math.sqrt(self.tolerance / heavy.error))
            heavy = model.curve(surface, load, approach=approach)
        note = information(f"chosen: resolved contacts with cells of {model.cell:.3g} mm; {reason}")
        parts.append(heavy.with_notes((note, *heavy.notes)))
        return Curve.joined(parts)

    def _cell(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None, error: float
    ) -> float:
        """Return the side of the cells [mm] with which the error of A0 is within the tolerance.

        error: the estimated error of order 3, nan if contacts overlap.
        The contacts are computed by order 1, or as independent asperities if order 1 has no solution.
        """
        try:
            last = self._point_loads.curve(surface, load, approach=approach).checked().last
        except MetafemError:
            last = self._uncoupled.curve(surface, load, approach=approach).last
        count = int((last.area > 0.0).sum())
        cells = CELL_ERROR if math.isfinite(error) else MERGING_ERROR
        cell = math.sqrt(self.tolerance * float(last.area.sum()) / (cells * count))
        return min(cell, math.sqrt(float(last.area.max()) / math.pi) / FEWEST_CELLS)


def _control(values: FloatArray, by_load: bool) -> tuple[FloatArray | None, FloatArray | None]:
    """Return loads and approaches, one of which is None."""
    return (values, None) if by_load else (None, values)


def _stated(error: ModelError) -> str:
    """Return text on an estimated error, or the reason why it is unknown."""
    if math.isnan(error):
        return f"its error of A0(P) is unknown, as {error.source}"
    return f"its estimated error of A0(P) is {error:.1e}"
