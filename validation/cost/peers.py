"""Another public code on the same surfaces: contact on a regular grid, solved by conjugate gradients.

tamaas (extra ``[peers]``) is measured where it is installed; metafem does not import it.
"""

from __future__ import annotations

import importlib.util
import math
import os
from dataclasses import dataclass
from functools import cached_property

import numpy as np

import metafem as mf
from validation.timing import took

# The tolerance of its solver, on its own measure, with which it is fast: with a hundredth of it the areas on
# the surface of Fig. 4, red, change by less than 0.2 %.
TAMAAS_TOLERANCE = 1e-4

# Threads of tamaas: all processor cores. metafem's solver of interacting asperities starts none.
THREADS = os.cpu_count() or 1

# Width of the grid beyond the outermost summits, in radii of curvature: no contact here is that wide.
MARGIN = 0.7


@dataclass(frozen=True)
class Answer:
    """What one solver found under a load [N].

    seconds: of the solver alone; area: as the code reports it [mm²]; moments: from the second moments of the
    pressure of each contact [mm²]; separation [mm].
    """

    seconds: float
    area: float
    moments: float
    separation: float


@dataclass(frozen=True)
class Grid:
    """Square cells over a whole surface."""

    surface: mf.Surface
    cell: float

    @cached_property
    def side(self) -> int:
        """Number of cells along a side, of which the FFT is fast."""
        from scipy.fft import next_fast_len

        width = np.ptp(self.surface.position, axis=0).max() + 2.0 * MARGIN * self.surface.radius.max()
        return int(next_fast_len(math.ceil(width / self.cell)))

    @cached_property
    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Centres of the cells along x and y [mm], (side,) each."""
        low, high = self.surface.position.min(axis=0), self.surface.position.max(axis=0)
        steps = self.cell * (np.arange(self.side) - self.side // 2)
        x, y = 0.5 * (low + high)
        return x + steps, y + steps

    @cached_property
    def caps(self) -> tuple[np.ndarray, np.ndarray]:
        """Height of the surface [mm] and the asperity of each cell, (side, side) each."""
        x, y = self.axes
        profile = np.full((self.side, self.side), -np.inf)
        owner = np.zeros(profile.shape, dtype=np.intp)
        summits = zip(self.surface.position, self.surface.height, self.surface.radius, strict=True)
        for k, (centre, height, radius) in enumerate(summits):
            near = [np.flatnonzero(abs(s - c) <= radius) for s, c in zip((x, y), centre, strict=True)]
            rows, columns = (slice(each[0], each[-1] + 1) for each in near)
            rho2 = (x[rows, None] - centre[0]) ** 2 + (y[None, columns] - centre[1]) ** 2
            cap = height - rho2 / (2.0 * radius)
            higher = cap > profile[rows, columns]
            profile[rows, columns][higher] = cap[higher]
            owner[rows, columns][higher] = k
        profile[~np.isfinite(profile)] = profile[np.isfinite(profile)].min()
        return profile, owner

    def moments(self, force: np.ndarray) -> float:
        """Return the sum of 5 pi sqrt(<x^2><y^2> - <xy>^2) over the contacts [mm²]."""
        i, j = np.nonzero(force > 0.0)
        k, p = self.caps[1][i, j], force[i, j]
        x, y = self.axes[0][i] - self.surface.position[k, 0], self.axes[1][j] - self.surface.position[k, 1]
        total, sx, sy, sxx, syy, sxy = (
            np.bincount(k, p * w, self.surface.count) for w in (1.0, x, y, x * x, y * y, x * y)
        )
        touching = total > 0.0
        total, sx, sy, sxx, syy, sxy = (each[touching] for each in (total, sx, sy, sxx, syy, sxy))
        xx, yy, xy = (
            s / total - a * b / total**2 for s, a, b in ((sxx, sx, sx), (syy, sy, sy), (sxy, sx, sy))
        )
        return float(5.0 * math.pi * np.sqrt(np.maximum(xx * yy - xy**2, 0.0)).sum())


def solve_with_tamaas(grid: Grid, load: float, *, tolerance: float = TAMAAS_TOLERANCE) -> Answer:
    """Answer of tamaas under a load [N], without periodic images.

    The area is that of its cells in contact, which it corrects by the length of their edges: Yastrebov,
    Anciaux, Molinari, doi:10.1016/j.jmps.2017.04.006.
    """
    import tamaas

    tamaas.set_log_level(tamaas.LogLevel.error)
    tamaas.initialize(THREADS)
    width = grid.side * grid.cell
    model = tamaas.Model(tamaas.model_type.basic_2d, [width] * 2, [grid.side] * 2)
    model.E, model.nu = grid.surface.material.composite_modulus, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tamaas.PolonskyKeerRey(model, grid.caps[0], tolerance)
    solver.setIntegralOperator("dcfft")
    seconds, _ = took(lambda: solver.solve(load / width**2))
    traction = model.traction
    touching = traction > 0.0
    edges = sum(int((each[1:] != each[:-1]).sum()) for each in (touching, touching.T))
    area = float(tamaas.Statistics2D.contact(traction, edges)) * width**2
    # the solver adds a constant to the displacement that the model holds
    displacement = np.zeros_like(traction)
    model.operators["dcfft"](traction, displacement)
    separation = float(np.median((grid.caps[0] - displacement)[touching]))
    return Answer(seconds, area, grid.moments(traction), separation)


def installed() -> bool:
    """Whether tamaas is installed here."""
    return importlib.util.find_spec("tamaas") is not None
