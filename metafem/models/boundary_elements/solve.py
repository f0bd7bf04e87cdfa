"""Resolved solution of one surface: its cells and their pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact, Elastic, Hertz
from metafem.errors import MetafemError, refuse_if
from metafem.models._resources import require_memory
from metafem.models.boundary_elements.cells import Patch, Summits, boxes, measure
from metafem.models.boundary_elements.influence import Influence, convergence_rate, orders
from metafem.models.boundary_elements.quadratic_program import Program
from metafem.models.curve import Curve
from metafem.models.independent import Independent
from metafem.models.interacting.model import Interacting
from metafem.notes import information
from metafem.substrate import Radial
from metafem.surface import Surface

# Largest |gap| of a cell with pressure, or overlap of a cell without, relative to the largest indentation.
TOLERANCE = 1e-9

# Minimum number of cells per radius of the largest contact. With n cells per radius the error of a Hertz
# contact is up to 0.12/n^2 in load; with this number the area at given load is within 1 %.
COARSEST = 4.0

# Margin of cells around the expected contact, in cells and as a fraction of the contact radius. If contacts
# do not overlap, the error of the edge predicted by point loads is smaller.
MARGIN_CELLS, MARGIN_SHARE = 3.0, 0.03

# Maximum number of solutions on patches that grow where a contact reaches their edge.
MAX_GROWTHS = 10


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution at one load; lengths are in cells unless stated."""

    patches: list[Patch]
    pressure: FloatArray  # on the cells of all patches, not negative
    gap: FloatArray  # of these cells, recomputed
    approach: float
    stiffness: float  # derivative of the load by the approach, with fixed cells under pressure
    load: FloatArray  # of the asperities, (n,), with `area`, `deformed`, `merged`, `grooves`: see `measure`
    area: FloatArray
    deformed: NDArray[np.bool_]
    merged: IntArray
    grooves: int
    # error relative to the largest indentation of isolated contacts with these areas; infinite if a contact
    # reaches the edge of its patch, or an asperity without cells is in contact
    residual: float
    of_points: FloatArray  # indentation if all other loads act at points, (n,) [mm]


