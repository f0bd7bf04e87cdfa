"""Resolved contacts: the pressure on cells of a grid, without any law for a single contact."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from metafem import _validate as check
from metafem._calls import checked_class
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.models.boundary_elements import far_field
from metafem.models.boundary_elements.field import ContactField
from metafem.models.boundary_elements.solve import COARSEST, TOLERANCE, Scene, Solution
from metafem.models.boundary_elements.start import Start
from metafem.models.interacting.model import Interacting
from metafem.models.model import ContactState, Curve, Status
from metafem.notes import Note, information
from metafem.progress import each
from metafem.substrate import HalfSpace, Radial
from metafem.surface import Surface

# The patches of a surface without contact.
NONE = np.zeros((0, 2))


@checked_class
@dataclass(frozen=True)
class BoundaryElements:
    """Elastic contact of paraboloids with a rigid plane, resolved by cells of constant pressure.

    Finds the pressures with ``p >= 0, u + gap - approach >= 0, p (u + gap - approach) = 0``, where u
    is Love's displacement of all cells plus what the substrate adds to a half-space. Cells cover the
    neighbourhoods of the contacts only. With n cells per contact radius the relative error of a Hertz
    contact at any position is at most 0.12/n^2 in load and 0.37/n^2 in area: 5e-5 and 1.5e-4 at n = 50.
    Areas come from the second moments of each contact's pressure, ``A = 5 pi sqrt(<x^2><y^2> - <xy>^2)``,
    which is exact for Hertzian ellipses. Where the fourth moments show a different shape, and where contacts
    have merged, cells are counted and a note says so. The stiffness is that of flat punches on the cells in
    contact. Johnson, Contact Mechanics (1985), section 5.9, doi:10.1017/CBO9781139171731.

    Parameters
    ----------
    cell : float
        Side of the cells [mm], positive. InvalidInput is raised at a load where the largest contact has
        fewer than four cells per radius. If only smaller contacts have fewer, a note states their share of
        the load.
    substrate : HalfSpace or BondedLayer
        A substrate whose influence depends on the distance alone.

    Raises
    ------
    InvalidInput
        For a cell that is not positive, and another kind of substrate. When solving: for a cell too
        coarse for the largest contact, and a scene that needs more memory than the machine has.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (1, 2), pitch=1.0, radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, BoundaryElements(cell=0.01), load=0.1)
    >>> round(state.area, 3), state.residual < 1e-9
    (0.373, True)
    """

    cell: float
    substrate: Radial = field(default_factory=HalfSpace)

    def __post_init__(self) -> None:
        object.__setattr__(self, "cell", check.number("cell", self.cell, above=0.0))
        if not isinstance(self.substrate, Radial):
            raise InvalidInput(
                f"substrate = {self.substrate!r} must be one whose influence depends on the distance "
                "alone: metafem.HalfSpace() or metafem.BondedLayer()"
            )

    @property
    def tolerance(self) -> float:
        """Largest residual of a converged state: gap or overlap over the largest indentation."""
        return TOLERANCE

    @property
    def name(self) -> str:
        """Name of the model in texts; it includes a substrate other than the half-space."""
        return "resolved" if self.substrate == HalfSpace() else f"resolved, {self.substrate.name}"

    @property
    def couples(self) -> bool:
        """Whether the load of a contact depends on the others at given indentations: yes."""
        return True

    @property
    def gradient_model(self) -> Interacting:
        """`Interacting` on the same substrate."""
        return Interacting(substrate=self.substrate)

    @property
    def reference(self) -> Interacting:
        """`Interacting` on the same substrate; differences from it are not counted as errors."""
        return self.gradient_model

    def solve(self, surface: Surface, approach: float) -> ContactState:
        """Equilibrium at a given approach [mm]."""
        return self._at(Scene(surface, self.cell, self.substrate), approach, None)[0]

    def solve_load(self, surface: Surface, load: float) -> ContactState:
        """Equilibrium at a given rescaled load P/E* [mm^2]."""
        return self._under(Scene(surface, self.cell, self.substrate), load, None)[0]

    def curve(self, surface: Surface, load: FloatArray) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2], (k,); see `_joined`."""
        scene = Scene(surface, self.cell, self.substrate)
        light = _unresolved(load, lambda value: scene.resolves(scene.start(load=value)))
        states = self._along(scene, load[light:], self._under)
        return self._joined(surface, load[:light], self.gradient_model.curve, states)

    def curve_at(self, surface: Surface, approach: FloatArray) -> Curve:
        """Equilibria at increasing approaches [mm], (k,); see `_joined`."""
        scene = Scene(surface, self.cell, self.substrate)
        light = _unresolved(approach, lambda value: scene.resolves(scene.start(approach=value)))
        states = self._along(scene, approach[light:], self._at)
        return self._joined(surface, approach[:light], self.gradient_model.curve_at, states)

    def _along(
        self,
        scene: Scene,
        values: FloatArray,
        solve: Callable[[Scene, float, Start | None], tuple[ContactState, Start | None]],
    ) -> list[ContactState]:
        """Solve at increasing loads or approaches, each from the start of the one before."""
        states, last = [], None
        for value in each("resolved contacts: load", values.tolist()):
            state, last = solve(scene, value, last)
            states.append(replace(state, _field=None))  # a curve keeps no pressures
        return states

    def _joined(
        self,
        surface: Surface,
        light: FloatArray,
        predict: Callable[[Surface, FloatArray], Curve],
        states: list[ContactState],
    ) -> Curve:
        """Return the curve, by order 3 at light loads where the cells are too coarse for the contacts.

        There the contacts are far smaller than their distances, and order 3 is more accurate.
        """
        resolved = _curve(surface, states)
        if not light.size:
            return resolved
        first = predict(surface, light)
        end = surface.material.composite_modulus * first.load[-1]
        note = information(
            f"up to {end:.4g} N the law is that of the model {self.gradient_model.name}: the largest contact "
            f"has fewer than {COARSEST:g} cells of {self.cell:g} mm per radius"
        )
        return Curve.joined([replace(first, notes=(*first.notes, note)), resolved])

    def _at(self, scene: Scene, approach: float, guess: Start | None) -> tuple[ContactState, Start | None]:
        if approach <= 0.0:
            return self._open(scene.surface, approach), None
        first = scene.start(approach=approach, guess=guess)
        return self._state(scene, scene.solve(first)), first

    def _under(self, scene: Scene, load: float, guess: Start | None) -> tuple[ContactState, Start | None]:
        if load == 0.0:
            return self._open(scene.surface, 0.0), None
        first = scene.start(load=load, guess=guess)
        state = self._state(scene, scene.solve(first, load))
        error = abs(state.load / scene.surface.material.composite_modulus - load) / load
        return replace(state, residual=max(state.residual, error)), first

    def _open(self, surface: Surface, approach: float) -> ContactState:
        """Return the state without contact."""
        separation = float(surface.height.max()) - approach
        return ContactState(
            load=0.0,
            area=0.0,
            separation=separation,
            approach=approach,
            stiffness=0.0,
            asperity_load=np.zeros(surface.count),
            asperity_area=np.zeros(surface.count),
            residual=0.0,
            status=Status.CONVERGED,
            model=self,
            base_gap=separation,
            _field=ContactField(self.cell, NONE, NONE.astype(np.int64), *(NONE[:, 0] for _ in range(3))),
        )

    def _state(self, scene: Scene, solution: Solution) -> ContactState:
        surface, h = scene.surface, self.cell
        modulus = surface.material.composite_modulus
        area = h**2 * solution.contacts.area
        load = h**2 * solution.contacts.load
        approach = h * solution.minimum.multiplier
        residual = solution.minimum.error / solution.indentation
        separation = float(surface.height.max()) - approach
        converged = solution.covered and residual <= TOLERANCE
        return ContactState(
            load=modulus * math.fsum(load),
            area=math.fsum(area),
            separation=separation,
            approach=approach,
            stiffness=modulus * h * solution.stiffness,
            asperity_load=modulus * load,
            asperity_area=area,
            residual=residual,
            status=Status.CONVERGED if converged else Status.NOT_CONVERGED,
            model=self,
            base_gap=separation + float((scene.coupling @ load).min()),
            notes=_notes(scene, solution),
            _field=_field(scene, solution),
        )


