"""Resolved solution of one surface: its cells and their pressure."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import MetafemError, refuse_if
from metafem.models._resources import require_memory
from metafem.models.boundary_elements.cells import BoolArray, Patch, Scene, allowed, boxes, measure
from metafem.models.boundary_elements.field import ContactField
from metafem.models.boundary_elements.influence import Influence, convergence_rate, orders
from metafem.models.boundary_elements.quadratic_program import Program
from metafem.models.curve import Curve, ModelError, RescaledState
from metafem.models.independent import Independent
from metafem.models.interacting.model import Interacting
from metafem.notes import Level, Note, information

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


def solve(scene: Scene, guess: Curve, value: float, by_load: bool, model: object) -> Curve:
    """Return an equilibrium at a load [mm^2], or at the approach [mm] of `guess`, as a curve.

    model: to which the state refers.
    """
    surface, h, largest = scene.surface, scene.cell, scene.largest(guess.last.indentation)
    refuse_if(
        largest < COARSEST * h,
        f"cell = {h:g} mm is too coarse for the largest contact, whose radius is about "
        f"{largest:.3g} mm; {COARSEST:g} cells per radius need cell <= {largest / COARSEST:.3g} mm",
    )
    d = guess.last.indentation
    indentation, approach = float(d.max()) / h, float(guess.approach[0]) / h
    total = value / h**2 if by_load else None
    # summits whose gaps may close have cells too
    half_width = _reach(scene, d, guess.last.load, 1.0 + MARGIN_SHARE, 0.01 * d.max())
    for _ in range(MAX_GROWTHS):
        patches = _patches(scene, half_width)
        corner, gaps, owners = zip(*patches, strict=True)
        operator = Influence(np.array(corner), [part.shape for part in gaps], *scene.of_cells)
        bare, owner = (np.concatenate([part.ravel() for part in parts]) for parts in (gaps, owners))
        pressure = _expected(scene, d, bare, owner)
        if total is not None:
            pressure *= total / pressure.sum()
        # half of the tolerance, as the final indentation may be smaller than the expected one
        program = Program(operator, bare, total, 0.5 * TOLERANCE * indentation)
        pressure, gap, approach, error = program.minimum(pressure, approach)
        parts = [part for group in operator.split(pressure) for part in group]
        load, area, deformed, apart, merged, grooves = measure(patches, parts, scene)
        radius = np.minimum(np.sqrt(area / math.pi), scene.widest())
        # of isolated contacts with these areas
        indentation = float(scene.law.indentation(h * radius, scene.of_law).max()) / h
        d = approach * h - surface.gap - scene.coupling @ (h**2 * load)  # if all other loads act at points
        larger = _enlarged(scene, half_width, patches, parts, d, h**2 * load)
        covered = bool((larger == half_width).all())
        if covered and error <= TOLERANCE * indentation:
            break
        half_width = larger
    require_extent(scene, area)
    zero = np.zeros(bare.size)
    # the relative error of the stiffness is the square of that of the equations
    program = Program(operator, zero, None, 2e-3)
    rise, _, _ = program.on_face(pressure > 0.0, zero, zero - 1.0, 0.0, 0.0, 1000)
    # not converged if a contact reaches the edge of its patch, or an asperity without cells is in contact
    residual = error / indentation if covered else math.inf
    carried, real = h**2 * math.fsum(load), h**2 * math.fsum(area)
    residual = max(residual, abs(carried - value) / value if by_load else 0.0)

    def last() -> RescaledState:
        low, high = surface.position.min(axis=0), surface.position.max(axis=0)
        return RescaledState(
            load=h**2 * load,
            area=h**2 * area,
            indentation=d,
            base_gap=float((surface.height - d).min()),
            model=model,
            notes=_notes(scene, load, area, deformed, merged),
            field=ContactField(
                cell=h,
                corner=low + 0.5 * (high - low) + h * np.array(corner),
                shape=np.array([part.shape for part in gaps]),
                pressure=pressure,
                gap=h * gap,
                undeformed_gap=h * (bare - approach),
            ),
        )

    row = np.array([h * approach, carried, real, h * float(rise.sum()), residual])[:, None]
    error_of_cells = _cell_error(scene, area, deformed, apart, merged, grooves)
    return Curve(row[0], row[1], row[2], row[3], row[4], TOLERANCE, last, guess.notes, error_of_cells)


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
        f"which {scene.law} describes contacts; use lighter loads or a wider profile",
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


def _cell_error(
    scene: Scene, area: FloatArray, deformed: BoolArray, apart: FloatArray, merged: IntArray, grooves: int
) -> ModelError:
    """Return the assumed relative error of A0 for the numbers of cells in contact.

    In cells, the area of one contact has an error of up to 1 plus twice `apart` if its pressure has the
    shape of its law (isolated contacts: measured to .8; nine contacts that nearly touch: to .94 of this
    bound), 5 if it has another shape (up to 4 on layers from .1 to 1 mm), 8 if it has merged (up to 5 in
    random scenes), and up to .1 for each pair of cells of `grooves` parallel to the grid. Near the edges
    of other caps the pressure has other shapes.
    """
    other = 5.0 if scene.paraboloids else allowed(area, False)
    cells = np.where(deformed, other, 1.0 + 2.0 * apart)
    if scene.paraboloids:
        cells[merged.ravel()] = 8.0
    error = 0.1 * grooves + cells[area > 0.0].sum()
    return ModelError(float(error / area.sum()), "the number of cells in contact")


def _notes(
    scene: Scene, load: FloatArray, area: FloatArray, deformed: BoolArray, merged: IntArray
) -> tuple[Note, ...]:
    """Return notes on contacts that are deformed, merged or of few cells."""
    notes, radius = [], np.sqrt(area / math.pi)
    coarse = (load > 0.0) & (radius < COARSEST)
    if deformed.any():
        shape = f"{scene.law} on a surface of constant curvature"
        shape = "a Hertzian ellipse" if scene.paraboloids else shape
        text = (
            f"the pressure of {deformed.sum()} contacts is not that of {shape}: their areas are those "
            "within their edges, with an error of a few cells each and up to 1 %"
        )
        if len(merged):
            text += f"; {len(merged)} pairs have merged, whose areas are split where the summits' caps cross"
        notes.append(information(text))
    if coarse.any():
        share = load[coarse].sum() / load.sum()
        text = (
            f"{coarse.sum()} contacts have fewer than {COARSEST:g} cells per radius and carry "
            f"{share:.2g} of the load; the error of their areas is 1 % and more"
        )
        least = float(radius[coarse].min())
        notes.append(Note(text, Level.WARNING, "cells per radius", least, COARSEST, ("cell",)))
    return tuple(notes)
