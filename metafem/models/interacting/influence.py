"""Influence of asperities on each other, cached for later calls with the same sites."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import scipy

from metafem._kernels.equations import Coupling
from metafem._validate import FloatArray, IntArray
from metafem.errors import refuse_if
from metafem.material import PeriodicCell
from metafem.models._resources import require_memory
from metafem.models.interacting.scattered import fast_sums
from metafem.models.interacting.sums import Sums, find_grid, require_series
from metafem.substrate import Radial, Substrate
from metafem.surface import Surface

# Number of cached influences, and largest number of asperities for which the influence is cached. The seven
# matrices of 256 sites take 3.5 MiB. Of larger scenes only the last one is cached, up to 1000 asperities: its
# matrices take 53 MiB. Computing them takes as long as 10 loads of a curve.
KEPT_FIELDS, MOST_KEPT, MOST_LAST = 8, 256, 1000

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

    @classmethod
    def of(cls, surface: Surface) -> Sites:
        """Return the sites of a surface."""
        return cls(surface.position.tobytes(), surface.cell, surface)


def coupling_between(surface: Surface, bound: Substrate, order: int) -> tuple[Coupling, FloatArray]:
    """Return the influence of the asperities on each other, and the regular self terms (n,).

    bound: the substrate with the thickness and the material of the surface.
    """
    # a radial influence depends only on the sites
    if isinstance(bound, Radial) and isinstance(bound, Hashable) and surface.count <= MOST_LAST:
        cached = _kept if surface.count <= MOST_KEPT else _last
        return cached(bound, order, Sites.of(surface))
    return _computed(bound, order, surface)


def displacements(surface: Surface, bound: Substrate) -> Callable[[FloatArray], FloatArray]:
    """Return a function that computes the displacements (m, n) [mm] of the summits by loads (m, n) [mm^2].

    They include the regular self terms. A dense matrix is used for few asperities, for substrates that are
    not radial and for scattered sites in a cell, otherwise fast sums.
    """
    if surface.count <= MOST_KEPT or not isinstance(bound, Radial) or _scattered(surface):
        coupling, regular = coupling_between(surface, bound, 1)
        return lambda load: load @ coupling.source + regular * load
    if surface.count > MOST_KEPT_SUMS or not isinstance(bound, Hashable):
        sums = fast_sums(surface, bound, 1)
    else:
        sums = _kept_sums(bound, Sites.of(surface))
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
    return (_kept_neighbours if surface.count <= MOST_KEPT_SUMS else _neighbours)(Sites.of(surface))


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


def _neighbours(sites: Sites) -> tuple[FloatArray, IntArray, FloatArray]:
    position, cell = sites.surface.position, sites.cell
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


_kept_neighbours = lru_cache(maxsize=KEPT_FIELDS)(_neighbours)


@lru_cache(maxsize=KEPT_FIELDS)
def _kept(substrate: Radial, order: int, sites: Sites) -> tuple[Coupling, FloatArray]:
    """Return the cached influence between sites; it does not depend on the heights."""
    return _computed(substrate, order, sites.surface)


@lru_cache(maxsize=1)
def _last(substrate: Radial, order: int, sites: Sites) -> tuple[Coupling, FloatArray]:
    """Return the cached influence between the sites of the last larger scene."""
    return _computed(substrate, order, sites.surface)


@lru_cache(maxsize=KEPT_FIELDS)
def _kept_sums(substrate: Radial, sites: Sites) -> Sums:
    """Return the cached sums over sites; they do not depend on the heights."""
    return fast_sums(sites.surface, substrate, 1)


def _computed(substrate: Substrate, order: int, surface: Surface) -> tuple[Coupling, FloatArray]:
    """Return the influence of the asperities on each other, and the regular self terms (n,), uncached."""
    refuse_if(
        surface.cell is not None and surface.count > MOST_PERIODIC,
        f"a periodic cell with {surface.count} asperities is too large for sums over all pairs, of at most "
        f"{MOST_PERIODIC}; use a smaller cell, or sites on a rectangular grid that divides it",
    )
    if surface.cell is not None and isinstance(substrate, Radial):
        require_series(surface.cell, substrate, surface.count**2)
    # the matrices, their transposes, the Jacobian, and temporary arrays of the same size
    require_memory(8 * surface.count**2 * (3 if order == 1 else 14), f"{surface.count} asperities")
    if order == 3 and isinstance(substrate, Radial):
        given, *terms = substrate.influence_terms(surface)
    else:
        given = substrate.influence_matrix(surface)
        terms = [] if order == 1 else [*substrate.influence_derivatives(surface)]
    influence = np.array(given, dtype=np.float64, order="C")
    regular = np.diagonal(influence).copy()
    np.fill_diagonal(influence, 0.0)
    if order == 1:
        return Coupling(influence, influence), regular
    x, y, laplacian = terms
    source = np.concatenate([influence, laplacian, x, y], axis=1)
    if isinstance(substrate, Radial):
        return Coupling(source, source), regular
    return Coupling(source, np.concatenate([influence, laplacian.T, -x.T, -y.T], axis=1)), regular