def _unresolved(values: FloatArray, resolves: Callable[[float], bool]) -> int:
    """Return how many of increasing loads or approaches are too light to be resolved; 0 where all are."""
    light = next((k for k, value in enumerate(values.tolist()) if value > 0.0 and resolves(value)), 0)
    return light if (values[:light] > 0.0).any() else 0


def _field(scene: Scene, solution: Solution) -> ContactField:
    h, found = scene.cell, solution.minimum
    undeformed = np.concatenate([p.gap.ravel() for p in solution.patches]) - found.multiplier
    low, high = scene.surface.position.min(axis=0), scene.surface.position.max(axis=0)
    return ContactField(
        cell=h,
        corner=low + 0.5 * (high - low) + h * np.array([p.corner for p in solution.patches]),
        shape=np.array([p.shape for p in solution.patches]),
        pressure=scene.surface.material.composite_modulus * found.pressure,
        gap=h * found.gradient,
        undeformed_gap=h * undeformed,
    )


def _curve(surface: Surface, states: list[ContactState]) -> Curve:
    modulus = surface.material.composite_modulus
    approach, load, area, stiffness, residual = (
        np.array([getattr(s, name) for s in states])
        for name in ("approach", "load", "area", "stiffness", "residual")
    )
    return Curve(approach, load / modulus, area, stiffness / modulus, residual)


def _notes(scene: Scene, solution: Solution) -> tuple[Note, ...]:
    """State the region that the cells cover, and where areas or cells are less accurate."""
    patches, contacts = solution.patches, solution.contacts
    cells = sum(p.gap.size for p in patches)
    corner = np.array([p.corner for p in patches])
    extent = (corner + [p.shape for p in patches]).max(axis=0) - corner.min(axis=0)
    notes = [
        information(f"{cells} cells cover the contacts; a grid over all of them would have {extent.prod()}"),
    ]
    if len(patches) > 1:
        notes.append(
            information(
                f"displacements between {len(patches)} patches by expansions within {far_field.TOLERANCE:g}"
            )
        )
    if contacts.counted.any():
        notes.append(
            information(
                f"the pressure of {contacts.counted.sum()} contacts is not that of a Hertzian ellipse: their "
                "areas are sums of cells, with a relative error of about a tenth of cell over contact radius"
            )
        )
    if len(contacts.merged):
        shown = ", ".join(f"{i} and {j}" for i, j in contacts.merged[:5].tolist())
        notes.append(
            information(
                f"{len(contacts.merged)} pairs of contacts have merged, among them {shown}: their loads and "
                "areas are split where the summits' paraboloids cross"
            )
        )
    radius = np.sqrt(contacts.area / math.pi)
    coarse = (contacts.load > 0.0) & (radius < COARSEST)
    if coarse.any():
        share = contacts.load[coarse].sum() / contacts.load.sum()
        notes.append(
            Note(
                f"{coarse.sum()} contacts have fewer than {COARSEST:g} cells per radius and carry "
                f"{share:.2g} of the load; the error of their areas is 2 % and more"
            )
        )
    return tuple(notes)
