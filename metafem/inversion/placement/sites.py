"""Sites for asperities, of which some may stay empty, and the influence between them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput
from metafem.models import Interacting, Model
from metafem.models._resources import require_memory
from metafem.substrate import HalfSpace, Radial
from metafem.surface import Surface

# Number of matrices of all pairs of sites in memory while the influence is computed.
MATRICES = 3


@dataclass(frozen=True, eq=False)
class Places:
    """Sites (m, 2) [mm] for asperities, and the influence between them (m, m) [1/mm]."""

    position: FloatArray
    influence: FloatArray
    number: dict[tuple[float, float], int]

    def numbers(self, position: FloatArray) -> IntArray:
        """Return the numbers of the sites at these positions, (n,)."""
        found = [self.number.get((x, y), -1) for x, y in position.tolist()]
        if -1 in found:
            i = found.index(-1)
            x, y = position[i]
            raise InvalidInput(f"position[{i}] = ({x:g}, {y:g}) of the surface is none of the places")
        return np.array(found)


def places_for(surface: Surface, model: Model, places: ArrayLike | None) -> tuple[Places, Model]:
    """Return the sites (default: those of the surface), and the model for surfaces on them.

    The influence of an expensive substrate is computed once, for all sites. For models without a substrate
    it is that of the half-space.
    """
    position = surface.position
    if places is not None:
        position = check.array("places", places, shape=(None, 2))
    count = len(position)
    require_memory(MATRICES * 8 * count**2, f"the influence between {count} places")
    number = {(x, y): i for i, (x, y) in enumerate(position.tolist())}
    everywhere = surface.replaced(position=position, height=np.zeros(count), radius=1.0)
    if not model.couples:
        return Places(position, np.zeros((count, count)), number), model
    substrate = model.substrate if isinstance(model, Interacting) else HalfSpace()
    influence = np.asarray(substrate.influence_matrix(everywhere))
    found = Places(position, influence, number)
    if not isinstance(model, Interacting) or isinstance(substrate, Radial) or count == surface.count:
        return found, model
    return found, replace(model, substrate=KnownInfluence(found, substrate.influence_derivatives(everywhere)))


@dataclass(frozen=True, eq=False)
class KnownInfluence:
    """The influence of a substrate between sites, for surfaces on some of them."""

    places: Places
    derivatives: tuple[FloatArray, FloatArray, FloatArray]

    def for_surface(self, surface: Surface) -> KnownInfluence:
        """Return the substrate itself."""
        return self

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Displacement at each asperity per load on each other, (n, n) [1/mm]."""
        return np.asarray(self.places.influence[self._pairs(surface)])

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gradient [1/mm^2] and Laplacian [1/mm^3] of the displacement, (n, n) each."""
        pairs = self._pairs(surface)
        along, across, laplacian = (part[pairs] for part in self.derivatives)
        return along, across, laplacian

    def _pairs(self, surface: Surface) -> tuple[IntArray, ...]:
        rows = self.places.numbers(surface.position)
        return np.ix_(rows, rows)
