"""Resolved contacts: pressures on a regular grid by projected conjugate gradients and numpy's FFT.

Every cell of side h carries a constant pressure p/E*, whose displacement is Love's solution plus the regular
part of the substrate. Minimised is ``p.K p/2 + p.gap`` for ``p >= 0`` and a given total load, by the method
of Polonsky and Keer, Wear 231, 206 (1999), doi:10.1016/S0043-1648(99)00113-1. The area of a contact follows
from the load P and the second moment M of its pressure: the field of the neighbours adds a curvature, which
changes both by ``4/3 K a^3`` and ``8/15 K a^5``, so that ``M - 2/5 a^2 P`` is that of the cap alone, whose
``P = 2n/(n+1) k a^(n+1)`` and ``M = 2 (n+1)/(3 (n+3)) P a^2``. `ERROR` bounds the relative error of the areas
of laws on cells of the side `CELL`, as measured for the best results.
"""

from __future__ import annotations

import numpy as np

from validation.challenge.caps import Tool
from validation.challenge.substrate import PeriodicHalfSpace, Substrate

# Side of a cell [mm], the relative error of areas of whole laws on such cells, and the width of the grid
# beyond the outermost summits [mm].
CELL, ERROR, MARGIN = 0.0075, 1e-3, 0.7

# Relative change of the pressures at which the iteration ends, and its largest number of steps.
TOLERANCE, STEPS = 1e-7, 3000

# Newton steps for a contact radius.
STEPS_RADIUS = 8

# A contact of fewer cells has the area of its cells: it has only just begun.
FEW = 12


