"""Curves of surfaces with adhesive contacts, alone and coupled."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from metafem._kernels.newton import TOLERANCE
from metafem._validate import FloatArray
from metafem.contact import JKR, Contact
from metafem.contact.jkr import of_sizes
from metafem.contact.law import sizes_of
from metafem.errors import InvalidInput, NotConverged, refuse_if, shown
from metafem.models.adhesion.contacts import Scene, States
from metafem.models.adhesion.path import loaded, unloaded
from metafem.models.curve import Curve, RescaledState, Sensitivity
from metafem.models.interacting.elastic import ElasticCoupling
from metafem.models.interacting.influence import close_pairs, coupling_between, refuse_wide
from metafem.models.load_equation import LoadEquation
from metafem.surface import Surface


@dataclass(frozen=True)
class AdhesiveAsperities(LoadEquation):
    """Asperities with an adhesive law, alone or coupled by order 1."""

    law: JKR
    coupled: ElasticCoupling | None = (
        None  # the asperities with their influence on each other; None for no influence
    )

    def path(self, values: FloatArray, by_load: bool, unloading: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,), on loading or on unloading."""
        surface = cast("Surface", self.surface)
        _refuse_merging(self.law, surface)
        scene, modulus = self._scene(surface.height), surface.material.composite_modulus
        if unloading:
            what = "load" if by_load else "approach"
            refuse_if(
                values[-1] <= 0.0,
                f"the largest {what} is {values[-1]:g}; unloading begins at the largest {what}, which must "
                "be greater than 0",
            )
            found, pull_off = unloaded(scene, values, by_load)
            refuse_if(
                by_load and values[0] < pull_off,
                f"load = {modulus * values[0]:.6g} N is beyond pull-off: on unloading the last contacts "
                f"break at {modulus * pull_off:.6g} N; use loads from there on",
            )
        else:
            found = loaded(scene, values, by_load)
        if self.coupled is not None:
            refuse_wide(surface, float(found.a.max()))
        return self._curve(found, surface.height)

    def curve(self, height: FloatArray, load: FloatArray, radius: Any = None) -> Curve:
        """Return the loading curve at increasing loads (k,) for heights and summits (n,)."""
        return self._curve(loaded(self._scene(height, radius), load), height)

    def areas(self, height: FloatArray, radius: FloatArray | None, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) for heights and radii (m, n); see `Model.areas`."""
        surface, area = cast("Surface", self.surface), np.full((len(height), len(load)), np.nan)
        _refuse_merging(self.law, surface)
        sizes = np.broadcast_to(self.law.summits(surface, radius), height.shape)
        for row, heights in enumerate(height):
            with contextlib.suppress(NotConverged):
                area[row] = loaded(self._scene(heights, sizes[row]), load).area
        return area

    def sensitivity(self, height: FloatArray, load: FloatArray, radius: Any = None) -> Sensitivity:
        """Return the loading curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        found = loaded(self._scene(height, radius), load)

        def gradient() -> FloatArray:
            plain = found.gradient()
            if self.coupled is None:
                return plain
            return self.coupled.on_pedestals(plain, height, found.fields.load)

        return Sensitivity(self._curve(found, height), gradient, found.indentation)

    def _scene(self, height: FloatArray, radius: Any = None) -> Scene:
        """Return asperities with heights and summits (n,) [mm]; default: the summits of the surface."""
        summits, gap = np.broadcast_to(self.summits(radius), height.shape), height.max() - height
        if self.coupled is None:
            return Scene(self.law, summits, gap)
        refuse_if(  # one state then takes a second, and every asperity may jump
            len(gap) > 1000,
            f"{len(gap)} adhesive asperities with interaction are too many: at most 1000; "
            "use Independent, or fewer asperities",
        )
        (influence, _), regular = coupling_between(self.coupled.surface, self.coupled.substrate, 1)
        own = regular + self.coupled.pedestals(height, sizes_of(summits))
        return Scene(self.law, summits, gap, influence.T + np.diag(own))

    def _curve(self, found: States, height: FloatArray) -> Curve:
        def last() -> RescaledState:
            parts = found.fields.load[-1], np.pi * found.a[-1] ** 2, found.indentation[-1]
            if self.coupled is not None:
                return self.coupled.state(height, *parts)
            return RescaledState(*parts, float(height.max() - found.x[-1]), self.model)

        return Curve(found.x, found.load, found.area, found.stiffness, found.residual, TOLERANCE, last)


def adhesive_law(law: Contact) -> JKR | None:
    """Return the law if it is adhesive, otherwise None."""
    if not law.adhesive:
        return None
    if not isinstance(law, JKR):
        raise InvalidInput(
            f"contact = {shown(law)}: the branches of adhesive laws other than metafem.JKR are unknown"
        )
    return law


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
