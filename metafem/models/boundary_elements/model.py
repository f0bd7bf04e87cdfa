"""Resolved contacts: pressures on the cells of a grid, without a law for single contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, ClassVar, cast

import numpy as np

from metafem import _validate as check
from metafem import drawing
from metafem._validate import FloatArray, IntArray
from metafem._values import Value, span
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput, shown
from metafem.models.boundary_elements.cells import Contacts, allowed
from metafem.models.boundary_elements.solve import COARSEST, TOLERANCE, Scene, Solution
from metafem.models.curve import Curve, ModelError, RescaledState, controlled
from metafem.models.error import order_3_error
from metafem.models.model import WithoutGradients
from metafem.notes import Level, Note, information
from metafem.progress import each
from metafem.substrate import HalfSpace, Radial
from metafem.surface import Surface

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class ContactField(Value):
    """Fields on the cells of `metafem.BoundaryElements`, arrays (k,) over all cells.

    The cells are squares of one common grid. They form m rectangular patches around the contacts; there are
    no cells between the patches. The arrays contain one patch after the other. Thus
    ``field.pressure[field.patch == 0].reshape(field.shape[0])`` is the pressure on the first patch, with x
    along the first axis and y along the second.

    Attributes
    ----------
    cell : float
        Side of the cells [mm].
    x, y : ndarray, (k,)
        Centres of the cells [mm].
    pressure : ndarray, (k,)
        Contact pressure [MPa], not negative; 0 outside the contacts. ``cell**2 * pressure.sum()`` is the load
        [N].
    gap : ndarray, (k,)
        Distance from the deformed surface to the plane [mm]. It is 0 in contact and not negative elsewhere,
        with errors up to 1e-9 of the largest indentation.
    displacement : ndarray, (k,)
        Displacement of the surface away from the plane, into the block [mm].
    patch : ndarray of int, (k,)
        Index of the patch of each cell, from 0.
    shape : ndarray of int, (m, 2)
        Number of cells of each patch along x and along y.
    corner : ndarray, (m, 2)
        Centre of the first cell of each patch [mm].
    undeformed_gap : ndarray, (k,)
        Distance from the undeformed surface to the plane [mm]; negative where they would overlap.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (1, 2), pitch=1.0, radius=0.526, material=mf.Material(1.36))
    >>> field = mf.equilibrium(surface, mf.BoundaryElements(cell=0.01), load=0.1).field
    >>> field
    <ContactField: 7200 cells of 0.01 mm in 2 patches, pressure 0 to 0.4022 MPa>
    >>> print(f"{field.cell**2 * field.pressure.sum():.6f} N")
    0.100000 N
    >>> bool((field.gap[field.pressure > 0.0] < 1e-10).all())
    True
    >>> first = field.pressure[field.patch == 0].reshape(field.shape[0])
    """

    cell: float
    corner: FloatArray
    shape: IntArray
    pressure: FloatArray
    gap: FloatArray
    undeformed_gap: FloatArray

    def __post_init__(self) -> None:
        for name in ("corner", "shape", "pressure", "gap", "undeformed_gap"):
            getattr(self, name).flags.writeable = False

    def __repr__(self) -> str:
        count = len(self.shape)
        patches = f"{count} patch{'es' * (count != 1)}"
        pressure = f", pressure {span(self.pressure, 'MPa')}" if self.pressure.size else ""
        return f"<ContactField: {len(self.pressure)} cells of {self.cell:g} mm in {patches}{pressure}>"

    @cached_property
    def patch(self) -> IntArray:
        """Index of the patch of each cell, (k,)."""
        return np.repeat(np.arange(len(self.shape)), self.shape.prod(axis=1))

    @cached_property
    def x(self) -> FloatArray:
        """Centres of the cells along x, (k,) [mm]."""
        return self._centres(0)

    @cached_property
    def y(self) -> FloatArray:
        """Centres of the cells along y, (k,) [mm]."""
        return self._centres(1)

    @cached_property
    def displacement(self) -> FloatArray:
        """Displacement of the surface away from the plane, (k,) [mm]."""
        return self.gap - self.undeformed_gap

    def _centres(self, axis: int) -> FloatArray:
        steps = [np.indices(shape)[axis].ravel() for shape in self.shape.tolist()]
        return np.asarray(self.corner[self.patch, axis] + self.cell * np.concatenate([np.zeros(0), *steps]))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the contact pressure as seen from above, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: the axes of a new ``matplotlib.pyplot`` figure.

        Returns
        -------
        matplotlib Axes

        Examples
        --------
        >>> import metafem as mf
        >>> surface = mf.Surface([[0, 0], [1, 0]], [0.1, 0.1], 0.526, mf.Material(1.36))
        >>> state = mf.equilibrium(surface, mf.BoundaryElements(cell=0.02), load=0.1)
        >>> state.field.plot().get_ylabel()
        'y [mm]'
        """
        ax = drawing.axes(ax, 5.0, 4.2)
        parts = np.split(self.pressure, np.cumsum(self.shape.prod(axis=1))[:-1]) if len(self.shape) else []
        grids = [part.reshape(shape) for part, shape in zip(parts, self.shape.tolist(), strict=True)]
        drawing.grids(ax, self.corner, self.cell, grids, "pressure [MPa]")
        drawing.plan(ax)
        return ax


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
    fourfold if the cell is halved: half a million cells in contact take seconds. The memory is at most 320
    bytes for each cell, and 128 n^2 for n asperities, which is 13 GB for 10,000. An error is raised if a
    scene needs more memory than the machine has.

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
        scene = Scene(surface, self.cell, self.substrate, self.contact)
        guesses = [scene.initial_guess(value, by_load) if value > 0.0 else None for value in values.tolist()]
        fine = [guess is not None and scene.largest(guess) >= COARSEST * self.cell for guess in guesses]
        light = fine.index(True) if True in fine else guesses.count(None)
        parts = [self._light(surface, values[:light], by_load)] if light else []
        for k in each("resolved contacts: load", list(range(light, len(values)))):
            parts.append(self._point(scene, cast("Curve", guesses[k]), float(values[k]), by_load))
        return Curve.joined(parts)

    def _light(self, surface: Surface, values: FloatArray, by_load: bool) -> Curve:
        """Return the part of a curve without contact, or at loads too light for the cells, by order 3."""
        model = self.gradient_model
        first = model.curve(surface, values) if by_load else model.curve(surface, approach=values)
        error = order_3_error(surface, first.last.area, self.substrate, self.contact)
        end = surface.material.composite_modulus * first.load[-1]
        note = information(
            f"up to {end:.4g} N the law is that of the model {model.name}: the largest contact "
            f"has fewer than {COARSEST:g} cells of {self.cell:g} mm per radius"
        )
        return first.with_notes((*first.notes, *([note] if end > 0.0 else ())), error)

    def _point(self, scene: Scene, guess: Curve, value: float, by_load: bool) -> Curve:
        """Return the equilibrium at one load [mm^2] or approach [mm] as a curve."""
        solution, h = scene.solve(guess, value if by_load else None), scene.cell
        load, area = (h**2 * math.fsum(part) for part in (solution.contacts.load, solution.contacts.area))
        residual = max(solution.residual, abs(load - value) / value if by_load else 0.0)
        approach = h * solution.minimum.multiplier
        row = np.array([approach, load, area, h * solution.stiffness, residual])[:, None]
        last, error = partial(self._last, scene, solution), _cell_error(solution, scene)
        return Curve(row[0], row[1], row[2], row[3], row[4], TOLERANCE, last, guess.notes, error)

    def _last(self, scene: Scene, solution: Solution) -> RescaledState:
        surface, h, found, patches = scene.surface, scene.cell, solution.minimum, solution.patches
        undeformed = np.concatenate([p.gap.ravel() for p in patches]) - found.multiplier
        low, high = surface.position.min(axis=0), surface.position.max(axis=0)
        return RescaledState(
            load=h**2 * solution.contacts.load,
            area=h**2 * solution.contacts.area,
            indentation=solution.of_points,
            base_gap=float((surface.height - solution.of_points).min()),
            model=self,
            notes=_notes(scene, solution.contacts),
            field=ContactField(
                cell=h,
                corner=low + 0.5 * (high - low) + h * np.array([p.corner for p in patches]),
                shape=np.array([p.gap.shape for p in patches]),
                pressure=found.pressure,
                gap=h * found.gap,
                undeformed_gap=h * undeformed,
            ),
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

    Its curve is also returned. The contacts are resolved by coarse cells and by half of them, at the first
    and at the last value. The stated errors tell the side of the cells. It is chosen again if more contacts
    are found deformed or merged by these cells. With more than 500,000 in contact, which take about ten
    seconds on two cores, the error remains above the tolerance, as the state says.
    """
    values, by_load = controlled(load, approach)
    ends = values[values > 0.0][[0, -1]]
    scene = Scene(surface, 1.0, substrate, contact)  # [mm], before the contacts are known
    # ten cells per radius of the largest contact, also the minimum number
    cell = scene.largest(scene.initial_guess(ends[0], by_load)) / 10.0
    coarse = BoundaryElements(cell, substrate, contact)
    halved = replace(coarse, cell=0.5 * coarse.cell)
    given = (ends, None) if by_load else (None, ends)
    curves = [model.curve(surface, given[0], approach=given[1]) for model in (coarse, halved)]
    before, found = (float(curve.error or 0.0) for curve in curves)
    # along grooves the error is proportional to the cell, elsewhere to its square
    rate = min(max(math.log2(before / found), 1.0), 2.0)
    # contacts may change their shape, which a tenth allows for
    cell = 0.9 * halved.cell * (tolerance / found) ** (1.0 / rate)
    least = math.sqrt(float(curves[1].area.max()) / 5e5)
    model = replace(coarse, cell=min(coarse.cell, max(cell, least)))
    curve = model.curve(surface, load, approach=approach)
    error = float(curve.error or 0.0)
    if error > tolerance and model.cell > least:
        model = replace(model, cell=max(0.9 * model.cell * (tolerance / error) ** (1.0 / rate), least))
        curve = model.curve(surface, load, approach=approach)
    return model, curve


def _cell_error(solution: Solution, scene: Scene) -> ModelError:
    """Return the assumed relative error of A0 for the numbers of cells in contact.

    In cells, the area of one contact has an error of up to 1 if its pressure has the shape of its law
    (measured to .8), 5 if it has another shape (up to 4 on layers from .1 to 1 mm), 8 if it has merged (up to
    5 in random scenes), and up to .1 for each pair of cells of `Contacts.grooves` parallel to the grid. Near
    the edges of other caps the pressure has other shapes.
    """
    contacts = solution.contacts
    other = 5.0 if scene.summits.paraboloids else allowed(contacts.area, False)
    cells = np.where(contacts.deformed, other, 1.0)
    if scene.summits.paraboloids:
        cells[contacts.merged.ravel()] = 8.0
    error = 0.1 * contacts.grooves + cells[contacts.area > 0.0].sum()
    return ModelError(float(error / contacts.area.sum()), "the number of cells in contact")


def _notes(scene: Scene, contacts: Contacts) -> tuple[Note, ...]:
    """Return notes on contacts that are deformed, merged or of few cells."""
    notes, radius = [], np.sqrt(contacts.area / math.pi)
    coarse = (contacts.load > 0.0) & (radius < COARSEST)
    if contacts.deformed.any():
        hertz, merged = scene.law == PARABOLOID, len(contacts.merged)
        law = "a Hertzian ellipse" if hertz else f"{scene.law!r} on a surface of constant curvature"
        text = (
            f"the pressure of {contacts.deformed.sum()} contacts is not that of {law}: their areas are those "
            "within their edges, with an error of a few cells each and up to 1 %"
        )
        if merged:
            text += f"; {merged} pairs have merged, and their areas are split where the summits' caps cross"
        notes.append(information(text))
    if coarse.any():
        share = contacts.load[coarse].sum() / contacts.load.sum()
        text = (
            f"{coarse.sum()} contacts have fewer than {COARSEST:g} cells per radius and carry "
            f"{share:.2g} of the load; the error of their areas is 1 % and more"
        )
        least = float(radius[coarse].min())
        notes.append(Note(text, Level.WARNING, "cells per radius", least, COARSEST, ("cell",)))
    return tuple(notes)
