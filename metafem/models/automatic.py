"""The cheapest model that holds a tolerance on the scene at hand."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models.boundary_elements import BoundaryElements
from metafem.models.independent import Independent
from metafem.models.interacting import DENSE_LIMIT, Interacting
from metafem.models.model import ContactState, Curve, Model
from metafem.notes import Note, information
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface

# Neighbours whose fields are counted; on a lattice those farther away add a quarter.
NEIGHBOURS = 24

# Relative error of A0 at a given load per sum of (a/r)^3, order 1: the curvature 1/2 sum p lap G that it
# leaves out changes an area by its 2/3, with p = 4 a^3/3R. Resolved contacts on a 3 x 3 lattice
# err by that within 3 %.
ORDER_1 = 4.0 / (9.0 * math.pi)

# The same per sum of (a/r)^5, order 3: on a 3 x 3 lattice resolved contacts err by up to 0.20 of the mean
# sum (0.066 % at 0.0034, 0.01 % at 0.0006); a quarter more for safety.
ORDER_3 = 0.25

# Relative error of the area times the square of the cells a radius, as `BoundaryElements` states it, and
# the fewest that it should have.
CELL_ERROR = 0.37
FEWEST_CELLS = 10.0

# The asperity models in the notes.
NAMES = ("independent", "order 1", "order 3")


@dataclass(frozen=True)
class Automatic:
    """Choose among `Independent`, `Interacting` and `BoundaryElements` by estimates of their errors.

    The contacts of the independent model tell the sizes: its own error by the spread of the
    displacements that it neglects, over the mean indentation; that of order 1 by the curvature of the
    neighbours' fields, (a/r)^3; that of order 3 by (a/r)^5. The first that stays within the tolerance
    is solved; where none does, `BoundaryElements` with cells fine enough for it. Above 2000 asperities
    order 3 stays the last, and the notes say when it does not suffice.

    Parameters
    ----------
    tolerance : float
        Relative error of A0(P) against resolved contacts on the same substrate, positive. It is what
        the choice aims at; the equations themselves are solved to the chosen model's own tolerance.
    substrate : Substrate

    Raises
    ------
    InvalidInput
        For a tolerance that is not positive, or a substrate that cannot be used.

    Examples
    --------
    >>> from metafem import Material, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> equilibrium(surface, Automatic(1e-2), load=1e-3).model
    Interacting(order=1, substrate=HalfSpace(), contact=Hertz(), pedestal=False)
    """

    tolerance: float = 1e-3
    substrate: Substrate = field(default_factory=HalfSpace)

    def __post_init__(self) -> None:
        value = check.number("tolerance", self.tolerance, above=0.0)
        object.__setattr__(self, "tolerance", value)
        Interacting(substrate=self.substrate)  # refuses what is no substrate

    @property
    def couples(self) -> bool:
        """Whether contacts change one another's load: yes."""
        return True

    @property
    def gradient_model(self) -> Interacting:
        """`Interacting` on the same substrate."""
        return Interacting(substrate=self.substrate)

    def solve(self, surface: Surface, approach: float) -> ContactState:
        """Equilibrium at a given approach [mm] by the model that is chosen for it.

        At a given approach even a uniform sinking changes the load: the choice is made by A0(P) at the
        load that interacting point loads carry there.
        """
        point = Interacting(order=1, substrate=self.substrate).curve_at(surface, np.array([approach]))
        model, notes = self._choice(surface, point.load)
        if isinstance(model, Independent):  # its load at this approach would be another
            model = Interacting(order=1, substrate=self.substrate)
        state = model.solve(surface, approach)
        return replace(state, notes=(*notes, *state.notes))

    def solve_load(self, surface: Surface, load: float) -> ContactState:
        """Equilibrium under a given rescaled load P/E* [mm^2] by the model that is chosen for it."""
        model, notes = self._choice(surface, np.array([load]))
        state = model.solve_load(surface, load)
        return replace(state, notes=(*notes, *state.notes))

    def curve(self, surface: Surface, load: FloatArray) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2], (k,); see `_parts`."""
        loads = np.asarray(load)
        parts = []
        for model, rows, notes in self._parts(surface, loads):
            parts.append(replace(_converged(model, model.curve(surface, loads[rows])), notes=notes))
        return Curve.joined(parts)

    def curve_at(self, surface: Surface, approach: FloatArray) -> Curve:
        """Equilibria at increasing approaches [mm], (k,); see `_parts`."""
        point = Interacting(order=1, substrate=self.substrate)
        values = np.asarray(approach)
        parts = []
        for model, rows, notes in self._parts(surface, point.curve_at(surface, values).load):
            chosen = point if isinstance(model, Independent) else model
            curve = _converged(chosen, chosen.curve_at(surface, values[rows]))
            parts.append(replace(curve, notes=notes))
        return Curve.joined(parts)

    def _parts(self, surface: Surface, load: FloatArray) -> list[tuple[Model, slice, tuple[Note, ...]]]:
        """Return a model for all loads, or one below the first load that needs resolved contacts."""
        model, notes = self._choice(surface, load)
        if not isinstance(model, BoundaryElements):
            return [(model, slice(0, len(load)), notes)]
        low, high = 0, len(load) - 1  # the last one needs them: errors grow with the load
        while low < high:
            middle = (low + high) // 2
            held = load[middle] <= 0.0 or self._estimates(surface, float(load[middle]))[2] <= self.tolerance
            low, high = (middle + 1, high) if held else (low, middle)
        parts: list[tuple[Model, slice, tuple[Note, ...]]] = []
        for rows in (slice(0, low), slice(low, len(load))):
            if rows.stop > rows.start:
                model, (note, *rest) = self._choice(surface, load[rows])
                end = surface.material.composite_modulus * load[rows][-1]
                parts.append((model, rows, (information(f"up to {end:.4g} N: {note}"), *rest)))
        return parts

    def _choice(self, surface: Surface, load: FloatArray) -> tuple[Model, tuple[Note, ...]]:
        """Return the model, and what is to be said of it."""
        model, name, why = self._chosen(surface, load)
        notes = [information(f"chosen: {name}; {why}")]
        if surface.block is not None and isinstance(self.substrate, HalfSpace):
            notes.append(
                information(
                    "the surface's block is left aside: the contacts are coupled through a half-space"
                )
            )
        return model, tuple(notes)

    def _chosen(self, surface: Surface, load: FloatArray) -> tuple[Model, str, str]:
        """Return the model, its name, and the estimates that chose it."""
        loads = load[load > 0.0]
        if loads.size == 0 or surface.count == 1:
            return Independent(), NAMES[0], "no neighbours in contact, so without estimates"
        probed = np.unique(loads[[0, loads.size // 2, -1]])
        alone, first, third = np.max([self._estimates(surface, float(p)) for p in probed], axis=0)
        candidates: tuple[tuple[Model, float], ...] = (
            (Independent(), alone + first),
            (Interacting(order=1, substrate=self.substrate), first),
            (Interacting(order=3, substrate=self.substrate), third),
        )
        said = "estimated errors of A0(P): " + ", ".join(
            f"{name} {error:.1e}" for name, (_, error) in zip(NAMES, candidates, strict=True)
        )
        for name, (model, error) in zip(NAMES, candidates, strict=True):
            if error <= self.tolerance:
                return model, name, said
        said = f"{said}; all exceed {self.tolerance:g}"
        bound = self.substrate.for_surface(surface)
        if surface.count > DENSE_LIMIT or not isinstance(bound, Radial):
            return candidates[-1][0], NAMES[-1], f"{said}: resolved contacts are needed"
        largest = float(
            np.sqrt(Independent().solve_load(surface, float(probed[0])).asperity_area.max() / math.pi)
        )
        cells = max(FEWEST_CELLS, math.sqrt(CELL_ERROR / self.tolerance))
        model = BoundaryElements(largest / cells, bound)
        return model, "resolved contacts", f"{said}: resolved by {cells:.0f} cells a radius"

    def _estimates(self, surface: Surface, load: float) -> tuple[float, float, float]:
        """Return what is neglected by independence, by order 1 and by order 3, relative to A0."""
        from scipy.spatial import cKDTree

        solved = Independent().solve_load(surface, load)
        closed = np.flatnonzero(solved.asperity_load > 0.0)
        if closed.size == 0:
            return 0.0, 0.0, 0.0
        rescaled = solved.asperity_load / surface.material.composite_modulus
        area = solved.asperity_area[closed]
        radius = np.sqrt(area / math.pi)
        spread = self._displacement(surface, rescaled)[closed]
        # a uniform sinking leaves A0(P) as it is; contacts answer in proportion to their radii
        spread = spread - (radius @ spread) / radius.sum()
        indentation = area / (math.pi * surface.radius[closed])
        alone = math.sqrt(float(np.mean(spread**2))) / float(indentation.mean())
        if closed.size == 1:
            return alone, 0.0, 0.0
        near = min(NEIGHBOURS + 1, closed.size)
        tree = cKDTree(surface.position[closed])
        distance, other = tree.query(surface.position[closed], k=near)
        ratio = radius[other[:, 1:]] / distance[:, 1:]
        share = area / area.sum()
        # the curvature a source lends is p/r^3 = 4 a^3/(3 R r^3), felt in proportion to the own radius
        relative = surface.radius[closed, None] / surface.radius[closed][other[:, 1:]]
        first = ORDER_1 * float(share @ (ratio**3 * relative).sum(axis=1))
        third = ORDER_3 * float(share @ (ratio**5 * relative).sum(axis=1))
        return alone, first, third

    def _displacement(self, surface: Surface, load: FloatArray) -> FloatArray:
        """Return the displacement of every asperity by point loads, its own regular part included."""
        from metafem.models.large import fast_sums

        bound = self.substrate.for_surface(surface)
        if surface.count > DENSE_LIMIT and isinstance(bound, Radial):
            product = fast_sums(surface, bound, 1).displacement(load)
            return np.asarray(product + bound.self_influence * load)
        return np.asarray(bound.influence_matrix(surface) @ load)


def _converged(model: Model, curve: Curve) -> Curve:
    """Return the curve if it holds its model's own tolerance; `Automatic.tolerance` means another error."""
    worst = float(curve.residual.max())
    if worst > max(model.tolerance, curve.tolerance):
        raise NotConverged(f"not converged: largest residual {worst:.2g}", curve)
    return curve
