"""Adhesive asperities that interact: the curves of `Interacting` with adhesive laws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import JKR
from metafem.errors import InvalidInput, NotConverged
from metafem.models.adhesion.load_equation import equilibria
from metafem.models.adhesion.loading import Goal, Loading
from metafem.models.adhesion.notes import Jump, jump_notes, refuse_beyond, refuse_merging, refuse_no_loading
from metafem.models.adhesion.paths import Asperities
from metafem.models.adhesion.scene import Scene
from metafem.models.adhesion.solve import TOLERANCE, State
from metafem.models.adhesion.unloading import Unloading
from metafem.models.curve import Curve, RescaledState, Sensitivity
from metafem.models.interacting.coupled import Coupled, refuse_wide
from metafem.models.interacting.influence import coupling_between
from metafem.notes import Note

# Largest number of asperities. With this number one state takes a second, and every asperity may jump.
MOST = 1000


@dataclass(frozen=True)
class Followed:
    """States (k,) of interacting asperities at increasing loads or approaches; None without contact."""

    scene: Scene
    states: list[State | None]
    jumps: list[Jump]
    control: FloatArray

    def _each(self, value: Callable[[State], float], none: float = 0.0) -> FloatArray:
        return np.array([none if state is None else value(state) for state in self.states])

    def curve(self, compute_last: Callable[[], RescaledState], notes: tuple[Note, ...]) -> Curve:
        """Return the states as a curve."""
        approach = self._each(lambda state: state.x)
        open_ones = np.array([state is None for state in self.states])
        approach[open_ones] = self.control[open_ones]
        return Curve(
            approach,
            self._each(lambda state: state.load),
            self.areas(),
            self._each(lambda state: state.stiffness),
            self._each(lambda state: state.residual),
            TOLERANCE,
            compute_last,
            notes,
        )

    def areas(self) -> FloatArray:
        """Return A0 [mm^2], (k,)."""
        return self._each(lambda state: state.area)

    def last(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return loads [mm^2], areas [mm^2] and indentations [mm] (n,) of the last state."""
        load, area = np.zeros((2, len(self.scene.gap)))
        state = self.states[-1]
        if state is None:
            return load, area, self.control[-1] - self.scene.gap
        load[state.closed], area[state.closed] = state.p, np.pi * state.a**2
        return load, area, self.indentation(state)

    def indentation(self, state: State | None) -> FloatArray:
        """Return the indentations (n,) [mm] of a state; minus the gap of an open asperity."""
        found = np.zeros(len(self.scene.gap))
        if state is not None:
            found[state.closed], found[state.contacts.others] = state.found.indentation, state.overlap
        return found

    def loads(self) -> FloatArray:
        """Return the loads of the asperities in all states, (k, n) [mm^2]."""
        found = np.zeros((len(self.states), len(self.scene.gap)))
        for row, state in zip(found, self.states, strict=True):
            if state is not None:
                row[state.closed] = state.p
        return found

    def gradients(self) -> FloatArray:
        """Return dA0/dh at fixed load [mm], (k, n), without the change of the pedestal compliance."""
        found = np.zeros((len(self.states), len(self.scene.gap)))
        for row, state in zip(found, self.states, strict=True):
            if state is not None:
                row[state.closed] = state.area_gradient()
        return found


def follow(
    scene: Scene,
    values: FloatArray,
    by_load: bool,
    unloading: bool,
    modulus: float = 1.0,
) -> Followed:
    """Return states at increasing loads or approaches (k,), on loading or on unloading from the largest."""
    path = Loading(scene)
    if not unloading:
        return Followed(scene, [path.press(Goal(value, by_load)) for value in values], path.jumps, values)
    refuse_no_loading(values, by_load, 0.0)
    path.press(Goal(values[-1], by_load))
    back = Unloading(scene, state=path.state, extreme=np.inf)
    states = [back.withdraw(Goal(value, by_load)) for value in values[::-1]]
    if by_load and states[-1] is None:
        refuse_beyond(values[0], back.extreme, modulus)
    return Followed(scene, states[::-1], back.jumps, values)


def followed_near(scene: Scene, load: FloatArray) -> Followed:
    """Return states at increasing loads (k,), each guessed from independent asperities at the same load."""
    start = equilibria(Asperities(scene.law, scene.radius, scene.gap), load)
    path = Loading(scene, record=False)
    pairs = zip(load, start.sums.contact_radius, strict=True)
    states = [path.press_near(Goal(value, by_load=True), guess) for value, guess in pairs]
    return Followed(scene, states, [], load)


class AdhesiveCoupling(Coupled):
    """Interacting asperities with an adhesive law."""

    law: JKR

    def path(self, values: FloatArray, by_load: bool, unloading: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,), on loading or on unloading."""
        surface = self.surface
        refuse_merging(self.law, surface)
        modulus = surface.material.composite_modulus
        found = follow(self._scene(surface.height), values, by_load, unloading, modulus)
        refuse_wide(surface, max((float(state.a.max()) for state in found.states if state), default=0.0))
        notes = jump_notes(found.jumps, modulus, unloading) if by_load else ()
        last = partial(self._last, surface.height, found)
        return found.curve(last, notes)

    def solve(self, height: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) for heights (m, n) at increasing loads (k,)."""
        curves = [self.sensitivity(heights, load).curve for heights in height]
        names = ("approach", "load", "area", "stiffness")
        return tuple(np.array([getattr(curve, name) for curve in curves]) for name in names)

    def sensitivity(self, height: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the loading curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        found = followed_near(self._scene(height), load)
        indentation = np.array([found.indentation(state) for state in found.states])
        curve = found.curve(partial(self._last, height, found), ())
        return Sensitivity(
            curve, lambda: self.on_pedestals(found.gradients(), height, found.loads()), indentation
        )

    def areas(self, height: FloatArray, radius: FloatArray | None, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) for heights and radii (m, n); see `Model.areas`."""
        area = np.full((len(height), len(load)), np.nan)
        for row, heights in enumerate(height):
            scene = self._scene(heights, None if radius is None else radius[row])
            try:
                found = followed_near(scene, load)
            except NotConverged:
                continue
            area[row] = found.areas()
        return area

    def _scene(self, height: FloatArray, radius: FloatArray | None = None) -> Scene:
        """Return asperities with heights and radii (n,) [mm], and their influence on each other."""
        if self.surface.count > MOST:
            raise InvalidInput(
                f"{self.surface.count} adhesive asperities with interaction are too many: at most {MOST}; "
                "use Independent, or fewer asperities"
            )
        coupling, regular = coupling_between(self.surface, self.substrate, self.order)
        gap = height.max() - height
        self_term = regular + self.pedestals(height, self.surface.radius if radius is None else radius)
        summits = np.broadcast_to(self.law.summits(self.surface, radius), gap.shape)
        return Scene(self.law, summits, gap, coupling.influence, self_term)

    def _last(self, height: FloatArray, found: Followed) -> RescaledState:
        return self.state(height, *found.last())
