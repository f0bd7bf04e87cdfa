"""Error, time and memory of the influence of the true block between the sites of the paper's lattice."""

from __future__ import annotations

import os
import tempfile
from unittest import mock

import numpy as np

import metafem as mf
from metafem import _caches
from metafem.fe.block3d.substrate import _solution
from validation.methods.contact_equations import influence
from validation.timing import Row, best, peak_memory, took

THICKNESS, POISSON_RATIO = 7.2, 0.5
# Refined: 0.8 times the default cells, and 2/3 of the last cells at the singular edge.
REFINED = {"cell": 0.2, "edge_cell": 0.004}
# The wide block has three times as many cells; its edges are far from the loads.
WIDE = {"cell": 0.4, "edge_cell": 0.05}


def lattice(width: float = 20.0) -> mf.Surface:
    """Return 8 x 8 asperities on a block as thick as the paper's."""
    block = mf.Block(width, width, THICKNESS)
    return mf.Surface.square_lattice(
        0.1, radius=0.526, material=mf.Material(1.36, POISSON_RATIO), block=block
    )


def rows() -> list[Row]:
    """Measure the errors, times and memory of the block."""
    surface = lattice()
    with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {_caches.VARIABLE: folder}):
        once, found = took(lambda: mf.fe.Block3D().solution(surface))
        memory = peak_memory()

        def read() -> None:
            _solution.cache_clear()
            mf.fe.Block3D().influence_matrix(surface)

        again = best(read, 3)
        refined = mf.fe.Block3D(**REFINED).influence_matrix(surface)
        wide = mf.fe.Block3D(**WIDE).influence_matrix(lattice(90.0))
        _solution.cache_clear()
    layer = influence(surface, "layer")
    return [
        Row("largest difference from a refined solution", 1e-5, np.abs(found.matrix - refined).max(), "/mm"),
        Row("error estimate of the default solution", 3e-5, found.error_estimate, "/mm"),
        Row("asymmetry of the matrix (reciprocity)", 1e-5, found.asymmetry, "/mm"),
        Row("largest difference of a block of 90 mm from the layer", 1e-5, np.abs(wide - layer).max(), "/mm"),
        Row("first computation", 120.0, once, "s"),
        Row("peak memory", 4.0, memory, "GiB"),
        Row("read from the cache", 0.1, again, "s"),
    ]
