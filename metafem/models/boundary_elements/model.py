"""Resolved contacts: pressures on the cells of a grid, without a law for single contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import partial
from typing import ClassVar, cast

import numpy as np

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact, Elastic, Hertz
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput
from metafem.models.boundary_elements.cells import allowed
from metafem.models.boundary_elements.field import ContactField
from metafem.models.boundary_elements.solve import COARSEST, TOLERANCE, Scene, Solution
from metafem.models.curve import Curve, ModelError, RescaledState, controlled
from metafem.models.error import order_3_error
from metafem.models.model import WithoutGradients
from metafem.notes import Note, information
from metafem.progress import each
from metafem.substrate import HalfSpace, Radial
from metafem.surface import Surface

# Assumed errors in the area of one contact, in cells: if its pressure has the shape of its law, measured to
# 0.8; if it has another shape, up to 4 on layers from 0.1 to 1 mm; if it is merged, up to 5 in random scenes;
# and for each pair of cells of `Contacts.grooves`, up to 0.1 if the grooves are parallel to the grid.
LAWFUL_ERROR, CELL_ERROR, MERGING_ERROR, GROOVE_ERROR = 1.0, 5.0, 8.0, 0.1

# Number of cells per radius of the largest contact with which the error is judged; also the minimum number.
FEWEST_CELLS = 10.0

# Number of cells in contact that are solved within about ten seconds on two cores.
MOST_CELLS = 5e5


def resolvable(contact: object) -> bool:
    """Return whether a contact law is an elastic cap without adhesion, with a profile for the cells."""
    if isinstance(contact, type) or not isinstance(contact, Contact):
        return False
    return contact.largest_order == 3 and not contact.adhesive and hasattr(contact, "depth_at")


@dataclass(frozen=True)
class BoundaryElements(WithoutGradients):
    """Elastic contact of caps with a rigid plane, resolved by cells of constant pressure.

    The pressures satisfy ``p >= 0, u + gap - approach >= 0, p (u + gap - approach) = 0``. The displacement u
    is the sum of Love's solutions for all cells and the regular part of the substrate. Only the
    neighbourhoods of the contacts have cells. With n cells per contact radius the relative error of a Hertz
    contact at any position is at most 0.12/n^2 in load and 0.37/n^2 in area: 5e-5 and 1.5e-4 at n = 50. The
    stiffness is that of flat punches on the cells in contact. Johnson, Contact Mechanics (1985), section 5.9,
    doi:10.1017/CBO9781139171731.

    A surface with a periodic cell is refused. Inversions use the sensitivities of `gradient_model`.

    The contact areas are computed from the second moments of the pressure of each contact. For paraboloids
    ``A = 5 pi sqrt(<x^2><y^2> - <xy>^2)``, which is exact for Hertzian ellipses; for other caps the factor
    follows from their law with an extra curvature. If a contact has another shape or has merged, the area
    within its edge is used, with an error of a few cells per asperity and up to 1 % where contacts have
    merged, and a note states this.

    With fine cells the time for one load is about proportional to the number of cells, and thus increases
    fourfold if the cell is halved: half a million cells in contact take seconds. The memory is 128 bytes for
    each cell, 384 more for each cell of the largest neighbourhood (merged contacts have a common one), and
    128 n^2 for n asperities, which is 13 GB for 10,000. An error is raised if a scene needs more memory than
    the machine has.

    Parameters
    ----------
    cell : float
        Side of the cells [mm], positive. If the largest contact has fewer than four cells per radius at a
        load, order 3 is used at this load; InvalidInput is raised if this applies to all loads. If only
        smaller contacts have fewer cells, a note states their share of the load.
    substrate : HalfSpace or BondedLayer
        A substrate whose influence depends only on the distance. The influence of `metafem.fe.Block3D`
        depends on the position in the block; use `Interacting` with this substrate.
    contact : Contact
        Elastic cap without adhesion; its profile is used: `Hertz()` (default), `Elastic()` or another class
        with `depth_at`.

    Raises
    ------
    InvalidInput
        If the cell is not positive, or the substrate or contact is of another kind. When solving: if the
        surface has a periodic cell, the cells are too coarse for the largest contact, a contact is wider than
        its profile, or the scene needs more memory than the machine has.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (1, 2), pitch=1.0, radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, BoundaryElements(cell=0.01), load=0.1)
    >>> round(state.area, 3), state.residual < 1e-9
    (0.373, True)
    """

    title: ClassVar[str] = "resolved"

    cell: float
    substrate: Radial = field(default_factory=HalfSpace)
    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        check.member(self, "cell", above=0.0)
        if not isinstance(self.substrate, Radial):
            raise InvalidInput(
                f"substrate = {self.substrate!r} must be one whose influence depends on the distance "
                "alone: metafem.HalfSpace() or metafem.BondedLayer()"
            )
        if not resolvable(self.contact):
            raise InvalidInput(
                f"contact = {shown(self.contact)} must be an elastic cap without adhesion, such as "
                "metafem.Hertz() or metafem.Elastic(): contacts of other laws cannot be resolved"
            )

    def curve(
        self, surface: Surface, load: FloatArray | None = None, *, approach: FloatArray | None = None
    ) -> Curve:
        """Return equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        At light loads, for which the cells are too coarse, order 3 is used. It is more accurate there,
        because the contacts are far smaller than their distances.
        """
        values, by_load = controlled(load, approach)
        scene = scene_of(surface, self)
        guesses = [scene.initial_guess(value, by_load) if value > 0.0 else None for value in values.tolist()]
        fine = [guess is not None and scene.largest(guess) >= COARSEST * self.cell for guess in guesses]
        light = fine.index(True) if any(fine) else 0
        if not (values[:light] > 0.0).any():
            light = 0
        parts = [self._light(surface, values[:light], by_load)] if light else []
        for k in each("resolved contacts: load", list(range(light, len(values)))):
            parts.append(self._point(scene, guesses[k], float(values[k]), by_load))
        return Curve.joined(parts)

    def _light(self, surface: Surface, values: FloatArray, by_load: bool) -> Curve:
        """Return the part of a curve at loads too light for the cells, by `Interacting` of order 3."""
        model = self.gradient_model
        first = model.curve(surface, values) if by_load else model.curve(surface, approach=values)
        end = surface.material.composite_modulus * first.load[-1]
        note = information(
            f"up to {end:.4g} N the law is that of the model {model.name}: the largest contact "
            f"has fewer than {COARSEST:g} cells of {self.cell:g} mm per radius"
        )
        error = order_3_error(surface, first.last.area, self.substrate, self.contact)
        return first.with_notes((*first.notes, note), error)

    def _point(self, scene: Scene, guess: Curve | None, value: float, by_load: bool) -> Curve:
        """Return the equilibrium at one load [mm^2] or approach [mm] as a curve."""
        if guess is None:  # no load, or no contact
            row = (0.0 if by_load else value, 0.0, 0.0, 0.0, 0.0)
            last = partial(self._open, scene.surface, row[0])
            estimate = ModelError(0.0, "there is no contact")
        else:
            solution, h = scene.solve(guess, value if by_load else None), scene.cell
            load, area = (h**2 * math.fsum(part) for part in (solution.contacts.load, solution.contacts.area))
            residual = solution.minimum.error / solution.indentation if solution.covered else math.inf
            if by_load:
                residual = max(residual, abs(load - value) / value)
            row = (h * solution.minimum.multiplier, load, area, h * solution.stiffness, residual)
            last = partial(self._last, scene, solution)
            estimate = ModelError(_cell_error(solution, scene), "the number of cells in contact")
        pressed, carried, total, stiffness, error = np.array(row)[:, None]
        return Curve(
            pressed, carried, total, stiffness, error, TOLERANCE, last, guess.notes if guess else (), estimate
        )

    def _open(self, surface: Surface, approach: float) -> RescaledState:
        """Return the state without contact."""
        zero, gap = np.zeros(surface.count), approach - surface.gap
        field = ContactField(self.cell, np.zeros((0, 2)), np.zeros((0, 2), np.int64), *(zero[:0],) * 3)
        return RescaledState(zero, zero, gap, float((surface.height - gap).min()), self, field=field)

    def _last(self, scene: Scene, solution: Solution) -> RescaledState:
        surface, h = scene.surface, scene.cell
        load = h**2 * solution.contacts.load
        # indentation for point loads: the approach minus gap and displacement by all other point loads
        indentation = h * solution.minimum.multiplier - surface.gap - scene.coupling @ load
        return RescaledState(
            load=load,
            area=h**2 * solution.contacts.area,
            indentation=indentation,
            base_gap=float((surface.height - indentation).min()),
            model=self,
            notes=_notes(scene, solution),
            field=_field(scene, solution),
        )


def within(
    tolerance: float,
    surface: Surface,
    load: FloatArray | None = None,
    *,
    approach: FloatArray | None = None,
    substrate: Radial,
    contact: Contact = PARABOLOID,
) -> tuple[BoundaryElements, Curve]:
    """Return the model whose stated error of A0 at these loads or approaches is within a tolerance.

    Its curve is also returned. The contacts are resolved by coarse cells and by half of them, at the first and
    at the last value. The stated errors tell the side of the cells. It is chosen again if more contacts are
    found deformed or merged by these cells. With more than `MOST_CELLS` in contact the error remains above the
    tolerance, as the state says.
    """
    values, by_load = controlled(load, approach)
    ends = values[values > 0.0][[0, -1]]
    guessed = BoundaryElements(1.0, substrate, contact)  # [mm], before the contacts are known
    scene = scene_of(surface, guessed)
    coarse = replace(guessed, cell=scene.largest(scene.initial_guess(ends[0], by_load)) / FEWEST_CELLS)
    halved = replace(coarse, cell=0.5 * coarse.cell)
    given = (ends, None) if by_load else (None, ends)
    curves = [model.curve(surface, given[0], approach=given[1]) for model in (coarse, halved)]
    before, found = (float(curve.error or 0.0) for curve in curves)
    # along grooves the error is proportional to the cell, elsewhere to its square
    rate = min(max(math.log2(before / found), 1.0), 2.0)
    # contacts may change their shape, which a tenth allows for
    cell = 0.9 * halved.cell * (tolerance / found) ** (1.0 / rate)
    least = math.sqrt(float(curves[1].area.max()) / MOST_CELLS)
    model = replace(coarse, cell=min(coarse.cell, max(cell, least)))
    curve = model.curve(surface, load, approach=approach)
    error = float(curve.error or 0.0)
    if error > tolerance and model.cell > least:
        model = replace(model, cell=max(0.9 * model.cell * (tolerance / error) ** (1.0 / rate), least))
        curve = model.curve(surface, load, approach=approach)
    return model, curve


def scene_of(surface: Surface, model: BoundaryElements) -> Scene:
    """Return a surface with the law and the cells of a model."""
    if surface.cell is not None:
        raise InvalidInput("contacts in a periodic cell cannot be resolved; use metafem.Interacting()")
    law = cast("Hertz | Elastic", model.contact.bound(surface))
    return Scene(surface, model.cell, model.substrate, law)


def _cell_error(solution: Solution, scene: Scene) -> float:
    """Return the assumed relative error of A0 for the numbers of cells in contact."""
    contacts = solution.contacts
    cells = np.where(contacts.deformed, CELL_ERROR, LAWFUL_ERROR)
    cells[contacts.merged.ravel()] = MERGING_ERROR
    if not scene.summits.paraboloids:  # the pressure near their edges has other shapes
        other = allowed(contacts.area, False)
        cells = np.where(contacts.deformed, other, cells)
    grooves = GROOVE_ERROR * contacts.grooves
    return float((grooves + cells[contacts.area > 0.0].sum()) / contacts.area.sum())


def _field(scene: Scene, solution: Solution) -> ContactField:
    h, found = scene.cell, solution.minimum
    corner, shape = _places(solution)
    undeformed = np.concatenate([p.gap.ravel() for p in solution.patches]) - found.multiplier
    low, high = scene.surface.position.min(axis=0), scene.surface.position.max(axis=0)
    return ContactField(
        cell=h,
        corner=low + 0.5 * (high - low) + h * corner,
        shape=shape,
        pressure=found.pressure,
        gap=h * found.gap,
        undeformed_gap=h * undeformed,
    )


def _places(solution: Solution) -> tuple[IntArray, IntArray]:
    """Return the first cells and the numbers of rows and columns of the patches, (m, 2) each."""
    patches = solution.patches
    return np.array([p.corner for p in patches]), np.array([p.gap.shape for p in patches])


def _notes(scene: Scene, solution: Solution) -> tuple[Note, ...]:
    """Return notes on the number of cells, and on contacts that are deformed, merged or of few cells."""
    contacts, (corner, shape) = solution.contacts, _places(solution)
    extent = (corner + shape).max(axis=0) - corner.min(axis=0)
    notes = [
        information(
            f"{shape.prod(axis=1).sum()} cells in {len(shape)} patches cover the contacts; a grid over all "
            f"of them would have {extent.prod()}"
        )
    ]
    if contacts.deformed.any():
        hertz = scene.law == PARABOLOID
        law = "a Hertzian ellipse" if hertz else f"{scene.law!r} on a surface of constant curvature"
        notes.append(
            information(
                f"the pressure of {contacts.deformed.sum()} contacts is not that of {law}: their areas are "
                "those within their edges, with an error of a few cells each and up to 1 %"
            )
        )
    if len(contacts.merged):
        shown = ", ".join(f"{i} and {j}" for i, j in contacts.merged[:5].tolist())
        notes.append(
            information(
                f"{len(contacts.merged)} pairs of contacts have merged, among them {shown}: their loads and "
                "areas are split where the summits' caps cross"
            )
        )
    radius = np.sqrt(contacts.area / math.pi)
    coarse = (contacts.load > 0.0) & (radius < COARSEST)
    if coarse.any():
        share = contacts.load[coarse].sum() / contacts.load.sum()
        notes.append(
            Note(
                f"{coarse.sum()} contacts have fewer than {COARSEST:g} cells per radius and carry "
                f"{share:.2g} of the load; the error of their areas is 1 % and more",
                quantity="cells per radius",
                value=float(radius[coarse].min()),
                bound=COARSEST,
                remedies=("cell",),
            )
        )
    return tuple(notes)
