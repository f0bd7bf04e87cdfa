"""Block with free sides, as a substrate."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import ClassVar
from zipfile import BadZipFile

import numpy as np

from metafem import _validate as check
from metafem._caches import cache_folder, write_whole
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, MetafemWarning
from metafem.progress import doing, message
from metafem.substrate.radial import agreed
from metafem.surface import Block, Surface


@dataclass(frozen=True)
class Block3D:
    """A block of finite width and length with free sides, bonded to a rigid base.

    ``G(x, x') = 1/(pi r) + w(x, x')``. The half-space term is in closed form. The smooth remainder w is
    computed with hexahedra of quadratic displacements and linear pressure (Taylor-Hood), for any Poisson's
    ratio up to and including 1/2. Symmetry reduces the computation to a few problems on a quarter of the
    block; Betti's theorem then gives w. The block has no asperities. Each result is stored on disk, in the
    folder that ``metafem doctor`` prints. The environment variable ``METAFEM_CACHE_DIR`` sets another folder.

    The result is valid for loads within the block. Loads nearer to a side than `cell` times the thickness
    need smaller cells, as a warning states. With the default cells, entries for the 8 x 8 lattice on the
    block of Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, have errors below
    1e-5 /mm.

    Parameters
    ----------
    block : Block, optional
        Width, length and thickness [mm]; default: that of the surface.
    poisson_ratio : float, optional
        nu [-], from 0 to 0.5; default: that of the surface's material.
    cell, edge_cell : float
        Sizes of the largest cells near the loads and of the last cells at the sides and the base, over the
        thickness [-]; default: 0.25 and 0.006. The edge between a side and the base is singular. In wide and
        thin blocks the cells are enlarged to limit their number.

    Raises
    ------
    InvalidInput
        If a value is outside its range or differs from that of the surface, the surface has no block, or an
        asperity lies outside the block.
    NotConverged
        If a factorisation fails.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface(
    ...     [[0.0, 0.0]], [0.1], 0.526, mf.Material(1.36), block=mf.Block(20.0, 20.0, 7.2)
    ... )
    >>> Block3D().for_surface(surface).poisson_ratio
    0.5
    """

    name: ClassVar[str] = "block"

    block: Block | None = None
    poisson_ratio: float | None = None
    cell: float = 0.25
    edge_cell: float = 0.006

    def __post_init__(self) -> None:
        check.instance("block", self.block, Block, "a metafem.Block", optional=True)
        check.member(self, "poisson_ratio", optional=True, **check.POISSON)
        check.member(self, "cell", above=0.0, at_most=1.0)
        check.member(self, "edge_cell", above=0.0, at_most=1.0)

    def for_surface(self, surface: Surface) -> Block3D:
        """Return the substrate with the block and the Poisson's ratio of a surface; refuse other values."""
        block = agreed("Block3D", "block", self.block, surface.block)
        if block is None:
            raise InvalidInput("Block3D() needs the surface's block, or the argument block")
        ratio = agreed("Block3D", "poisson_ratio", self.poisson_ratio, surface.material.poisson_ratio)
        half = 0.5 * np.array([block.width, block.length])
        outside = np.flatnonzero((np.abs(surface.position) >= half).any(axis=1))
        if outside.size:
            x, y = surface.position[outside[0]]
            raise InvalidInput(
                f"entry {outside[0] + 1} of position = ({x:g}, {y:g}) is not inside the block, "
                f"|x| < {half[0]:g} and |y| < {half[1]:g}"
            )
        return replace(self, block=block, poisson_ratio=ratio)

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Return the displacement at asperity i per load on j, (n, n) [1/mm], with w on the diagonal."""
        return np.array(self.solution(surface)[0][0])

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return gradient [1/mm^2] and Laplacian [1/mm^3] at i of the displacement per load on j, (n, n)."""
        _, x, y, laplacian = self.solution(surface)[0].copy()
        return x, y, laplacian

    def solution(self, surface: Surface) -> tuple[FloatArray, float, float]:
        """Return the influence between the sites with its derivatives, (4, n, n), and two errors [1/mm].

        They are the displacement at site i per load P/E* on site j [1/mm], symmetric and with the regular
        self terms, its derivatives by x and y of site i [1/mm^2], and its Laplacian [1/mm^3]. The errors are
        the largest difference between mirrored displacements before averaging, and the largest change of one
        with cells 1.6 times as large, an error bound; a `MetafemWarning` is issued if this is large.
        """
        bound = self.for_surface(surface)
        result = _solution(bound, surface.position.tobytes())
        error = result[2]
        assert bound.block is not None
        limit = 0.01 / (math.pi * bound.block.thickness)  # 1 % of the effect of the base
        if error > limit:
            warnings.warn(
                f"the block's influence has an estimated error of {error:.1e} /mm, above "
                f"{limit:.1e}; loads near a side need smaller cells",
                MetafemWarning,
                stacklevel=2,
            )
        return result


def _path(bound: Block3D, position: bytes) -> Path:
    """Return the file of an influence; its name is a hash of the block, the sites and the sources."""
    sources = [path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py"))]
    key = b"".join([*sources, repr(bound).encode(), position])
    return cache_folder() / f"block-{sha256(key).hexdigest()}.npz"


@lru_cache(maxsize=16)
def _solution(bound: Block3D, position: bytes) -> tuple[FloatArray, float, float]:
    """Return an influence, read from disk, or computed and stored if possible."""
    try:
        with _path(bound, position).open("rb") as file, np.load(file) as stored:
            return stored["influence"], *stored["error"].tolist()
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):  # absent or damaged
        pass
    from metafem.fe.quarter import site_influence  # scikit-fem is loaded only if a solution is needed

    assert bound.block is not None
    assert bound.poisson_ratio is not None
    site = np.frombuffer(position).reshape(-1, 2)
    with doing("solving the true block, once for these sites"):
        result = site_influence(bound.block, bound.poisson_ratio, site, bound.cell, bound.edge_cell)
    try:
        path = _path(bound, position)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, lambda file: np.savez(file, influence=result[0], error=result[1:]))
        message(f"the solution of the true block is stored in {path}")
    except OSError as error:
        message(f"the solution of the true block is not stored on disk: {error}")
    return result
