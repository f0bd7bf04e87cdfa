"""The cheapest model whose error is within a tolerance for a given surface and load."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.errors import MetafemError
from metafem.models.boundary_elements.model import BoundaryElements, resolvable
from metafem.models.curve import Curve, controlled
from metafem.models.independent import Independent, load_equation
from metafem.models.interacting.model import DENSE_LIMIT, Interacting
from metafem.models.load_equation import sunk
from metafem.models.model import WithoutGradients
from metafem.models.rungs import independent_errors, order_1_error, probed
from metafem.models.truncation import truncation
from metafem.notes import Level, Note, information
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface

# Error of the area of one contact by `BoundaryElements`, in cells: 7, and a quarter more for safety; and the
# minimum number of cells per radius of the largest contact.
CELL_ERROR = 9.0

# The same error where contacts merge or nearly touch, with narrow gaps between them: measured up to 11.
MERGING_ERROR = 30.0
FEWEST_CELLS = 10.0

UNUSED_BLOCK = information("the surface's block is not used: the contacts are coupled through a half-space")


@dataclass(frozen=True)
class Automatic(WithoutGradients):
    """The first of `Independent`, `Interacting` of orders 1 and 3, and `BoundaryElements` within a tolerance.

    Each model is solved in turn and its error is estimated from its own contacts. For independent asperities
    it is the change of A0 by their displacements, which one product with the influence gives; for order 1
    that by the equations of order 3; for order 3 the sum of (a/r)^5 over pairs of contacts, and of (a/t)^5 on
    a layer, and for caps other than paraboloids the effect of the slopes of the neighbours' fields. The
    estimates of the later models are added to those of the earlier ones. Independent asperities are used at
    given loads only; their approach includes the sinking of the base, interpolated between some of the loads.

    If order 3 exceeds the tolerance, contacts overlap, or it has no solution, the contacts are resolved by
    sufficiently fine cells, and the asperity models are used at the lighter loads. Above 2000 asperities, and
    on substrates other than half-space and layer, contacts cannot be resolved; a warning then states the
    estimated error of order 3. Contacts of laws with adhesion or plasticity cannot be resolved either: the
    asperity model of the highest order that the law supports is used. For adhesive contacts that is order 3.
    Its estimated error is compared with the tolerance, and a note states it, as a warning above the
    tolerance. For plastic contacts it is order 1, whose error is not estimated, and a warning says that the
    tolerance is not checked.

    Parameters
    ----------
    tolerance : float
        Relative error of A0(P) against resolved contacts on the same substrate, positive. It governs only
        the choice; the equations are solved to the tolerance of the chosen model.
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
    chosen: order 1; its estimated error of A0(P) is 7.0e-04
    """

    title: ClassVar[str] = "automatic"

    tolerance: float = 1e-3
    substrate: Substrate = field(default_factory=HalfSpace)
    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        check.member(self, "tolerance", above=0.0)
        checked_contact(self.contact)
        _ = self.gradient_model  # checks the substrate, and the contact on it

    @cached_property
    def _uncoupled(self) -> Independent:
        return Independent(self.contact)

    @cached_property
    def _point_loads(self) -> Interacting:
        return replace(self.gradient_model, order=1)

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,)."""
        unused = (UNUSED_BLOCK,) if surface.block is not None and self.substrate == HalfSpace() else ()
        if not resolvable(self.contact):
            alone = self.gradient_model.curve(surface, load, approach=approach)
            return alone.with_notes((self._unchecked(surface, alone), *alone.notes, *unused))
        curve, error, title = self._asperities(surface, load, approach)
        if curve is not None and error <= self.tolerance:
            note = information(f"chosen: {title}; its estimated error of A0(P) is {error:.1e}")
            return curve.with_notes((note, *curve.notes, *unused))
        if surface.count > DENSE_LIMIT or not isinstance(self.substrate, Radial):
            curve = curve or self.gradient_model.curve(surface, load, approach=approach)
            text = f"order 3; its estimated error of A0(P) is {error:.1e}: resolved contacts are needed"
            return curve.with_notes((Note(f"chosen: {text}", Level.WARNING), *curve.notes, *unused))
        reason = "order 3 has no solution" if curve is None else "contacts overlap"
        if math.isfinite(error):
            reason = f"the estimated error of A0(P) by order 3 is {error:.1e}"
        curve = self._resolved(surface, *controlled(load, approach), self.substrate, error, reason)
        return curve.with_notes((*curve.notes, *unused))

    def _unchecked(self, surface: Surface, curve: Curve) -> Note:
        """Return a note that the tolerance is not checked for a law whose contacts cannot be resolved."""
        order = f"order {self.gradient_model.order}"
        rest = f"contacts of {self.contact!r} cannot be resolved, so the tolerance of {self.tolerance:g} is"
        if self.gradient_model.order == 1:
            text = f"chosen: {order}, as the law has no profile; {rest} not checked"
            return Note(text, Level.WARNING)
        error = truncation(surface, curve.last.area, self.substrate, self.contact)
        text = f"chosen: {order}; its estimated error of A0(P) is {error:.1e}; {rest} checked by this alone"
        return Note(text, Level.INFORMATION if error <= self.tolerance else Level.WARNING)

    def _asperities(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None
    ) -> tuple[Curve | None, float, str]:
        """Return the curve of the first sufficient asperity model, its estimated error and its title."""
        if load is not None:
            curve, error = self._independent(surface, load)
            if curve is not None:
                return curve, error, "independent asperities"
        curve, error = self._order_1(surface, load, approach)
        if curve is not None:
            return curve, error, "order 1"
        return *self._order_3(surface, load, approach), "order 3"

    def _independent(self, surface: Surface, load: FloatArray) -> tuple[Curve | None, float]:
        """Return the curve of independent asperities on a sinking base, or None above the tolerance.

        The second value is the largest estimated error.
        """
        curve = self._uncoupled.curve(surface, load)
        rows = probed(load, surface.count)
        if not rows.size or not curve.converged:
            return (curve, 0.0) if curve.converged else (None, math.inf)
        equation = load_equation(self.contact.for_material(surface.material), self._uncoupled)
        bound = self.substrate.for_surface(surface)
        for some in (rows[-1:], rows):  # the error is usually largest at the last load
            error, sinking = independent_errors(equation, surface, curve, some, bound)
            if error.max() > self.tolerance:
                return None, math.inf
        return sunk(curve, np.interp(load, load[rows], sinking)), float(error.max())

    def _order_1(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None
    ) -> tuple[Curve | None, float]:
        """Return the curve of order 1 with its largest estimated error, or None above the tolerance."""
        point = self._point_loads
        values, by_load = controlled(load, approach)
        if len(values) > 1:  # the error is usually largest at the last load
            last = (values[-1:], None) if by_load else (None, values[-1:])
            if self._order_1(surface, *last)[0] is None:
                return None, math.inf
        try:
            if load is None:
                curve = point.curve(surface, approach=approach)
                indentation = curve.last.indentation[None]
            else:
                found = point.sensitivity(surface, load)
                curve, indentation = found.curve, found.indentation
        except MetafemError:
            return None, math.inf
        error = truncation(surface, curve.last.area, self.substrate, self.contact)
        if not curve.converged or error > self.tolerance:
            return None, math.inf
        error += order_1_error(self.gradient_model, surface, curve, indentation)
        return (curve, error) if error <= self.tolerance else (None, math.inf)

    def _order_3(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None
    ) -> tuple[Curve | None, float]:
        """Return the curve by order 3 with the estimated error of its last state, or None if it fails."""
        try:
            curve = self.gradient_model.curve(surface, load, approach=approach)
        except MetafemError:
            return None, math.inf
        if not curve.converged:
            return None, math.inf
        return curve, truncation(surface, curve.last.area, self.substrate, self.contact)

    def _resolved(
        self,
        surface: Surface,
        values: FloatArray,
        by_load: bool,
        substrate: Radial,
        error: float,
        reason: str,
    ) -> Curve:
        """Return the curve by order 3 up to the first value that needs resolved contacts, then by those."""

        def control(rows: slice) -> tuple[FloatArray | None, FloatArray | None]:
            """Return loads and approaches, one of them None."""
            return (values[rows], None) if by_load else (None, values[rows])

        low, high = 0, len(values) - 1  # the error grows with the load, and the last one needs them
        while low < high:
            middle = (low + high) // 2
            _, estimate = self._order_3(surface, *control(slice(middle, middle + 1)))
            low, high = (middle + 1, high) if estimate <= self.tolerance else (low, middle)
        parts = []
        if low:
            light, estimate, title = self._asperities(surface, *control(slice(low)))
            if light is not None:
                end = surface.material.composite_modulus * float(light.load[-1])
                text = f"chosen up to {end:.4g} N: {title}; its estimated error of A0(P) is {estimate:.1e}"
                parts.append(light.with_notes((information(text), *light.notes)))
            else:
                low = 0
        cell = self._cell(surface, *control(slice(low, low + 1)), error)
        model = BoundaryElements(cell, substrate, self.contact)
        load, approach = control(slice(low, None))
        heavy = model.curve(surface, load, approach=approach)
        note = information(f"chosen: resolved contacts with cells of {model.cell:.3g} mm; {reason}")
        parts.append(heavy.with_notes((note, *heavy.notes)))
        return Curve.joined(parts)

    def _cell(
        self, surface: Surface, load: FloatArray | None, approach: FloatArray | None, error: float
    ) -> float:
        """Return the side of the cells [mm] for which the error of A0 is within the tolerance.

        error: the estimate for order 3, infinite where contacts merge or nearly touch.
        The contacts are taken from order 1, or from independent asperities where it has no solution.
        """
        point = Interacting(1, self.substrate, self.contact)
        try:
            last = point.curve(surface, load, approach=approach).checked().last
        except MetafemError:
            last = Independent(self.contact).curve(surface, load, approach=approach).last
        count = int((last.area > 0.0).sum())
        cells = CELL_ERROR if math.isfinite(error) else MERGING_ERROR
        cell = math.sqrt(self.tolerance * float(last.area.sum()) / (cells * count))
        return min(cell, math.sqrt(float(last.area.max()) / math.pi) / FEWEST_CELLS)