class Grid:
    """A grid over all summits, with the transform of its influence."""

    def __init__(self, substrate: Substrate, position: np.ndarray, cell: float = CELL) -> None:
        self.period = None
        if isinstance(substrate, PeriodicHalfSpace):
            self.period = np.array([substrate.width, substrate.length])
            shape = np.ceil(self.period / cell - 1e-9).astype(int)
            self.h = self.period[0] / shape[0]
            if abs(self.period[1] - shape[1] * self.h) > 1e-9:
                raise ValueError("the sides of the periodic cell must be multiples of the side of the cells")
            start, wide = np.zeros(2), shape
        else:
            self.h = cell
            start = position.min(axis=0) - MARGIN
            shape = 32 * np.ceil((np.ptp(position, axis=0) + 2.0 * MARGIN) / (32 * cell)).astype(int)
            wide = 2 * shape
        self.shape, self.wide = tuple(shape), tuple(wide)
        self.axes = [start[i] + self.h * (np.arange(shape[i]) + 0.5) for i in (0, 1)]
        steps = [np.minimum(np.arange(n), n - np.arange(n)) for n in wide]
        near = [np.arange(n.max() + 1) for n in steps]
        x, y = self.h * near[0][:, None], self.h * near[1][None, :]
        table = _love(x, y, self.h) + self.h**2 * substrate.regular(x, y)
        self.transform = np.fft.rfft2(table[np.ix_(*steps)])
        if self.period is not None:
            self.transform[0, 0] = 0.0  # the mean displacement is the reference

    def displacement(self, pressure: np.ndarray) -> np.ndarray:
        """Return the displacement [mm] by the pressures p/E* of all cells."""
        wave = np.fft.rfft2(pressure, s=self.wide) * self.transform
        return np.fft.irfft2(wave, s=self.wide)[: self.shape[0], : self.shape[1]]

    def offsets(self, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return x and y [mm] of the cells relative to a summit, or to its nearest period."""
        found = [axis - c for axis, c in zip(self.axes, centre, strict=True)]
        if self.period is not None:
            found = [d - side * np.round(d / side) for d, side in zip(found, self.period, strict=True)]
        return found[0][:, None], found[1][None, :]


def _love(x: np.ndarray, y: np.ndarray, h: float) -> np.ndarray:
    """Return the displacement [mm] at points by a pressure p/E* = 1 on a square of side h at the origin."""

    def corner(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return ``u log(v + r) + v log(u + r)``; for v < 0, ``v + r = u^2/(r - v)`` without cancellation."""
        r = np.hypot(u, v)
        at_u, at_v = (np.where(b > 0.0, b + r, a**2 / (r + np.abs(b))) for a, b in ((v, u), (u, v)))
        return u * np.log(at_v) + v * np.log(at_u)

    xs, ys = (x + h / 2, x - h / 2), (y + h / 2, y - h / 2)
    four = corner(xs[0], ys[0]) - corner(xs[1], ys[0]) - corner(xs[0], ys[1]) + corner(xs[1], ys[1])
    return np.asarray(four / np.pi)


def areas(
    tools: list[Tool], position: np.ndarray, height: np.ndarray, load: np.ndarray, grid: Grid
) -> np.ndarray:
    """Return the areas of all contacts (k, n) [mm^2] at loads P/E* (k,) [mm^2]."""
    surface = np.full(grid.shape, -np.inf)
    owner = np.zeros(grid.shape, dtype=int)
    for i, (tool, centre) in enumerate(zip(tools, position, strict=True)):
        own = height[i] - tool.depth(np.hypot(*grid.offsets(centre)))
        higher = own > surface
        surface[higher], owner[higher] = own[higher], i
    gap = height.max() - surface
    pressure = np.where(gap < 1e-2 * height.max(), 1.0, 0.0)
    found, each = [], list(zip(range(len(tools)), tools, position, strict=True))
    for p in load:
        pressure = _pressures(grid, gap, p / grid.h**2, pressure)
        found.append([_area(grid, tool, own, pressure * (owner == i)) for i, tool, own in each])
    return np.array(found)


def _pressures(grid: Grid, gap: np.ndarray, total: float, start: np.ndarray) -> np.ndarray:
    """Return the pressures p/E*, of a given sum over the cells."""
    p = start * (total / start.sum())
    direction, restart, before = np.zeros(grid.shape), True, 1.0
    for _ in range(STEPS):
        touching = p > 0.0
        residual = grid.displacement(p) + gap
        residual -= residual[touching].mean()
        now = float((residual[touching] ** 2).sum())
        direction = np.where(touching, residual + (0.0 if restart else now / before) * direction, 0.0)
        image = grid.displacement(direction)
        image -= image[touching].mean()
        step = float(residual[touching] @ direction[touching]) / float(image[touching] @ direction[touching])
        new = np.maximum(np.where(touching, p - step * direction, 0.0), 0.0)
        entering = (new == 0.0) & (residual < 0.0)
        restart, before = bool(entering.any()), now
        new[entering] -= step * residual[entering]
        new *= total / new.sum()
        change = float(np.abs(new - p).sum()) / total
        p = new
        if change < TOLERANCE:
            return p
    raise ArithmeticError(f"the resolved contacts did not converge in {STEPS} steps")


def _area(grid: Grid, tool: Tool, centre: np.ndarray, pressure: np.ndarray) -> float:
    """Return the area of one contact [mm^2] from the second moments of its pressure."""
    cells = int(np.count_nonzero(pressure))
    if cells < FEW:
        return cells * grid.h**2
    total = pressure.sum()
    x, y = grid.offsets(centre)
    mx, my = float((pressure * x).sum() / total), float((pressure * y).sum() / total)
    xx, yy = (float((pressure * d**2).sum() / total) for d in (x - mx, y - my))
    xy = float((pressure * (x - mx) * (y - my)).sum() / total)
    load, square = total * grid.h**2, 2.0 * float(np.sqrt(max(xx * yy - xy**2, 0.0)))  # M/P
    n, m = tool.exponent, tool.moment
    per_power = 2.0 * n / (n + 1.0) * tool.factor / load
    a = np.sqrt(square / m)
    for _ in range(STEPS_RADIUS):
        value = (m - 0.4) * per_power * a ** (n + 3.0) + 0.4 * a**2 - square
        a -= value / ((n + 3.0) * (m - 0.4) * per_power * a ** (n + 2.0) + 0.8 * a)
    return float(np.pi * a**2)
