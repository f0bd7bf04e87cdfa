"""Load equation of adhesive asperities that do not interact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import JKR
from metafem.models.adhesion.notes import jump_notes, refuse_beyond, refuse_merging, refuse_no_loading
from metafem.models.adhesion.paths import Asperities, Path, Sums
from metafem.models.adhesion.solve import TOLERANCE
from metafem.models.curve import Curve, RescaledState, Sensitivity
from metafem.models.load_equation import LoadEquation, at_fixed_load
from metafem.notes import Note
from metafem.surface import Surface


@dataclass(frozen=True)
class AdhesiveAsperities(LoadEquation):
    """Load equation for an adhesive law."""

    law: JKR

    def path(self, surface: Surface, values: FloatArray, by_load: bool, unloading: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,), on loading or on unloading."""
        refuse_merging(self.law, surface)
        modulus = surface.material.composite_modulus
        asperities = Asperities(self.law, self.law.summits(surface), surface.gap)
        found = equilibria(asperities, values, by_load, unloading, modulus)
        notes: tuple[Note, ...] = ()
        if found.path is not None:
            notes = jump_notes(found.path.jumps(values[0] if unloading else values[-1]), modulus, unloading)
        return found.curve(self.model, surface.height, notes)

    def curve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        """Return equilibria at increasing loads (k,) for heights and radii (n,)."""
        return self._loaded(height, radius, load).curve(self.model, height)

    def solve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) of surfaces (m, n) at increasing loads (k,)."""
        every = zip(height, np.broadcast_to(radius, height.shape), strict=True)
        curves = [self.curve(*row, load) for row in every]
        names = ("approach", "load", "area", "stiffness")
        return tuple(np.array([getattr(curve, name) for curve in curves]) for name in names)

    def areas(self, surface: Surface, height: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) of surfaces (m, n) at loads (k,); see `Model.areas`."""
        refuse_merging(self.law, surface)
        every = zip(height, np.broadcast_to(radius, height.shape), strict=True)
        return np.array([self.curve(*row, load).area for row in every])

    def sensitivity(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the loading curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        found = self._loaded(height, radius, load)
        a, law = found.sums.contact_radius, self.law
        return Sensitivity(
            found.curve(self.model, height),
            lambda: at_fixed_load(law.stiffness(a, radius), law.area_slope(a, radius)),
            found.indentation,
        )

    def contacts(
        self, height: FloatArray, radius: FloatArray, load: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return contact radii and indentations (k, n) [mm] at increasing loads (k,).

        An open asperity has the radius 0, and minus its gap as indentation.
        """
        found = self._loaded(height, radius, load)
        return found.sums.contact_radius, found.indentation

    def _loaded(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Equilibria:
        gap = height.max() - height
        asperities = Asperities(self.law, np.broadcast_to(radius, gap.shape), gap)
        return equilibria(asperities, load)


@dataclass(frozen=True)
class Equilibria:
    """States of n adhesive asperities at increasing rescaled loads or approaches (k,)."""

    asperities: Asperities
    path: Path | None  # under load control
    approach: FloatArray  # (k,) [mm]
    sums: Sums
    control: FloatArray

    @property
    def indentation(self) -> FloatArray:
        """Indentations (k, n) [mm]; minus the gap for an open asperity."""
        return np.asarray(self.approach[:, None] - self.asperities.gap)

    @property
    def residual(self) -> FloatArray:
        """Relative error of the load, (k,).

        Errors are divided by the sum of contact radius times indentation of the cap, since
        adhesive loads may sum to zero.
        """
        some, a = self.asperities, self.sums.contact_radius
        if self.path is None:
            return np.zeros(len(a))
        carried = (a * some.law.cap.indentation(a, some.radius)).sum(axis=1)
        error = self.sums.load - self.control
        return np.asarray(np.abs(error) / np.where(carried > 0.0, carried, 1.0))

    def curve(self, model: object, height: FloatArray, notes: tuple[Note, ...] = ()) -> Curve:
        """Return the curve for heights (n,) [mm]."""
        load, area, stiffness, _ = self.sums
        last = partial(self._last, model, height)
        return Curve(self.approach, load, area, stiffness, self.residual, TOLERANCE, last, notes)

    def _last(self, model: object, height: FloatArray) -> RescaledState:
        some, a, x = self.asperities, self.sums.contact_radius[-1], float(self.approach[-1])
        return RescaledState(some.loads(a), some.law.area(a), x - some.gap, float(height.max()) - x, model)


def equilibria(
    asperities: Asperities,
    values: FloatArray,
    by_load: bool = True,
    unloading: bool = False,
    modulus: float = 1.0,
) -> Equilibria:
    """Return the states at increasing loads or approaches (k,), on loading or unloading from the largest."""
    if unloading:
        refuse_no_loading(values, by_load, 0.0)
    x, gap = np.array(values), asperities.gap
    if not by_load:
        closed = gap <= x[:, None]
        if unloading:
            closed = (gap <= x[-1]) & (gap + asperities.end <= x[:, None])
        return Equilibria(asperities, None, x, asperities.sums(x, closed), values)
    path = asperities.loading(float(values[-1]))
    if unloading:
        (largest,), _ = path.approach(values[-1:])
        path = asperities.unloading(float(largest))
        if values[0] < path.best[-1]:
            refuse_beyond(values[0], path.best[-1], modulus)
    reached = path.piece(values) < len(path.best)
    closed = np.zeros((len(values), len(gap)), dtype=bool)
    x[reached], closed[reached] = path.approach(values[reached])
    return Equilibria(asperities, path, x, asperities.sums(x, closed), values)
