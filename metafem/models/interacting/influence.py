"""Influence of asperities on each other, cached for later calls on the same sites."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from metafem._kernels.coupling import Coupling
from metafem._validate import FloatArray
from metafem.models._resources import require_memory
from metafem.substrate import Radial, Substrate
from metafem.surface import Surface

# Number of cached influences, and largest scene for which one is cached: seven matrices of 256 sites take
# 3.5 MiB.
KEPT_FIELDS, MOST_KEPT = 8, 256


def coupling_between(surface: Surface, bound: Substrate, order: int) -> tuple[Coupling, FloatArray]:
    """Return the influence of the asperities on each other, and the regular self terms (n,).

    bound: the substrate with the thickness and the material of the surface.
    """
    # a radial influence depends only on the sites
    if isinstance(bound, Radial) and isinstance(bound, Hashable) and surface.count <= MOST_KEPT:
        return _kept(bound, order, _Sites(surface.position.tobytes(), surface))
    return _computed(bound, order, surface)


@dataclass(frozen=True)
class _Sites:
    """Sites of a surface, equal if all bits are equal."""

    position: bytes
    surface: Surface = field(compare=False)


@lru_cache(maxsize=KEPT_FIELDS)
def _kept(substrate: Radial, order: int, sites: _Sites) -> tuple[Coupling, FloatArray]:
    """Return the influence between sites, computed once for all heights on them."""
    return _computed(substrate, order, sites.surface)


def _computed(substrate: Substrate, order: int, surface: Surface) -> tuple[Coupling, FloatArray]:
    """Compute the influence of the asperities on each other, and the regular self terms (n,)."""
    # the matrices, those with exchanged ends, the Jacobian, and as much again during their computation
    require_memory(8 * surface.count**2 * (3 if order == 1 else 14), f"{surface.count} asperities")
    influence = np.array(substrate.influence_matrix(surface), dtype=np.float64, order="C")
    regular = np.diagonal(influence).copy()
    np.fill_diagonal(influence, 0.0)
    if order == 1:
        return Coupling(influence, *(np.empty((0, 0)) for _ in range(6))), regular
    derivatives = [np.ascontiguousarray(d) for d in substrate.influence_derivatives(surface)]
    return Coupling(influence, *derivatives, *(np.ascontiguousarray(d.T) for d in derivatives)), regular
