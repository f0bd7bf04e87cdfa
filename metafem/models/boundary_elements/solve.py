"""Resolved solution of one surface: its cells and their pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.errors import MetafemError, refuse_if
from metafem.models._resources import require_memory
from metafem.models.boundary_elements.cells import Patch, Scene, boxes, measure
from metafem.models.boundary_elements.influence import Influence, convergence_rate, orders
from metafem.models.boundary_elements.quadratic_program import Program
from metafem.models.curve import Curve
from metafem.models.independent import Independent
from metafem.models.interacting.model import Interacting
from metafem.notes import information

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


def initial_guess(scene: Scene, value: float, by_load: bool) -> Curve:
    """Return the solution of order 1 at a load P/E* [mm^2] or an approach [mm].

    On very thin layers it does not exist, and independent asperities are used, with a note.
    """
    load, approach = (np.array([value]), None) if by_load else (None, np.array([value]))
    try:
        point = Interacting(order=1, substrate=scene.substrate, contact=scene.law)
        return point.curve(scene.surface, load, approach=approach).checked().with_notes(())
    except MetafemError:
        alone = Independent(scene.law).curve(scene.surface, load, approach=approach).checked()
        text = "order 1 has no solution, so that the contacts are first those of independent asperities"
        return alone.with_notes((information(text),))


def solve(scene: Scene, guess: Curve, load: float | None = None) -> Solution:
    """Return the solution at a load, or at the initial guess's approach, with cells on all contacts."""
    largest = scene.largest(guess.last.indentation)
    refuse_if(
        largest < COARSEST * scene.cell,
        f"cell = {scene.cell:g} mm is too coarse for the largest contact, whose radius is about "
        f"{largest:.3g} mm; {COARSEST:g} cells per radius need cell <= {largest / COARSEST:.3g} mm",
    )
    d = guess.last.indentation
    indentation, multiplier = float(d.max()) / scene.cell, float(guess.approach[0]) / scene.cell
    total = None if load is None else load / scene.cell**2
    # summits whose gaps may close have cells too
    half_width = _reach(scene, d, guess.last.load, 1.0 + MARGIN_SHARE, 0.01 * d.max())
    for _ in range(MAX_GROWTHS):
        patches = _patches(scene, half_width)
        corner, gaps, owners = zip(*patches, strict=True)
        operator = Influence(np.array(corner), [part.shape for part in gaps], *scene.of_cells)
        gap, owner = (np.concatenate([part.ravel() for part in parts]) for parts in (gaps, owners))
        pressure = _expected(scene, d, gap, owner)
        if total is not None:
            pressure *= total / pressure.sum()
        # half of the tolerance, as the final indentation may be smaller than the expected one
        program = Program(operator, gap, total, 0.5 * TOLERANCE * indentation)
        pressure, opening, multiplier, error = program.minimum(pressure, multiplier)
        parts = [part for group in operator.split(pressure) for part in group]
        carried, area, deformed, merged, grooves = measure(patches, parts, scene)
        radius = np.minimum(np.sqrt(area / math.pi), scene.widest())
        deepest = scene.law.indentation(scene.cell * radius, scene.of_law).max()
        indentation = float(deepest) / scene.cell
        d = multiplier * scene.cell - scene.surface.gap - scene.coupling @ (scene.cell**2 * carried)
        larger = _enlarged(scene, half_width, patches, parts, d, scene.cell**2 * carried)
        covered = bool((larger == half_width).all())
        if covered and error <= TOLERANCE * indentation:
            break
        half_width = larger
    require_extent(scene, area)
    zero = np.zeros(gap.size)
    # the relative error of the stiffness is the square of that of the equations
    program = Program(operator, zero, None, 2e-3)
    rise, _, _ = program.on_face(pressure > 0.0, zero, zero - 1.0, 0.0, 0.0, 1000)
    residual = error / indentation if covered else math.inf
    return Solution(
        patches, pressure, opening, multiplier, float(rise.sum()),
        carried, area, deformed, merged, grooves, residual, d,
    )  # fmt: skip


