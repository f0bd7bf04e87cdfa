"""Sites for asperities, some of which may be empty, and the influence between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput
from metafem.models import Model
from metafem.models._resources import require_memory
from metafem.substrate import Radial
from metafem.surface import Surface

# Number of matrices of all pairs of sites in memory while the influence is computed.
MATRICES = 3


@dataclass(frozen=True, eq=False)
class Sites:
    """Positions (m, 2) [mm] for asperities, and the influence between them (m, m) [1/mm]."""

    position: FloatArray
    influence: FloatArray
    index: dict[tuple[float, float], int]

    def indices(self, position: FloatArray) -> IntArray:
        """Return the indices of the sites at these positions, (n,)."""
        found = [self.index.get((x, y), -1) for x, y in position.tolist()]
        if -1 in found:
            i = found.index(-1)
            x, y = position[i]
            raise InvalidInput(f"position[{i}] = ({x:g}, {y:g}) of the surface is not among the given ones")
        return np.array(found)


def sites_for(surface: Surface, model: Model, position: ArrayLike | None) -> tuple[Sites, Model]:
    """Return the sites (default: those of the surface), and the model for surfaces on them.

    The influence is that of the model's substrate, zero for independent asperities. For a non-radial
    substrate it is computed once, for all sites.
    """
    given = surface.position
    if position is not None:
        given = check.array("position", position, shape=(None, 2))
    count = len(given)
    require_memory(MATRICES * 8 * count**2, f"the influence between {count} sites")
    index = {(x, y): i for i, (x, y) in enumerate(given.tolist())}
    everywhere = surface.replaced(position=given, height=np.zeros(count), radius=1.0)
    if not model.couples:
        return Sites(given, np.zeros((count, count)), index), model
    substrate = model.reference.substrate
    sites = Sites(given, np.asarray(substrate.influence_matrix(everywhere)), index)
    if isinstance(substrate, Radial) or count == surface.count:
        return sites, model
    known: Any = KnownInfluence(sites, substrate.influence_derivatives(everywhere))
    coupled: Any = model
    return sites, replace(coupled, substrate=known)


@dataclass(frozen=True, eq=False)
class KnownInfluence:
    """The influence of a substrate between sites, for surfaces on some of them."""

    sites: Sites
    derivatives: tuple[FloatArray, FloatArray, FloatArray]

    def for_surface(self, surface: Surface) -> KnownInfluence:
        """Return the substrate itself."""
        return self

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Displacement at each asperity per load on every other one, (n, n) [1/mm]."""
        return np.asarray(self.sites.influence[self._pairs(surface)])

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gradient [1/mm^2] and Laplacian [1/mm^3] of the displacement, (n, n) each."""
        pairs = self._pairs(surface)
        along, across, laplacian = (part[pairs] for part in self.derivatives)
        return along, across, laplacian

    def _pairs(self, surface: Surface) -> tuple[IntArray, ...]:
        rows = self.sites.indices(surface.position)
        return np.ix_(rows, rows)
