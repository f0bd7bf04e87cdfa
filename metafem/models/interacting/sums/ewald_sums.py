"""Sums over scattered positions: near pairs are summed directly, the smooth remainder on a grid.

Ewald's splitting is ``1/r = (1/r - S(r)) + S(r)``, where the smooth part S is the potential of a smooth cloud
of charge and equals 1/r outside it. The first part is summed over near pairs. The second part and the regular
part of the substrate contain only waves that a grid resolves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from metafem._kernels.layer import WIDTH, regular, tabulated
from metafem._kernels.sums import near
from metafem._validate import FloatArray
from metafem.models._resources import run_rows
from metafem.models.interacting.sums.smooth_field import (
    BAND,
    POSITIONS_PER_THREAD,
    SmoothField,
    quadrature,
    window,
)
from metafem.substrate import Radial

# Pieces of the table of the split influence, and its end. On pieces of 1/32 of the reach, polynomials of
# degree 9 represent wavenumbers up to 30 over the reach with an error of 1e-13.
PIECES = 32
END = PIECES * WIDTH


@dataclass(frozen=True)
class Accuracy:
    """Parameters of the sums that set their error and their cost."""

    reach: float  # largest distance of near pairs, divided by the mean spacing of the positions
    split: float  # shape of the splitting window: the field's transform ends at split/reach
    points: int  # number of grid points of the spreading window
    shape: float  # of the spreading window
    layer_reach: float  # distance, in layer thicknesses, beyond which the influence of a layer is neglected
    layer_steps: float  # minimum number of grid steps per layer thickness
    real: Any  # type of the numbers on the grid


# Errors of 1e-11 of G and of 1e-10 of its derivatives, relative to the largest values of each. The field's
# components at the end of the band are exp(-24) of the longest one. Beyond 35 thicknesses the influence of a
# layer is below 2e-11 of that of a half-space for any Poisson's ratio. The Fourier components of its regular
# part decrease as k t exp(-2 k t), to 1e-12 with 7 steps. With this reach pairs and grid take about the same
# time.
FINE = Accuracy(5.0, 24.0, 12, 2.45 * 12, 35.0, 7.0, np.float64)

# Errors of 1e-5 of G, for the linear equations of Newton's method.
ROUGH = Accuracy(3.0, 11.0, 6, 2.45 * 6, 16.0, 3.5, np.float32)

# Only pairs are summed if the reach of a layer is at most this multiple of the largest distance of near
# pairs.
# A grid that is fine enough for such a thin layer would take more time.
FARTHEST = 4.0

# Number of cells along the largest distance of near pairs. More cells exclude more of the farther pairs, and
# take more time each.
CELLS = 2

# Number of rows that are summed exactly to check the sums.
SAMPLE = 64

# Number of pairs that are summed exactly above which a second thread saves time: about a millisecond.
PAIRS_PER_THREAD = 100_000


class ScatteredSums:
    """Products with the influence matrix and its derivatives, for any positions, by Ewald's method."""

    @property
    def self_influence(self) -> float:
        """Regular self term of a site [1/mm]."""
        return self.substrate.self_influence

    def __init__(self, position: FloatArray, substrate: Radial, accuracy: Accuracy = FINE) -> None:
        self.substrate, self.accuracy = substrate, accuracy
        self._products = 0
        low = position.min(axis=0)
        extent = position.max(axis=0) - low
        spacing = math.sqrt(float(np.prod(np.maximum(extent, extent.max() / len(position)))) / len(position))
        self.reach = accuracy.reach * spacing
        thickness = getattr(substrate, "thickness", math.inf)
        far = accuracy.layer_reach * thickness
        step = min(BAND * math.pi * self.reach / accuracy.split, thickness / accuracy.layer_steps)
        self._pairs_alone = far <= FARTHEST * self.reach
        self.reach = far if self._pairs_alone else self.reach
        self._position = position
        self._cell = max(self.reach / CELLS, spacing)
        cell = np.floor((position - low)[:, ::-1] / self._cell).astype(np.int64)
        self._cells = int(cell[:, 0].max()) + 1, int(cell[:, 1].max()) + 1
        cell = cell @ np.array([self._cells[1], 1])
        self._order = np.argsort(cell, kind="stable")
        self._start = np.searchsorted(cell[self._order], np.arange(math.prod(self._cells) + 1))
        self._sorted = np.ascontiguousarray((position - low)[self._order, ::-1])
        self._grid = SmoothField(
            self._sorted, step, far, accuracy.points, accuracy.shape, accuracy.real, self._smooth_influence
        )

    @property
    def products(self) -> int:
        """Number of sources that were summed until now."""
        return self._products + (self.rough.products if "rough" in self.__dict__ else 0)

    @cached_property
    def rough(self) -> ScatteredSums:
        """Sums with an error of about 1e-5 that take less time."""
        return ScatteredSums(self._position, self.substrate, ROUGH)

    @property
    def note(self) -> str:
        """Text of the note that describes the sums."""
        if self._pairs_alone:
            return (
                f"{len(self._position)} scattered positions: pairs beyond {self.reach:.3g} mm were left out, "
                "where the layer is below 2e-11 of a half-space"
            )
        return (
            f"{len(self._position)} scattered positions: pairs nearer than {self.reach:.3g} mm were summed "
            f"directly, the rest on a grid; {SAMPLE} rows were checked exactly"
        )

    @property
    def cells(self) -> int:
        """Number of cells of the padded grid."""
        return 0 if self._pairs_alone else math.prod(self._grid.padded)

    def error(self, load: FloatArray) -> float:
        """Return the largest error [mm] of G p at a sample of the loaded positions."""
        loaded = np.flatnonzero(load)
        rows = loaded[:: max(1, len(loaded) // SAMPLE)]
        position, carried = self._position[loaded], load[loaded]
        exact = np.empty(len(rows))

        def run(part: slice) -> None:
            for k in range(part.start, part.stop):
                dx, dy = (position - self._position[rows[k]]).T
                r = np.sqrt(dx * dx + dy * dy)
                other = r > 0.0
                exact[k] = self.substrate.influence(r[other]) @ carried[other]

        run_rows(run, len(rows), len(rows) * len(loaded), PAIRS_PER_THREAD)
        return float(np.abs(exact - self.displacement(load)[rows]).max(initial=0.0))

    def displacement(
        self, load: FloatArray, size: FloatArray | None = None, *moment: FloatArray
    ) -> FloatArray:
        """Return G p, (n,) [mm]; with sizes v and moments w of the sources, return G p + lap v + grad . w.

        load: p; size: v; moment: the two components of w. lap and grad are derivatives of G at the source.
        """
        p = load[self._order]
        total = -self._self_terms[0] * p
        self._near(near.displacements, p, total)
        sources = [p]
        if size is not None:
            x, y = moment
            v = np.stack([size[self._order], y[self._order], x[self._order]])
            total -= self._self_terms[1] * v[0]
            self._near(near.moments, v, total)
            sources += [*v]
        self._smooth(sources, [list(range(len(sources)))], total[None, :])
        return self._in_order(total)

    def field(self, load: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the Laplacian and the two slopes of G p at the asperities, (n,) each."""
        p = load[self._order]
        total = np.zeros((3, len(p)))
        total[0] = -self._self_terms[1] * p
        self._near(near.fields, p, total)
        # the derivative at the source is the opposite of that at the displaced end
        total[1:] *= -1.0
        self._smooth([p], [[1], [2], [3]], total)
        laplacian, y, x = (self._in_order(part) for part in total)
        return laplacian, -x, -y

    def _in_order(self, part: FloatArray) -> FloatArray:
        """Return values (n,) in the order of the given positions."""
        result = np.empty_like(part)
        result[self._order] = part
        return result

    def _near(self, kernel: Callable[..., None], source: FloatArray, total: FloatArray) -> None:
        """Add the sums over near pairs of the sources (..., n) to `total`."""
        loaded = np.flatnonzero(np.atleast_2d(source).any(axis=0))
        start = np.searchsorted(loaded, self._start)
        most = min(len(loaded), int(np.diff(start).max()) * (2 * CELLS + 2) ** 2) + 1
        cells = near.Cells(self._sorted[loaded], start, *self._cells, self._cell, self.reach, most)
        kept = np.ascontiguousarray(source[..., loaded])
        scale, table = self._table
        result = np.empty_like(total)

        def run(rows: slice) -> None:
            kernel(self._sorted, cells, kept, scale, table, rows.start, rows.stop, result)

        run_rows(run, len(self._sorted), len(self._sorted), POSITIONS_PER_THREAD)
        total += result

    def _smooth(self, sources: list[FloatArray], terms: list[list[int]], total: FloatArray) -> None:
        """Add the smooth fields of the sources (n,) to `total` (m, n); see `SmoothField.add`."""
        self._products += len(sources)
        if not self._pairs_alone:
            self._grid.add(sources, terms, total)

    def _smooth_influence(self, y: FloatArray, x: FloatArray) -> FloatArray:
        """Return the smooth part of G [1/mm] at distances of a grid [mm]."""
        field = np.empty((y.size, x.size))
        near.fill_smooth(y, x, *self._table, field)
        return np.asarray(field + self.substrate.regular(np.hypot(y[:, None], x)))

    @cached_property
    def _self_terms(self) -> tuple[float, float]:
        """Smooth parts of G and its Laplacian at the source, to be subtracted; self_curvature is retained."""
        if self._pairs_alone:
            return 0.0, -2.0 * self.substrate.self_curvature
        scale, table = self._table
        value, _, second = regular(0.0, table)
        constant = self.substrate.self_influence - value / (math.pi * scale)
        return constant, -2.0 * second / (math.pi * scale**3)

    @cached_property
    def _table(self) -> tuple[float, FloatArray]:
        """Scale [mm] and table of the influence of near pairs; see `metafem._kernels.sums.near`."""
        if not self._pairs_alone:
            return self.reach / END, split_table(self.accuracy.split)
        t = self.reach / self.accuracy.layer_reach

        def layer(s: FloatArray) -> tuple[FloatArray, ...]:
            parts = self.substrate.regular_derivatives(t * s)
            return tuple(math.pi * t**power * part for power, part in enumerate(parts, start=1))

        return t, tabulated(layer, self.accuracy.layer_reach)


def split_table(shape: float) -> FloatArray:
    """Return the table of `metafem._kernels.layer` for minus the smooth part of 1/s, up to END.

    The smooth part is ``S(s) = W(x)/s`` with ``x = s/END`` and the integral W of the window from 0 to x,
    divided by the integral to 1. It equals 1/s at the END. In space it is the potential of a cloud of charge
    within this radius, and its transform decreases like that of the window.
    """
    node, weight = quadrature()
    weight = weight / float(weight @ window(node, shape))

    def smooth(s: FloatArray) -> tuple[FloatArray, ...]:
        x = s / END
        u = np.outer(x, node)
        bell, root = window(u, shape), np.sqrt(1.0 - u**2)
        first = -shape * u / root * bell
        second = ((shape * u / root) ** 2 - shape / root**3) * bell
        value = bell @ weight, first @ (node * weight), second @ (node**2 * weight)
        return tuple(-part / END**power for power, part in enumerate(value, start=1))

    return tabulated(smooth, END)
