"""The cheapest model that is within a tolerance for a given surface and load."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from metafem import _validate as check
from metafem._calls import checked_class
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, NotConverged
from metafem.models.boundary_elements.model import BoundaryElements
from metafem.models.independent import Independent
from metafem.models.interacting.model import DENSE_LIMIT, Interacting
from metafem.models.model import Curve, Model, controlled
from metafem.models.stand_in import WithoutGradients
from metafem.models.truncation import truncation
from metafem.notes import Level, Note, information
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface

# Relative error of the area times the square of the number of cells per contact radius, as `BoundaryElements`
# states it, and the smallest number that is used.
CELL_ERROR = 0.37
FEWEST_CELLS = 10.0

# The asperity models in the notes.
NAMES = ("independent", "order 1", "order 3")

ASIDE = "the surface's block is not used: the contacts are coupled through a half-space"


@checked_class
@dataclass(frozen=True)
class Automatic(WithoutGradients):
    """Choose among `Independent`, `Interacting` and `BoundaryElements` by estimates of their errors.

    The error of order 3 is estimated as (a/r)^5 from the contacts of the independent model. The cheaper
    models are compared with order 3 at up to three of the loads. The cheapest model within the tolerance is
    used; if there is none, `BoundaryElements` with sufficiently fine cells. Above 2000 asperities order 3 is
    always the last choice, and a note states its estimated error where that exceeds the tolerance.

    Parameters
    ----------
    tolerance : float
        Relative error of A0(P) against resolved contacts on the same substrate, positive. It applies to
        the choice; the equations are solved to the tolerance of the chosen model.
    substrate : Substrate

    Raises
    ------
    InvalidInput
        For a tolerance that is not positive, or a substrate that cannot be used.

    Examples
    --------
    >>> from metafem import Material, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> equilibrium(surface, Automatic(1e-3), load=0.5).model
    Interacting(order=1, substrate=HalfSpace(), contact=Hertz(), pedestal=False)
    """

    title: ClassVar[str] = "automatic"

    tolerance: float = 1e-3
    substrate: Substrate = field(default_factory=HalfSpace)

    def __post_init__(self) -> None:
        value = check.number("tolerance", self.tolerance, above=0.0)
        object.__setattr__(self, "tolerance", value)
        Interacting(substrate=self.substrate)  # checks the substrate

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,); see `_parts`.

        At a given approach even a uniform displacement changes the load. The choice is therefore made for
        A0(P) at the loads of interacting point loads at these approaches.
        """
        values, by_load = controlled(load, approach)
        point = Interacting(order=1, substrate=self.substrate)
        loads = values if by_load else point.curve(surface, approach=values).load
        parts = []
        for model, rows, notes in self._parts(surface, loads):
            if by_load:
                curve = model.curve(surface, values[rows])
            else:  # the load of independent asperities at this approach would be different
                curve = (model if model.couples else point).curve(surface, approach=values[rows])
            parts.append(replace(curve.checked(), notes=notes))
        return Curve.joined(parts)

    def _parts(self, surface: Surface, load: FloatArray) -> list[tuple[Model, slice, tuple[Note, ...]]]:
        """Return a model for all loads, or one below the first load that needs resolved contacts."""
        model, notes = self._choice(surface, load)
        if model == model.gradient_model:  # asperities
            return [(model, slice(0, len(load)), notes)]
        low, high = 0, len(load) - 1  # the last one needs resolved contacts: errors grow with the load
        while low < high:
            middle = (low + high) // 2
            held = load[middle] <= 0.0 or self._truncation(surface, float(load[middle])) <= self.tolerance
            low, high = (middle + 1, high) if held else (low, middle)
        parts: list[tuple[Model, slice, tuple[Note, ...]]] = []
        for rows in (slice(0, low), slice(low, len(load))):
            if rows.stop > rows.start:
                model, (note, *rest) = self._choice(surface, load[rows])
                end = surface.material.composite_modulus * load[rows][-1]
                parts.append((model, rows, (information(f"up to {end:.4g} N: {note}"), *rest)))
        return parts

    def _choice(self, surface: Surface, load: FloatArray) -> tuple[Model, tuple[Note, ...]]:
        """Return the chosen model with its notes."""
        loads = load[load > 0.0]
        if not loads.size:
            return Independent(), (information(f"chosen: {NAMES[0]}; there are no contacts"),)
        errors = self._errors(surface, loads)
        found = next(((name, model) for name, model, error in errors if error <= self.tolerance), None)
        stated = ", ".join(f"{name} {error:.1e}" for name, _, error in errors)
        why, level = f"estimated errors of A0(P): {stated}", Level.INFORMATION
        if found is None:
            why = f"{why}; more than {self.tolerance:g}"
            bound = self.substrate.for_surface(surface)
            if surface.count > DENSE_LIMIT or not isinstance(bound, Radial):
                found, level = (NAMES[-1], self.gradient_model), Level.WARNING
                why = f"{why}: resolved contacts are needed"
            else:
                cells = max(FEWEST_CELLS, math.sqrt(CELL_ERROR / self.tolerance))
                largest = float(_contact_radius(surface, loads[0]).max())
                found = "resolved contacts", BoundaryElements(largest / cells, bound)
                why = f"{why}: resolved by {cells:.0f} cells per contact radius"
        name, model = found
        notes = [Note(f"chosen: {name}; {why}", level)]
        if surface.block is not None and isinstance(self.substrate, HalfSpace):
            notes.append(information(ASIDE))
        return model, tuple(notes)

    def _errors(self, surface: Surface, load: FloatArray) -> list[tuple[str, Model, float]]:
        """Return the asperity models with relative errors of A0 at positive loads, the cheapest first.

        The error of a cheaper model is its difference from order 3 plus the error of order 3. Models after
        the first that is within the tolerance are left out, and so are the cheaper ones where order 3 is
        not within it or has no solution.
        """
        reference = self.gradient_model
        last = self._truncation(surface, load[-1])
        models: tuple[Model, ...] = (Independent(), replace(reference, order=1))
        probed = np.unique(load[[0, load.size // 2, -1]])
        errors: list[float] = []
        if last <= self.tolerance:
            try:
                full = reference.curve(surface, probed).checked().area
                for model in models:
                    area = model.curve(surface, probed).checked().area
                    errors.append(float(np.abs(area / full - 1.0).max()) + last)
                    if errors[-1] <= self.tolerance:  # it will be chosen
                        break
            except (NotConverged, InvalidInput):
                last = math.inf
        return [*zip(NAMES, models, errors, strict=False), (NAMES[-1], reference, last)]

    def _truncation(self, surface: Surface, load: float) -> float:
        """Return the estimated relative error of A0 by order 3 at a rescaled load."""
        return truncation(surface, _contact_radius(surface, load), self.substrate)


def _contact_radius(surface: Surface, load: float) -> FloatArray:
    """Return the contact radii of independent asperities (n,) [mm]; coupled ones hardly exceed them."""
    return np.sqrt(Independent().curve(surface, np.array([load])).last.area / math.pi)
