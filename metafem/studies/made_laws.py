"""Random laws of made surfaces in batches, and their misfits from the target of a design."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion import Design
from metafem.inversion.design import misfits
from metafem.models import Model
from metafem.prediction import Tolerances
from metafem.studies.sampling.points import unit_points
from metafem.surface import Surface

# Number of draws of a batch; such a batch takes half a second on a bonded layer.
SIZE = 256


@dataclass(frozen=True, eq=False)
class MadeLaws:
    """Batches of the laws of random made surfaces.

    The points of the unit cube depend only on the seed and the batch, so that all tolerances use the same
    points (common random numbers). `dimensions` is the number of their coordinates; those of the heights come
    first and are not used without errors of the heights.
    """

    surface: Surface
    model: Model
    tolerances: Tolerances
    load: FloatArray  # (k,) [mm^2], increasing
    seed: int
    draws: int
    dimensions: int

    def __call__(self, batch: int) -> FloatArray:
        """Return A0 (m, k) [mm^2] of a batch; nan without a solution."""
        size = min(SIZE, self.draws - batch * SIZE)
        own = self.tolerances.dimensions(self.surface)
        unit = unit_points(self.seed, batch, size, self.dimensions)[:, self.dimensions - own :]
        different = unit if own else unit[:1]
        area = self.tolerances.areas(self.model, self.surface, self.load, different)
        return np.broadcast_to(area, (size, len(self.load)))


def law_loads(design: Design) -> FloatArray:
    """Return the rescaled loads [mm^2] at which `law_misfits` needs the areas, increasing."""
    lists = [design.target_law.load, *(branch.load for branch, _ in design.fits)]
    return np.unique(np.concatenate(lists))


def law_misfits(design: Design, load: FloatArray, area: FloatArray) -> FloatArray:
    """Return the misfits (m,) of laws, from their areas (m, k) at the loads (k,); inf without a solution."""
    law, branches = design.target_law, tuple(branch for branch, _ in design.fits)
    solved = np.isfinite(area).all(axis=1)
    result = np.full(len(area), np.inf)
    if not solved.any():
        return result

    def at(loads: FloatArray) -> FloatArray:
        return area[solved][:, np.searchsorted(load, loads)]

    slopes = np.empty((int(solved.sum()), len(branches)))
    for column, branch in enumerate(branches):
        off = branch.load - branch.load.mean()
        # no matrix product: its last bits would depend on the number of threads
        slopes[:, column] = np.einsum("mk,k->m", at(branch.load), off / (off @ off))
    at_target = at(law.load)
    result[solved] = misfits(law, branches, at_target / law.laws(at_target) - 1.0, slopes)
    return result
