"""Resolved solution of one surface: its cells and their pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.contact import Elastic, Hertz
from metafem.errors import InvalidInput, MetafemError
from metafem.models._resources import require_memory
from metafem.models.boundary_elements import quadratic_program
from metafem.models.boundary_elements.contact_areas import Contacts, measure
from metafem.models.boundary_elements.far_field import table_bytes
from metafem.models.boundary_elements.influence import Influence
from metafem.models.boundary_elements.patches import Patch, box_rate, boxes, patch
from metafem.models.boundary_elements.summits import Summits
from metafem.models.curve import Curve
from metafem.models.independent import Independent
from metafem.models.interacting.model import Interacting
from metafem.substrate import Radial
from metafem.surface import Surface

# Largest |gap| of a cell with pressure, or overlap of a cell without, relative to the largest indentation.
TOLERANCE = 1e-9

# Minimum number of cells per radius of the largest contact. With n cells per radius the error is up to
# 0.1/n^2 in load and 0.3/n^2 in area (measured for one Hertz contact at six offsets, n = 4 to 12), so that
# this number gives 0.6 % and 2 %.
COARSEST = 4.0

# Margin of cells around the expected contact, in cells and as a fraction of the contact radius. If contacts
# do not overlap, the error of the edge predicted by point loads is smaller.
MARGIN_CELLS = 3.0
MARGIN_SHARE = 0.03

# Extent of the cells around a summit on a slope, divided by the distance from the summit at which its contact
# begins.
LIFTED = 1.5

# Summits with expected gaps up to this fraction of the largest indentation have cells too, as their gaps may
# close.
NEARLY_CLOSED = 0.01

# Growth factor of a patch when a contact reaches its edge, and maximum number of solutions on growing
# patches.
GROWTH = 1.25
MAX_GROWTHS = 10

# Maximum number of iterations. Conjugate gradients need 10 to 60, unless the tolerance is below rounding.
MAX_ITERATIONS = 1000

# Relative error of the equations for the stiffness; the relative error of the stiffness is its square.
STIFFNESS_TOLERANCE = 1e-3

# For the estimate of the memory: number of arrays that a solution holds, and bytes that a Fourier transform
# needs for each cell of the largest patch: three complex arrays with four times the cells, in two threads.
VECTORS = 16
TRANSFORM_BYTES = 4 * 16 * 3 * 2

# Number of matrices over all pairs of asperities in memory at once: the influence, its derivatives, the
# distances and the convergence rates of the expansions.
PAIR_MATRICES = 16


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution at one load; all lengths are in cells."""

    minimum: quadratic_program.Minimum
    contacts: Contacts
    patches: list[Patch]
    covered: bool  # no contact reaches the edge of its patch, and no asperity without cells is in contact
    # largest indentation of isolated contacts with these areas; residuals are relative to it
    indentation: float
    stiffness: float  # derivative of the load by the approach, with fixed cells under pressure


