"""Influence of the asperities on each other, cached for later calls with the same sites."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import scipy

from metafem._kernels.equations import Coupling
from metafem._validate import FloatArray, IntArray
from metafem.errors import refuse_if
from metafem.material import PeriodicCell
from metafem.models._resources import require_memory
from metafem.models.interacting.scattered import fast_sums
from metafem.models.interacting.sums import find_grid, require_series
from metafem.substrate import Radial, Substrate
from metafem.surface import Surface

# Largest numbers of asperities of which eight influences, and the last one, are cached. The four matrices of
# 256 sites take 2 MiB, those of 1000 sites 31 MiB; computing them takes as long as 10 loads of a curve.
MOST_KEPT, MOST_LAST = 256, 1000

# Largest number of asperities in a periodic cell; the sums for 2000 take seconds and 0.5 GB.
MOST_PERIODIC = 2000

# Largest number of asperities for which fast sums and neighbours are cached. The spectra and positions of
# 10,000 sites take 2 MiB, their neighbours 8 MiB.
MOST_KEPT_SUMS = 10_000

# Number of nearest neighbours that short-ranged sums include above `MOST_KEPT` asperities. On a lattice,
# asperities farther away add less than a hundredth.
NEIGHBOURS = 24


def _scattered(surface: Surface) -> bool:
    """Return whether the sites are in a periodic cell, but not on a grid that divides it."""
    return surface.cell is not None and find_grid(surface.position, surface.cell) is None


@dataclass(frozen=True)
class Sites:
    """Sites of a surface and its periodic cell; two are equal if all their bits are."""

    position: bytes
    cell: PeriodicCell | None
    surface: Surface = field(compare=False)


def cached(
    function: Callable[[Any, int, Surface], Any],
    substrate: Substrate | None,
    order: int,
    surface: Surface,
    several: float,
    last: float = 0,
) -> Any:
    """Return function(substrate, order, surface), which does not depend on the heights, from a cache.

    The cache has eight results for sites of at most `several` asperities, and one for at most `last`.
    """
    if surface.count > max(several, last) or not isinstance(substrate, Hashable):
        return function(substrate, order, surface)
    sites = Sites(surface.position.tobytes(), surface.cell, surface)
    return (_several if surface.count <= several else _last)(function, substrate, order, sites)


def _of_sites(function: Callable[..., Any], substrate: Any, order: int, sites: Sites) -> Any:
    return function(substrate, order, sites.surface)


_several, _last = lru_cache(8)(_of_sites), lru_cache(1)(_of_sites)


def coupling_between(surface: Surface, bound: Substrate, order: int) -> tuple[Coupling, FloatArray]:
    """Return the influence of the asperities on each other, and the regular self terms (n,).

    bound: the substrate with the thickness and the material of the surface.
    """
    if not isinstance(bound, Radial):
        return _computed(bound, order, surface)
    found: tuple[Coupling, FloatArray] = cached(_computed, bound, order, surface, MOST_KEPT, MOST_LAST)
    return found


def displacements(surface: Surface, bound: Substrate) -> Callable[[FloatArray], FloatArray]:
    """Return a function that computes the displacements (m, n) [mm] of the summits by loads (m, n) [mm^2].

    They include the regular self terms. A dense matrix is used for few asperities, for substrates that are
    not radial and for scattered sites in a cell, otherwise fast sums.
    """
    if surface.count <= MOST_KEPT or not isinstance(bound, Radial) or _scattered(surface):
        (influence, _), regular = coupling_between(surface, bound, 1)
        return lambda load: load @ influence + regular * load
    sums = cached(fast_sums, bound, 1, surface, MOST_KEPT_SUMS)
    own = sums.self_influence
    return lambda load: np.array([sums.displacement(row) for row in load]) + own * load


def nearest_distance(surface: Surface) -> float:
    """Return the smallest distance between two asperities [mm]; infinite for one asperity without a cell."""
    return float(neighbours(surface)[0].min(initial=math.inf))


def neighbours(surface: Surface) -> tuple[FloatArray, IntArray, FloatArray]:
    """Return distances [mm], indices and relative positions of the nearest neighbours, (n, q), (n, q, 2).

    There are `NEIGHBOURS`, for few asperities `MOST_KEPT` or all. With a cell they include sites of other
    periods, in particular those of the site itself.
    """
    found: tuple[FloatArray, IntArray, FloatArray] = cached(_neighbours, None, 0, surface, MOST_KEPT_SUMS)
    return found


def close_pairs(surface: Surface, reach: float) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the pairs i, j of sites up to a distance, and their distances [mm].

    With a cell, the neighbours of each site are searched among all periods; each pair then counts once.
    """
    if surface.cell is None:
        tree = scipy.spatial.cKDTree(surface.position)
        i, j = tree.query_pairs(reach, output_type="ndarray").T
        return i, j, np.hypot(*(tree.data[i] - tree.data[j]).T)
    distance, other, apart = neighbours(surface)
    site = np.broadcast_to(np.arange(surface.count)[:, None], other.shape)
    # of the two equal directions between periods of one site, only one counts
    once = (site < other) | ((site == other) & ((apart > 0.0) @ [2, 1] > (apart < 0.0) @ [2, 1]))
    kept = once & (distance <= reach)
    return site[kept], other[kept], distance[kept]


