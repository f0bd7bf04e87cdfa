"""Curves of surfaces with adhesive contacts, alone and coupled, and notes on their jumps."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import numpy as np

from metafem._given import shown
from metafem._validate import FloatArray
from metafem.contact import JKR, Contact
from metafem.contact.jkr import of_sizes
from metafem.errors import InvalidInput, NotConverged, refuse_if
from metafem.models.adhesion.contacts import TOLERANCE, Scene, States
from metafem.models.adhesion.path import loaded, loading, unloading
from metafem.models.curve import Curve, RescaledState, Sensitivity
from metafem.models.interacting.coupled import Coupled, refuse_wide
from metafem.models.interacting.influence import close_pairs, coupling_between
from metafem.models.load_equation import LoadEquation
from metafem.notes import Note, information
from metafem.surface import Surface


class AdhesiveAsperities(LoadEquation):
    """Load equation for an adhesive law."""

    law: JKR

    def path(self, surface: Surface, values: FloatArray, by_load: bool, backwards: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,), on loading or on unloading."""
        scene = self._scene(surface.height, self.law.summits(surface))
        found, notes = _followed(surface, scene, values, by_load, backwards)
        return _curve(found, lambda: self._state(found, surface.height), notes)

    def curve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        """Return equilibria at increasing loads (k,) for heights and radii (n,)."""
        return self.sensitivity(height, radius, load).curve

    def solve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) of surfaces (m, n) at increasing loads (k,)."""
        rows = zip(height, np.broadcast_to(radius, height.shape), strict=True)
        return _arrays([self.curve(*row, load) for row in rows])

    def areas(self, surface: Surface, height: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) of surfaces (m, n) at loads (k,); see `Model.areas`."""
        _refuse_merging(self.law, surface)
        return self.solve(height, radius, load)[2]

    def sensitivity(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the loading curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        found = loaded(self._scene(height, radius), load)
        return Sensitivity(
            _curve(found, lambda: self._state(found, height)), found.gradient, found.indentation
        )

    def _scene(self, height: FloatArray, radius: FloatArray) -> Scene:
        return Scene(self.law, np.broadcast_to(radius, height.shape), height.max() - height)

    def _state(self, found: States, height: FloatArray) -> RescaledState:
        return RescaledState(*_last(found), float(height.max() - found.x[-1]), self.model)


class AdhesiveCoupling(Coupled):
    """Interacting asperities with an adhesive law."""

    law: JKR

    def path(self, values: FloatArray, by_load: bool, backwards: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,), on loading or on unloading."""
        height = self.surface.height
        found, notes = _followed(self.surface, self._scene(height), values, by_load, backwards)
        refuse_wide(self.surface, float(found.a.max()))
        return _curve(found, lambda: self.state(height, *_last(found)), notes)

    def solve(self, height: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) for heights (m, n) at increasing loads (k,)."""
        return _arrays([self.sensitivity(heights, load).curve for heights in height])

    def sensitivity(self, height: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the loading curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        found = loaded(self._scene(height), load)
        return Sensitivity(
            _curve(found, lambda: self.state(height, *_last(found))),
            lambda: self.on_pedestals(found.gradient(), height, found.fields.load),
            found.indentation,
        )

    def areas(self, height: FloatArray, radius: FloatArray | None, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) for heights and radii (m, n); see `Model.areas`."""
        area = np.full((len(height), len(load)), np.nan)
        for row, heights in enumerate(height):
            with contextlib.suppress(NotConverged):
                area[row] = loaded(self._scene(heights, None if radius is None else radius[row]), load).area
        return area

    def _scene(self, height: FloatArray, radius: FloatArray | None = None) -> Scene:
        """Return asperities with heights and radii (n,) [mm], and their influence on each other."""
        refuse_if(  # one state then takes a second, and every asperity may jump
            self.surface.count > 1000,
            f"{self.surface.count} adhesive asperities with interaction are too many: at most 1000; "
            "use Independent, or fewer asperities",
        )
        coupling, regular = coupling_between(self.surface, self.substrate, self.order)
        own = regular + self.pedestals(height, self.surface.radius if radius is None else radius)
        summits = np.broadcast_to(self.law.summits(self.surface, radius), height.shape)
        return Scene(self.law, summits, height.max() - height, coupling.influence.T + np.diag(own))


def adhesive_law(law: Contact) -> JKR | None:
    """Return the law if it is adhesive, otherwise None."""
    if not law.adhesive:
        return None
    if not isinstance(law, JKR):
        raise InvalidInput(
            f"contact = {shown(law)}: the branches of adhesive laws other than metafem.JKR are unknown"
        )
    return law


def _followed(
    surface: Surface, scene: Scene, values: FloatArray, by_load: bool, backwards: bool
) -> tuple[States, tuple[Note, ...]]:
    """Return states at increasing loads or approaches (k,), and a note on jumps on the way to them."""
    _refuse_merging(scene.law, surface)
    modulus = surface.material.composite_modulus
    low, high = float(values[0]), float(values[-1])
    if not backwards:
        path = loading(scene, high, by_load)
    else:
        what = "load" if by_load else "approach"
        refuse_if(
            high <= 0.0,
            f"the largest {what} is {high:g}; unloading begins at the largest {what}, which must be greater "
            "than 0",
        )
        path = unloading(scene, high, low, by_load)
        pull_off = -float(path.best[-1])
        refuse_if(
            by_load and low < pull_off,
            f"load = {modulus * low:.6g} N is beyond pull-off: on unloading the last contacts break at "
            f"{modulus * pull_off:.6g} N; use loads from there on",
        )
    notes = _notes(*path.jumps(low if backwards else high), modulus, backwards) if by_load else ()
    return path.at(values), notes


def _curve(found: States, last: Callable[[], RescaledState], notes: tuple[Note, ...] = ()) -> Curve:
    return Curve(found.x, found.load, found.area, found.stiffness, found.residual, TOLERANCE, last, notes)


def _arrays(curves: list[Curve]) -> tuple[FloatArray, ...]:
    """Return approaches, loads, areas and stiffnesses (m, k) of curves."""
    names = ("approach", "load", "area", "stiffness")
    return tuple(np.array([getattr(curve, name) for curve in curves]) for name in names)


def _last(found: States) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return loads [mm^2], areas [mm^2] and indentations [mm] (n,) of the last state."""
    return found.fields.load[-1], np.pi * found.a[-1] ** 2, found.indentation[-1]


def _refuse_merging(law: JKR, surface: Surface) -> None:
    """Raise InvalidInput if neighbouring contacts would merge at zero load."""
    reach = of_sizes(JKR.zero_load_radius, law, law.summits(surface))
    first, second, distance = close_pairs(surface, 2.0 * float(reach.max()))
    room = distance - reach[first] - reach[second]
    if room.size and room.min() <= 0.0:
        i, j = sorted((first[room.argmin()], second[room.argmin()]))
        raise InvalidInput(
            f"adhesion_energy = {law.adhesion_energy:g} N/mm: the contacts of asperities {i} and {j} would "
            f"merge without load, with radii of {reach[i]:.3g} and {reach[j]:.3g} mm at a distance of "
            f"{distance[room.argmin()]:.3g} mm; use a smaller energy, a larger modulus or a larger pitch"
        )


def _notes(
    load: FloatArray, before: FloatArray, after: FloatArray, modulus: float, unloading: bool
) -> tuple[Note, ...]:
    """Return a note on the number, the loads and the sizes of the jumps of a curve, or none."""
    if not load.size:
        return ()
    newtons, change = modulus * load, after - before
    most = int(np.abs(change).argmax())
    span = f"from {newtons.min():.4g} to {newtons.max():.4g} N" if load.size > 1 else f"at {newtons[0]:.4g} N"
    what = "break on unloading" if unloading else "jump into contact on loading"
    return (
        information(
            f"{load.size} jump{'s' * (load.size > 1)} of A0, {span}, where asperities {what}; the largest "
            f"changes A0 by {change[most]:+.3g} mm^2, at {newtons[most]:.4g} N"
        ),
    )