def _reach(scene: Scene, d: FloatArray, load: FloatArray, factor: float, margin: float) -> FloatArray:
    """Return the extent of the cells around summits with indentations d, (n,) [cells]; 0 if not needed.

    The contact of a flat summit on the slope g of the field may begin beside its axis. Within the radius
    a of the largest contact its depth is less by up to g a. That of a paraboloid contains the axis.
    """
    if not scene.paraboloids:
        slope = np.hypot(scene.slope_x @ load, scene.slope_y @ load)
        most = scene.law.largest_indentation(scene.of_law)
        widest = scene.law.contact_radius(np.minimum(d, most), scene.of_law).max()
        d = np.minimum(d + slope * widest, most)
    radius = scene.law.contact_radius(d, scene.of_law)
    return np.asarray(np.where(d + margin > 0.0, factor * (radius / scene.cell) + MARGIN_CELLS, 0.0))


def require_extent(scene: Scene, area: FloatArray) -> None:
    """Raise InvalidInput if a contact with an area (n,) [cells] is wider than its profile."""
    radius, most = scene.cell * np.sqrt(area / math.pi), scene.cell * scene.widest()
    i = int((radius / most).argmax())
    refuse_if(
        radius[i] > most[i],
        f"the contact of asperity {i} has the radius {radius[i]:.4g} mm, beyond {most[i]:.4g} mm, up to "
        f"which {scene.law!r} describes contacts; use lighter loads or a wider profile",
    )


def _patches(scene: Scene, half_width: FloatArray) -> list[Patch]:
    members, first, last = boxes(scene.position, half_width)
    cells = (last - first + 1).astype(np.float64).prod(axis=1)
    rate = convergence_rate(first, last)
    terms = orders(rate[np.triu_indices(len(cells), 1)]).astype(np.float64)
    # 16 arrays over all cells, and three complex ones with four times the cells for the transforms; the
    # expansions, and copies of a part while they are computed
    needed = 8 * (16 + 24) * cells.sum() + 8 * 2 * (terms**4).sum()
    require_memory(needed, f"cell = {scene.cell:g} mm, with {cells.sum():.3g} cells,")
    return [scene.patch(*box) for box in zip(members, first, last, strict=True)]


def _expected(scene: Scene, d: FloatArray, gap: FloatArray, owner: IntArray) -> FloatArray:
    """Return Hertz's pressure for indentations d [mm]: 2/(pi R) sqrt(a^2 - rho^2) with a^2 = R d."""
    depth = gap - scene.depth[owner]
    height = np.maximum(d[owner] / scene.cell - 2.0 * depth, 0.0)
    pressure = 2.0 / math.pi * np.sqrt(height / scene.radius[owner])
    # where no summit is the highest surface at its site, any initial guess works
    return np.asarray(pressure if pressure.any() else pressure + 1.0)


def _enlarged(
    scene: Scene,
    half_width: FloatArray,
    patches: list[Patch],
    pressure: list[FloatArray],
    d: FloatArray,
    load: FloatArray,
) -> FloatArray:
    """Return half widths (n,), increased where a contact reaches the edge or a summit lacks cells."""
    result = np.where(half_width == 0.0, _reach(scene, d, load, 1.0, 0.0), half_width)
    for (corner, _, owners), p in zip(patches, pressure, strict=True):
        rim = p > 0.0
        rim[1:-1, 1:-1] = False
        cells, owner = np.argwhere(rim) + corner, owners[rim]
        # if a summit lies within the cells of others, its contact belongs to their patch
        reach = np.maximum(half_width[owner], np.abs(cells - scene.position[owner]).max(axis=1))
        np.maximum.at(result, owner, 1.25 * reach + MARGIN_CELLS)
    return result
