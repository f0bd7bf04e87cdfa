"""Curves of surfaces with adhesive contacts: loading, and the way back from the largest load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import scipy

from metafem._given import shown
from metafem._validate import FloatArray
from metafem.contact import JKR, Contact
from metafem.errors import InvalidInput
from metafem.material import Material
from metafem.models.adhesion.follower import Follower, Goal, Jump
from metafem.models.adhesion.lone import Lone, Sums, Way
from metafem.models.adhesion.scene import Scene
from metafem.models.adhesion.solve import TOLERANCE, State
from metafem.models.curve import Curve, RescaledState, Sensitivity
from metafem.notes import Note, information
from metafem.surface import Surface


def adhesive_law(contact: Contact, material: Material | None = None) -> JKR | None:
    """Return the adhesive law of a material, or None for a law without adhesion."""
    law = contact if material is None else contact.for_material(material)
    if not law.adhesive:
        return None
    if not isinstance(law, JKR):
        raise InvalidInput(
            f"contact = {shown(law)}: the branches of adhesive laws other than metafem.JKR are unknown"
        )
    return law


def refuse_merging(law: JKR, surface: Surface) -> None:
    """Raise InvalidInput if neighbouring contacts would merge without load."""
    if surface.count == 1:
        return
    sizes, which = np.unique(surface.radius, return_inverse=True)
    reach = np.broadcast_to(law.zero_load_radius(sizes)[which], surface.count)
    tree = scipy.spatial.cKDTree(surface.position)
    pairs = tree.query_pairs(2.0 * float(reach.max()), output_type="ndarray")
    if not len(pairs):
        return
    first, second = pairs.T
    distance = np.hypot(*(surface.position[first] - surface.position[second]).T)
    room = distance - reach[first] - reach[second]
    if room.min() <= 0.0:
        i, j = np.sort(pairs[room.argmin()])
        raise InvalidInput(
            f"adhesion_energy = {law.adhesion_energy:g} N/mm: the contacts of asperities {i} and {j} would "
            f"merge without load, with radii of {reach[i]:.3g} and {reach[j]:.3g} mm at a distance of "
            f"{distance[room.argmin()]:.3g} mm; use a smaller energy, a larger modulus or a larger pitch"
        )


def jump_notes(jumps: list[Jump], modulus: float, unloading: bool) -> tuple[Note, ...]:
    """State number, loads and sizes of the jumps of a curve."""
    if not jumps:
        return ()
    newtons = modulus * np.array([jump.load for jump in jumps])
    change = np.array([jump.after - jump.before for jump in jumps])
    most = int(np.abs(change).argmax())
    span = f"at {newtons[0]:.4g} N"
    if len(jumps) > 1:
        span = f"from {newtons.min():.4g} to {newtons.max():.4g} N"
    what = "break on unloading" if unloading else "jump into contact on loading"
    count = "1 jump" if len(jumps) == 1 else f"{len(jumps)} jumps"
    return (
        information(
            f"{count} of A0, {span}, where asperities {what}; the largest changes A0 by "
            f"{change[most]:+.3g} mm^2, at {newtons[most]:.4g} N"
        ),
    )


def refuse_beyond(load: float, pull_off: float, modulus: float) -> None:
    """Raise InvalidInput for a load beyond pull-off; both are rescaled [mm^2]."""
    raise InvalidInput(
        f"load = {modulus * load:.6g} N is beyond pull-off: on unloading the last contacts break at "
        f"{modulus * pull_off:.6g} N; use loads from there on"
    )


def refuse_no_loading(values: FloatArray, by_load: bool, least: float) -> None:
    """Raise InvalidInput if the largest load, or approach, makes no contact from which to unload."""
    if values[-1] <= least:
        what = "load" if by_load else "approach"
        raise InvalidInput(
            f"the largest {what} is {values[-1]:g}; unloading begins at the largest {what}, which must be "
            f"greater than {least:g}"
        )


# Asperities that do not interact


@dataclass(frozen=True)
class LoneCurve:
    """Adhesive asperities (n,) without interaction at increasing rescaled loads or approaches (k,)."""

    lone: Lone
    way: Way
    approach: FloatArray  # of the base between the summits, without its sinking
    sums: Sums
    control: FloatArray

    @property
    def residual(self) -> FloatArray:
        """Error of the load or the approach over the sum of the contact radii times indentations."""
        found, lone = self.sums, self.lone
        carried = (found.contact_radius * lone.law.cap.indentation(found.contact_radius, lone.radius)).sum(
            axis=1
        )
        if self.way.by_load:
            error = found.load - self.control
            return np.asarray(np.abs(error) / np.where(carried > 0.0, carried, 1.0))
        error = self.approach + lone.compliance * found.load - self.control
        scale = np.abs(self.approach) + np.abs(lone.end).max()
        return np.asarray(np.abs(error) / scale)


def lone_curve(lone: Lone, values: FloatArray, by_load: bool, unloading: bool, modulus: float) -> LoneCurve:
    """Return the states of asperities without interaction at increasing loads or approaches (k,)."""
    way = lone.forward(values[-1:] if unloading else values, by_load)
    if unloading:
        refuse_no_loading(values, by_load, 0.0)
        (largest,), _ = way.approach(values[-1:])
        way = lone.back(float(largest), by_load)
        if by_load and values[0] < way.best[-1]:
            refuse_beyond(values[0], way.best[-1], modulus)
    reached = way.piece(values) < len(way.best) if by_load or unloading else values >= way.start[0]
    x, closed = np.array(values), np.zeros((len(values), len(lone.gap)), dtype=bool)
    x[reached], closed[reached] = way.approach(values[reached])
    return LoneCurve(lone, way, x, lone.sums(x, closed), values)


def independent_curve(
    model: object,
    law: JKR,
    surface: Surface,
    values: FloatArray,
    by_load: bool,
    unloading: bool,
    compliance: float = 0.0,
) -> Curve:
    """Return the curve of adhesive asperities without interaction, on a base that sinks by compliance P."""
    refuse_merging(law, surface)
    lone = Lone(law, np.broadcast_to(surface.radius, surface.gap.shape), surface.gap, compliance)
    modulus = surface.material.composite_modulus
    found = lone_curve(lone, values, by_load, unloading, modulus)
    notes: tuple[Note, ...] = ()
    if by_load:
        notes = jump_notes(found.way.jumps(values[0] if unloading else values[-1]), modulus, unloading)
    return _curve_of(model, found, surface.height, notes)


def curve_of_heights(
    model: object, law: JKR, height: FloatArray, radius: FloatArray, load: FloatArray
) -> Curve:
    """Return the curve at increasing loads (k,) for heights and radii (n,), without notes."""
    gap = height.max() - height
    lone = Lone(law, np.broadcast_to(radius, gap.shape), gap)
    return _curve_of(model, lone_curve(lone, load, True, False, 1.0), height)


def independent_areas(law: JKR, height: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
    """Return A0 [mm^2] at increasing loads (k,) of many lists of heights (m, n), (m, k)."""
    found = []
    for heights, radii in zip(height, np.broadcast_to(radius, height.shape), strict=True):
        lone = Lone(law, radii, heights.max() - heights)
        found.append(lone_curve(lone, load, True, False, 1.0).sums.area)
    return np.array(found)


def _curve_of(model: object, found: LoneCurve, height: FloatArray, notes: tuple[Note, ...] = ()) -> Curve:
    """Return the curve of a solution."""
    sinking, sums = found.lone.compliance, found.sums
    return Curve(
        found.approach + sinking * sums.load,
        sums.load,
        sums.area,
        sums.stiffness / (1.0 + sinking * sums.stiffness),
        found.residual,
        TOLERANCE,
        partial(_last_alone, model, found, height),
        notes,
    )


def _last_alone(model: object, found: LoneCurve, height: FloatArray) -> RescaledState:
    """Return the last state of asperities that do not interact."""
    lone, a, x = found.lone, found.sums.contact_radius[-1], float(found.approach[-1])
    load = np.where(a > 0.0, lone.law.load(np.where(a > 0.0, a, lone.entry_radius), lone.radius), 0.0)
    return RescaledState(load, lone.law.area(a), x - lone.gap, float(height.max()) - x, model)


def independent_sensitivity(
    model: object, law: JKR, height: FloatArray, radius: FloatArray, load: FloatArray
) -> Sensitivity:
    """Return the law at increasing loads (k,) and dA0/dh at fixed load [mm], (k, n), on loading.

    ``A'_i - P'_i sum_j A'_j / sum_j P'_j`` with the derivatives by the indentation.
    """
    gap = height.max() - height
    lone = Lone(law, np.broadcast_to(radius, gap.shape), gap)
    found = lone_curve(lone, load, True, False, 1.0)

    def gradient() -> FloatArray:
        a = found.sums.contact_radius
        alone, share = law.area_slope(a, lone.radius), law.stiffness(a, lone.radius)
        total = found.sums.stiffness[:, None]
        return np.asarray(
            alone - alone.sum(axis=1, keepdims=True) * share / np.where(total > 0.0, total, 1.0)
        )

    return Sensitivity(_curve_of(model, found, height), gradient, found.approach[:, None] - gap)


# Asperities that interact


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
        """Return the curve."""
        approach = self._each(lambda state: state.x)
        open_ones = np.array([state is None for state in self.states])
        approach[open_ones] = self.control[open_ones]
        return Curve(
            approach,
            self._each(lambda state: state.load),
            self._each(lambda state: state.area),
            self._each(lambda state: state.stiffness),
            self._each(lambda state: state.residual),
            TOLERANCE,
            compute_last,
            notes,
        )

    def last(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return loads [mm^2], areas [mm^2] and indentations [mm] (n,) of the last state."""
        load, area = np.zeros((2, len(self.scene.gap)))
        state = self.states[-1]
        if state is None:
            return load, area, self.control[-1] - self.scene.gap
        load[state.closed], area[state.closed] = state.p, np.pi * state.a**2
        return load, area, self.indentation(state)

    def indentation(self, state: State | None) -> FloatArray:
        """Return the indentations (n,) [mm] of a state; for an open asperity minus its gap."""
        found = np.zeros(len(self.scene.gap))
        if state is not None:
            found[state.closed], found[state.contacts.others] = state.found.indentation, state.overlap
        return found

    def gradients(self) -> FloatArray:
        """Return dA0/dh at fixed load [mm], (k, n), without the change of the pedestals."""
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
    record: bool = True,
) -> Followed:
    """Follow interacting asperities through increasing loads or approaches (k,), or back from the largest."""
    way = Follower(scene)
    if not unloading:
        return Followed(scene, [way.press(Goal(value, by_load)) for value in values], way.jumps, values)
    refuse_no_loading(values, by_load, 0.0)
    way.press(Goal(values[-1], by_load))
    way.turn()
    states = [way.withdraw(Goal(value, by_load)) for value in values[::-1]]
    if by_load and states[-1] is None:
        refuse_beyond(values[0], way.extreme, modulus)
    return Followed(scene, states[::-1], way.jumps, values)


def followed_near(scene: Scene, load: FloatArray) -> Followed:
    """Follow interacting asperities through increasing loads (k,), each from those that do not interact."""
    alone = lone_curve(Lone(scene.law, scene.radius, scene.gap), load, True, False, 1.0)
    way = Follower(scene, record=False)
    pairs = zip(load, alone.sums.contact_radius, strict=True)
    states = [way.press_near(Goal(value, by_load=True), guess) for value, guess in pairs]
    return Followed(scene, states, [], load)