class Scene:
    """One surface on one substrate, with the data that are common to all loads."""

    def __init__(self, surface: Surface, cell: float, substrate: Radial, contact: Contact) -> None:
        refuse_if(
            surface.cell is not None,
            "contacts in a periodic cell cannot be resolved; use metafem.Interacting()",
        )
        self.surface, self.cell = surface, cell
        self.law = law = cast("Hertz | Elastic", contact.bound(surface))
        self.substrate = substrate.for_surface(surface)
        self.summits = Summits(surface, law, cell)
        # matrices over all pairs of asperities at once: the influence, its derivatives, the distances and the
        # convergence rates of the expansions
        require_memory(8 * 16 * surface.count**2, f"{surface.count} asperities")
        self.coupling, self.slope_x, self.slope_y, _ = self.substrate.influence_terms(surface)
        functions = (self.substrate.influence, self.substrate.regular)
        self.of_cells = [lambda r, f=f: np.asarray(cell * f(cell * r)) for f in functions]

    def initial_guess(self, value: float, by_load: bool) -> Curve:
        """Return the solution of order 1 at a load P/E* [mm^2] or an approach [mm].

        On very thin layers it does not exist, and independent asperities are used, with a note.
        """
        load, approach = (np.array([value]), None) if by_load else (None, np.array([value]))
        try:
            point = Interacting(order=1, substrate=self.substrate, contact=self.law)
            return point.curve(self.surface, load, approach=approach).checked().with_notes(())
        except MetafemError:
            alone = Independent(self.law).curve(self.surface, load, approach=approach).checked()
            text = "order 1 has no solution, so that the contacts are first those of independent asperities"
            return alone.with_notes((information(text),))

    def largest(self, guess: Curve) -> float:
        """Return the largest contact radius of an initial guess [mm]."""
        return float(self.law.contact_radius(guess.last.indentation, self.summits.of_law).max())

    def solve(self, guess: Curve, load: float | None = None) -> Solution:
        """Return the solution at a load, or at the initial guess's approach, with cells on all contacts."""
        largest = self.largest(guess)
        refuse_if(
            largest < COARSEST * self.cell,
            f"cell = {self.cell:g} mm is too coarse for the largest contact, whose radius is about "
            f"{largest:.3g} mm; {COARSEST:g} cells per radius need cell <= {largest / COARSEST:.3g} mm",
        )
        d = guess.last.indentation
        indentation, multiplier = float(d.max()) / self.cell, float(guess.approach[0]) / self.cell
        total = None if load is None else load / self.cell**2
        # summits whose gaps may close have cells too
        half_width = self._reach(d, guess.last.load, 1.0 + MARGIN_SHARE, 0.01 * d.max())
        for _ in range(MAX_GROWTHS):
            patches = self._patches(half_width)
            corner, gaps, owners = zip(*patches, strict=True)
            operator = Influence(np.array(corner), [part.shape for part in gaps], *self.of_cells)
            gap, owner = (np.concatenate([part.ravel() for part in parts]) for parts in (gaps, owners))
            pressure = self._expected(d, gap, owner)
            if total is not None:
                pressure *= total / pressure.sum()
            # half of the tolerance, as the final indentation may be smaller than the expected one
            program = Program(operator, gap, total, 0.5 * TOLERANCE * indentation)
            pressure, opening, multiplier, error = program.minimum(pressure, multiplier)
            parts = [part for group in operator.split(pressure) for part in group]
            carried, area, deformed, merged, grooves = measure(patches, parts, self.summits)
            radius = np.minimum(np.sqrt(area / math.pi), self.summits.widest())
            deepest = self.law.indentation(self.cell * radius, self.summits.of_law).max()
            indentation = float(deepest) / self.cell
            d = multiplier * self.cell - self.surface.gap - self.coupling @ (self.cell**2 * carried)
            larger = self._enlarged(half_width, patches, parts, d, self.cell**2 * carried)
            covered = bool((larger == half_width).all())
            if covered and error <= TOLERANCE * indentation:
                break
            half_width = larger
        self.require_extent(area)
        zero = np.zeros(gap.size)
        # the relative error of the stiffness is the square of that of the equations
        program = Program(operator, zero, None, 2e-3)
        rise, _, _ = program.on_face(pressure > 0.0, zero, zero - 1.0, 0.0, 0.0, 1000)
        residual = error / indentation if covered else math.inf
        return Solution(
            patches, pressure, opening, multiplier, float(rise.sum()),
            carried, area, deformed, merged, grooves, residual, d,
        )  # fmt: skip

    def _reach(self, d: FloatArray, load: FloatArray, factor: float, margin: float) -> FloatArray:
        """Return the extent of the cells around summits with indentations d, (n,) [cells]; 0 if not needed.

        The contact of a flat summit on the slope g of the field may begin beside its axis. Within the radius
        a of the largest contact its depth is less by up to g a. That of a paraboloid contains the axis.
        """
        if not self.summits.paraboloids:
            slope = np.hypot(self.slope_x @ load, self.slope_y @ load)
            most = self.law.largest_indentation(self.summits.of_law)
            widest = self.law.contact_radius(np.minimum(d, most), self.summits.of_law).max()
            d = np.minimum(d + slope * widest, most)
        radius = self.law.contact_radius(d, self.summits.of_law)
        return np.asarray(np.where(d + margin > 0.0, factor * (radius / self.cell) + MARGIN_CELLS, 0.0))

    def require_extent(self, area: FloatArray) -> None:
        """Raise InvalidInput if a contact with an area (n,) [cells] is wider than its profile."""
        radius, most = self.cell * np.sqrt(area / math.pi), self.cell * self.summits.widest()
        i = int((radius / most).argmax())
        refuse_if(
            radius[i] > most[i],
            f"the contact of asperity {i} has the radius {radius[i]:.4g} mm, beyond {most[i]:.4g} mm, up to "
            f"which {self.law!r} describes contacts; use lighter loads or a wider profile",
        )

    def _patches(self, half_width: FloatArray) -> list[Patch]:
        members, first, last = boxes(self.summits.position, half_width)
        cells = (last - first + 1).astype(np.float64).prod(axis=1)
        rate = convergence_rate(first, last)
        terms = orders(rate[np.triu_indices(len(cells), 1)]).astype(np.float64)
        # 16 arrays over all cells, and three complex ones with four times the cells for the transforms; the
        # expansions, and copies of a part while they are computed
        needed = 8 * (16 + 24) * cells.sum() + 8 * 2 * (terms**4).sum()
        require_memory(needed, f"cell = {self.cell:g} mm, with {cells.sum():.3g} cells,")
        return [self.summits.patch(*box) for box in zip(members, first, last, strict=True)]

    def _expected(self, d: FloatArray, gap: FloatArray, owner: IntArray) -> FloatArray:
        """Return Hertz's pressure for indentations d [mm]: 2/(pi R) sqrt(a^2 - rho^2) with a^2 = R d."""
        depth = gap - self.summits.depth[owner]
        height = np.maximum(d[owner] / self.cell - 2.0 * depth, 0.0)
        pressure = 2.0 / math.pi * np.sqrt(height / self.summits.radius[owner])
        # where no summit is the highest surface at its site, any initial guess works
        return np.asarray(pressure if pressure.any() else pressure + 1.0)

    def _enlarged(
        self,
        half_width: FloatArray,
        patches: list[Patch],
        pressure: list[FloatArray],
        d: FloatArray,
        load: FloatArray,
    ) -> FloatArray:
        """Return half widths (n,), increased where a contact reaches the edge or a summit lacks cells."""
        result = np.where(half_width == 0.0, self._reach(d, load, 1.0, 0.0), half_width)
        for (corner, _, owners), p in zip(patches, pressure, strict=True):
            rim = p > 0.0
            rim[1:-1, 1:-1] = False
            cells, owner = np.argwhere(rim) + corner, owners[rim]
            # if a summit lies within the cells of others, its contact belongs to their patch
            reach = np.maximum(half_width[owner], np.abs(cells - self.summits.position[owner]).max(axis=1))
            np.maximum.at(result, owner, 1.25 * reach + MARGIN_CELLS)
        return result