def _neighbours(_substrate: None, _order: int, surface: Surface) -> tuple[FloatArray, IntArray, FloatArray]:
    position, cell = surface.position, surface.cell
    images, some = position, 1 + (MOST_KEPT if len(position) <= MOST_KEPT else NEIGHBOURS)
    if cell is not None:
        # periods on each side, so that there are enough sites at the distances of the neighbours
        reach, sides = math.sqrt(some * cell.area / len(position)), (cell.width, cell.length)
        steps = [side * np.arange(-(most := math.ceil(reach / side)), most + 1) for side in sides]
        shift = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 1, 2)
        images = (position + shift).reshape(-1, 2)
    found = scipy.spatial.cKDTree(images).query(position, k=min(some, len(images)))
    distance, other = (np.reshape(part, (len(position), -1))[:, 1:] for part in found)
    return distance, other % len(position), position[:, None] - images[other]


def _computed(substrate: Substrate, order: int, surface: Surface) -> tuple[Coupling, FloatArray]:
    """Return the influence of the asperities on each other, and the regular self terms (n,), uncached."""
    refuse_if(
        surface.cell is not None and surface.count > MOST_PERIODIC,
        f"a periodic cell with {surface.count} asperities is too large for sums over all pairs, of at most "
        f"{MOST_PERIODIC}; use a smaller cell, or sites on a rectangular grid that divides it",
    )
    if surface.cell is not None and isinstance(substrate, Radial):
        require_series(surface.cell, substrate, surface.count**2)
    # matrices at once (measured): of the influence, its derivatives and their parts, with a cell also of each
    # pair's periods, or of the transposes of a substrate that is not radial; later there are fewer
    matrices = 16 if surface.cell is not None else 11 if isinstance(substrate, Radial) else 15
    require_memory(8 * matrices * surface.count**2, f"{surface.count} asperities")
    if order == 3 and isinstance(substrate, Radial):
        given, *terms = substrate.influence_terms(surface)
    else:
        given = substrate.influence_matrix(surface)
        terms = [] if order == 1 else [*substrate.influence_derivatives(surface)]
    influence = np.array(given, dtype=np.float64, order="C")
    regular = np.diagonal(influence).copy()
    np.fill_diagonal(influence, 0.0)
    if order == 1:
        return (influence, influence), regular
    x, y, laplacian = terms
    source = np.concatenate([influence, laplacian, x, y], axis=1)
    if isinstance(substrate, Radial):
        return (source, source), regular
    return (source, np.concatenate([influence, laplacian.T, -x.T, -y.T], axis=1)), regular


def refuse_wide(surface: Surface, contact_radius: float) -> None:
    """Raise InvalidInput if a contact radius [mm] exceeds half of the shorter side of a periodic cell."""
    if surface.cell is None:
        return
    side = min(surface.cell.width, surface.cell.length)
    refuse_if(
        2.0 * contact_radius > side,
        f"a contact of radius {contact_radius:.4g} mm is wider than the periodic cell of {side:g} mm; use "
        "lighter loads or a larger cell",
    )
