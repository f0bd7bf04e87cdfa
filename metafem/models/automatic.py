"""Automatic choice of the cheapest model whose error for a surface and load is within a tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, cast

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import checked_contact
from metafem.errors import MetafemError
from metafem.models.boundary_elements.model import resolvable, within
from metafem.models.curve import Curve, ModelError, controlled
from metafem.models.error import DISPLACEMENTS, RADII, coupled, independent_errors, largest, unresolved
from metafem.models.independent import Independent
from metafem.models.interacting.elastic import DENSE_LIMIT
from metafem.models.model import WithoutGradients
from metafem.notes import Level, Note, information
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface

# What a model of the ladder returns: its name, its curve if it has a solution, its errors (k,), their source.
Rung = tuple[str, Curve | None, FloatArray, str]


@dataclass(frozen=True)
class Automatic(WithoutGradients):
    """The cheapest model whose estimated error is within a tolerance.

    The models are `Independent`, `Interacting` of order 3, and `BoundaryElements`. The choice is made at each
    load of a curve, which may consist of parts; a note states the loads of each. The models are solved in
    this order, and the error of each is estimated from its own solution:

    - independent asperities: the change of A0 by the displacements due to their loads;
    - order 3: a sum of (a/r)^5 over pairs of contacts, on a layer also a sum of (a/t)^5 over contacts, and
      for caps other than paraboloids the effect of the slopes of the neighbours' fields of the next order.

    The error of each model also includes the estimates for the models that follow it. Independent asperities
    are used only under load control. Their approach includes the sinking of the base, and their stiffness its
    derivative; both are computed at some of the loads and interpolated between them, like their error.

    The contacts are resolved by sufficiently fine cells if the error of order 3 exceeds the tolerance, if
    contacts overlap, or if order 3 has no solution. Contacts cannot be resolved above 2000 asperities, in a
    periodic cell, or on substrates other than half-space and layer. Order 3 is used instead, and a warning
    states its estimated error.

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

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,)."""
        values, by_load = controlled(load, approach)
        end = self._end(surface)
        rungs = [self._independent] if by_load and self._resolvable else []
        rungs += [self._coupled] if end else [self._coupled, self._resolved]
        unsolved = "order 3 has no solution" if self._resolvable else unresolved(self.contact)
        parts: list[tuple[IntArray, Curve]] = []
        left: IntArray = np.arange(len(values))
        reason = ""
        for rung in rungs:
            name, curve, errors, source = rung(surface, values[left], by_load)
            enough = errors <= self.tolerance if rung != rungs[-1] else np.full(len(left), True)
            if curve is not None and enough.any():
                curve = curve if enough.all() else curve.part(np.flatnonzero(enough), curve.compute_last)
                error, where = largest(errors[enough], source, unsolved), ""
                if len(curve.load) < len(values):
                    newtons = surface.material.composite_modulus * curve.load[[0, -1]]
                    ends = " to ".join(dict.fromkeys(f"{newton:.4g}" for newton in newtons))
                    where = f" at {len(curve.load)} of {len(values)} loads, {ends} N"
                note = self._note(f"chosen{where}: {name}" + reason * (rung == self._resolved), error, end)
                parts.append((left[enough], curve.with_notes((note, *curve.notes), error)))
            if enough.all():
                break
            left, error = left[~enough], largest(errors[~enough], source)
            reason = f", as the estimated error of A0(P) by {name} is {error:.1e}"
            if math.isnan(error):
                reason = f", as {error.source}"
        if len(parts) == 1:
            return parts[0][1]
        rows, curves = zip(*sorted(parts, key=lambda part: int(part[0][-1])), strict=True)
        whole = Curve.joined(list(curves))
        return whole.part(np.argsort(np.concatenate(rows)), whole.compute_last)

    @cached_property
    def _resolvable(self) -> bool:
        return resolvable(self.contact)

    def _end(self, surface: Surface) -> str:
        """Return why the ladder ends at coupled asperities; empty if the contacts can be resolved."""
        if not self._resolvable:
            return "the tolerance is not checked"
        if surface.cell:
            return "a periodic cell is not resolved"
        radial = isinstance(self.substrate, Radial) and surface.count <= DENSE_LIMIT
        return "" if radial else "resolved contacts are needed"

    def _independent(self, surface: Surface, values: FloatArray, by_load: bool) -> Rung:
        """Return independent asperities on a sinking base."""
        alone = Independent(self.contact).curve(surface, values).checked()
        sunk, errors = independent_errors(surface, self.contact, self.substrate, alone)
        return "independent asperities", sunk, errors, DISPLACEMENTS

    def _coupled(self, surface: Surface, values: FloatArray, by_load: bool) -> Rung:
        """Return the highest order of the law; the errors are nan where it has no solution, or unknown."""
        model, errors, end = self.gradient_model, np.full(len(values), math.nan), self._end(surface)
        curve = None
        try:
            if by_load and self._resolvable:
                curve, errors = coupled(surface, model, values)
            if curve is None or (end and not (errors <= self.tolerance).all()):
                curve = model.curve(surface, **_control(values, by_load))  # refuses contacts too wide
            if self._resolvable and not by_load and curve.solved.any():
                errors[curve.solved] = coupled(surface, model, curve.load[curve.solved])[1]
        except MetafemError:
            if end:
                raise
        return f"order {model.order}", curve, errors, RADII

    def _resolved(self, surface: Surface, values: FloatArray, by_load: bool) -> Rung:
        """Return resolved contacts, with the same cells at all loads."""
        control, substrate = _control(values, by_load), cast("Radial", self.substrate)
        model, curve = within(self.tolerance, surface, substrate, self.contact, **control)
        errors = np.full(len(values), math.nan if curve.error is None else curve.error)
        return f"resolved contacts with cells of {model.cell:.3g} mm", curve, errors, "the number of cells"

    def _note(self, name: str, error: ModelError, end: str) -> Note:
        """Return the note on a choice, a warning if its error is not within the tolerance."""
        value = float(error) if math.isfinite(error) else None
        text = f"{name}; its estimated error of A0(P) is {error:.1e}"
        if value is None:
            text = f"{name}; its error of A0(P) is unknown, as {error.source}"
        if error <= self.tolerance:
            return information(text)
        text += f": {end}" if end else ""
        return Note(text, Level.WARNING, "error of order 3", value, self.tolerance, ("tolerance",))


def _control(values: FloatArray, by_load: bool) -> dict[str, Any]:
    """Return the arguments for a curve at loads or approaches."""
    return {"load" if by_load else "approach": values}
