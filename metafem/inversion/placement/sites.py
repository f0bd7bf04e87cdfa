"""Sites for asperities, some of which may be empty, and the influence between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.models._resources import require_memory
from metafem.substrate import Radial
from metafem.surface import Surface

# Number of matrices of all pairs of sites in memory while the influence is computed.
MATRICES = 3


@dataclass(frozen=True, eq=False)
class Sites:
    """Positions (m, 2) [mm] for asperities, and the influence between them (m, m) [1/mm].

    With its `derivatives` it is a substrate of surfaces on some of the sites.
    """

    position: FloatArray
    influence: FloatArray
    derivatives: tuple[FloatArray, ...] = ()

    @cached_property
    def index(self) -> dict[tuple[float, float], int]:
        """Index of each position."""
        return {(x, y): i for i, (x, y) in enumerate(self.position.tolist())}

    def indices(self, position: FloatArray) -> IntArray:
        """Return the indices of the sites at these positions, (n,)."""
        found = [self.index.get((x, y), -1) for x, y in position.tolist()]
        i = found.index(-1) if -1 in found else 0
        x, y = position[i]
        words = f"position[{i}] = ({x:g}, {y:g}) of the surface is not among the given ones"
        refuse_if(found[i] < 0, words)
        return np.array(found)

    def for_surface(self, surface: Surface) -> Sites:
        """Return the substrate itself."""
        return self

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Displacement at each asperity per load on every other one, (n, n) [1/mm]."""
        return np.asarray(self.influence[self._pairs(surface)])

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, ...]:
        """Gradient [1/mm^2] and Laplacian [1/mm^3] of the displacement, (n, n) each."""
        pairs = self._pairs(surface)
        return tuple(part[pairs] for part in self.derivatives)

    def _pairs(self, surface: Surface) -> tuple[IntArray, ...]:
        rows = self.indices(surface.position)
        return np.ix_(rows, rows)


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
    everywhere = surface.replaced(position=given, height=np.zeros(count), radius=1.0)
    if not model.couples:
        return Sites(given, np.zeros((count, count))), model
    substrate = model.reference.substrate
    sites = Sites(given, np.asarray(substrate.influence_matrix(everywhere)))
    if isinstance(substrate, Radial) or count == surface.count:
        return sites, model
    coupled: Any = model
    known = replace(sites, derivatives=substrate.influence_derivatives(everywhere))
    return known, replace(coupled, substrate=known)