class Scene:
    """One surface on one substrate, with the data that are common to all loads."""

    def __init__(self, surface: Surface, cell: float, substrate: Radial, law: Hertz | Elastic) -> None:
        self.surface = surface
        self.law = law
        self.cell = cell
        self.substrate = substrate.for_surface(surface)
        self.summits = Summits.of(surface, law, cell)
        require_memory(8 * PAIR_MATRICES * surface.count**2, f"{surface.count} asperities")
        self.coupling = self.substrate.influence_matrix(surface)
        self.slope_x, self.slope_y, self.laplacian = self.substrate.influence_derivatives(surface)

    def initial_guess(self, value: float, by_load: bool) -> Curve:
        """Return the solution of order 1 at a load P/E* [mm^2] or an approach [mm].

        On very thin layers this solution does not exist, and independent asperities are used.
        """
        load, approach = (np.array([value]), None) if by_load else (None, np.array([value]))
        try:
            point = Interacting(order=1, substrate=self.substrate, contact=self.law)
            return point.curve(self.surface, load, approach=approach).checked()
        except MetafemError:
            return Independent(self.law).curve(self.surface, load, approach=approach)

    def largest(self, guess: Curve) -> float:
        """Return the largest contact radius of an initial guess [mm]."""
        return float(self.law.contact_radius(guess.last.indentation, self.summits.of_law).max())

    def resolves(self, guess: Curve) -> bool:
        """Return whether the cells are fine enough for the largest contact of an initial guess."""
        return self.largest(guess) >= COARSEST * self.cell

    def solve(self, guess: Curve, load: float | None = None) -> Solution:
        """Return the solution at a load, or at the initial guess's approach, with cells on all contacts."""
        if not self.resolves(guess):
            largest = self.largest(guess)
            raise InvalidInput(
                f"cell = {self.cell:g} mm is too coarse for the largest contact, whose radius is about "
                f"{largest:.3g} mm; {COARSEST:g} cells per radius need cell <= {largest / COARSEST:.3g} mm"
            )
        d = guess.last.indentation
        alone = self.law.load(self.law.contact_radius(d, self.summits.of_law), self.summits.of_law)
        gain, distance = self._lift(alone)
        reach = np.maximum(self._reach(d, 1.0 + MARGIN_SHARE), LIFTED * distance + MARGIN_CELLS)
        half_width = np.where(d + gain > -NEARLY_CLOSED * d.max(), reach, 0.0)
        patches = self._patches(half_width)
        pressure = self._expected(d, patches)
        if not pressure.any():
            pressure += 1.0  # no summit is the highest surface at its site: any initial guess works
        indentation = float(d.max()) / self.cell
        for _ in range(MAX_GROWTHS):
            operator = self.influence(patches)
            # half of the tolerance, as the final indentation may be smaller than the expected one
            tolerance = 0.5 * TOLERANCE * indentation
            minimum = self._minimum(operator, patches, pressure, float(guess.approach[0]), load, tolerance)
            parts = operator.split(minimum.pressure)
            contacts = measure(patches, parts, self.summits)
            blunt = self.summits.bluntness(np.sqrt(contacts.area / math.pi))
            indentation = float((contacts.area / (math.pi * self.summits.radius * blunt)).max())
            larger = self._enlarged(half_width, patches, parts, contacts, minimum)
            covered = bool((larger == half_width).all())
            if covered and minimum.error <= TOLERANCE * indentation:
                break
            half_width, old = larger, patches
            patches = self._patches(half_width)
            pressure = _moved(old, parts, patches)
        self.require_extent(contacts)
        rise = _rise(operator, minimum.pressure > 0.0)
        return Solution(minimum, contacts, patches, covered, indentation, rise)

    def _lift(self, load: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the increase [mm] of the indentations by the field's slopes, and where [cells], (n,)."""
        gain, distance = self.summits.lift(np.hypot(self.slope_x @ load, self.slope_y @ load))
        return self.cell * gain, distance

    def _reach(self, indentation: FloatArray, factor: float) -> FloatArray:
        """Return the extent of the cells around summits with these indentations, (n,) [cells]."""
        most = self.law.largest_indentation(self.summits.of_law)
        radius = self.law.contact_radius(np.minimum(indentation, most), self.summits.of_law)
        return np.asarray(factor * (radius / self.cell) + MARGIN_CELLS)

    def require_extent(self, contacts: Contacts) -> None:
        """Raise InvalidInput if a contact is wider than its profile."""
        radius = self.cell * np.sqrt(contacts.area / math.pi)
        most = self.cell * self.summits.widest()
        if (radius > most).any():
            i = int((radius / most).argmax())
            raise InvalidInput(
                f"the contact of asperity {i} has the radius {radius[i]:.4g} mm, beyond {most[i]:.4g} mm, up "
                f"to which {self.law!r} describes contacts; use lighter loads or a wider profile"
            )

    def _patches(self, half_width: FloatArray) -> list[Patch]:
        members, first, last = boxes(self.summits, half_width)
        cells = (last - first + 1).astype(np.float64).prod(axis=1)
        rate = box_rate(first, last)[np.triu_indices(len(cells), 1)]
        needed = 8 * VECTORS * cells.sum() + TRANSFORM_BYTES * cells.max() + table_bytes(rate)
        require_memory(needed, f"cell = {self.cell:g} mm, with {cells.sum():.3g} cells,")
        return [patch(self.summits, *box) for box in zip(members, first, last, strict=True)]

    def influence(self, patches: list[Patch]) -> Influence:
        """Return the influence of the cells of patches on each other."""
        h, below = self.cell, self.substrate
        return Influence(
            patches,
            lambda r: np.asarray(h * below.influence(h * r)),
            lambda r: np.asarray(h * below.regular(h * r)),
        )

    def _expected(self, indentation: FloatArray, patches: list[Patch]) -> FloatArray:
        """Return Hertz's pressure for the law's contact radii, corrected for the neighbours' field.

        Half of the Laplacian of the field is added to the curvature of the summit. The slope of the field
        shifts the contact down the slope by R times the slope; shifts above half of the contact radius are
        omitted.
        """
        h = self.cell
        of_law = self.summits.of_law
        contact_radius = self.law.contact_radius(indentation, of_law)
        load = self.law.load(contact_radius, of_law)
        blunt = h * self.summits.radius * self.summits.bluntness(contact_radius / h)
        bend = 0.5 * blunt * (self.laplacian @ load)
        radius = blunt / (1.0 + np.clip(bend, -0.5, 0.5)) / h
        square = radius * np.maximum(indentation, 0.0) / h
        shift = np.stack([self.slope_x @ load, self.slope_y @ load], axis=1) * blunt[:, None] / h
        near = (shift**2).sum(axis=1) < 0.25 * square
        centre = self.summits.position - np.where(near[:, None], shift, 0.0)
        parts = []
        for p in patches:
            x, y = (c + np.arange(n) for c, n in zip(p.corner, p.shape, strict=True))
            rho = (x[:, None] - centre[p.owner, 0]) ** 2 + (y[None, :] - centre[p.owner, 1]) ** 2
            height = np.maximum(square[p.owner] - rho, 0.0)
            parts.append((2.0 / math.pi * np.sqrt(height) / radius[p.owner]).ravel())
        return np.concatenate(parts)

    def _minimum(
        self,
        operator: Influence,
        patches: list[Patch],
        pressure: FloatArray,
        approach: float,
        load: float | None,
        tolerance: float,
    ) -> quadratic_program.Minimum:
        total = None if load is None else load / self.cell**2
        return quadratic_program.minimise(
            operator,
            np.concatenate([p.gap.ravel() for p in patches]),
            pressure if total is None else pressure * (total / pressure.sum()),
            multiplier=approach / self.cell,
            total=total,
            tolerance=tolerance,
            max_iterations=MAX_ITERATIONS,
        )

    def _enlarged(
        self,
        half_width: FloatArray,
        patches: list[Patch],
        pressure: list[FloatArray],
        contacts: Contacts,
        minimum: quadratic_program.Minimum,
    ) -> FloatArray:
        """Return half widths (n,), increased where a contact reaches the edge or a summit lacks cells."""
        result = half_width.copy()
        for region, p in zip(patches, pressure, strict=True):
            rim = p > 0.0
            rim[1:-1, 1:-1] = False
            cells, owner = np.argwhere(rim) + region.corner, region.owner[rim]
            reach = np.abs(cells - self.summits.position[owner]).max(axis=1)
            for i in np.unique(owner):
                # if a summit lies within the cells of others, its contact belongs to their patch
                result[i] = GROWTH * max(half_width[i], reach[owner == i].max()) + MARGIN_CELLS
        load = self.cell**2 * contacts.load
        d = minimum.multiplier * self.cell - self.surface.gap - self.coupling @ load
        gain, distance = self._lift(load)
        missed = (half_width <= distance) & (d + gain > 0.0)
        return np.where(missed, np.maximum(self._reach(d, 1.0), LIFTED * distance + MARGIN_CELLS), result)


def _rise(operator: Influence, face: NDArray[np.bool_]) -> float:
    """Return the sum of the pressures on cells that all move by 1."""
    ones = np.ones(operator.size)
    return float(quadratic_program.solve_on(operator, face, ones, STIFFNESS_TOLERANCE, MAX_ITERATIONS).sum())


def _moved(old: list[Patch], pressure: list[FloatArray], new: list[Patch]) -> FloatArray:
    """Return the pressure on new patches of the same grid; zero in new cells."""
    parts = []
    for region in new:
        part = np.zeros(region.shape)
        for source, p in zip(old, pressure, strict=True):
            low = np.maximum(source.corner, region.corner)
            high = np.minimum(source.corner + source.shape, region.corner + region.shape)
            if (low < high).all():
                (a, b), (c, d) = low - source.corner, high - source.corner
                (e, f), (g, h) = low - region.corner, high - region.corner
                part[e:g, f:h] = p[a:c, b:d]
        parts.append(part.ravel())
    return np.concatenate(parts)
