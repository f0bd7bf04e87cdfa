"""Load equation of asperities that do not interact, for any contact law without adhesion.

``P/E* = sum P(d_i)/E*`` with ``d_i = x - gap_i`` at the approach x, where gap_i is the depth of summit i
below the tallest. Loads are rescaled, P/E* [mm^2].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, cast

import numpy as np

from metafem._kernels import independent as kernel
from metafem._kernels.law import Law
from metafem._kernels.newton import TOLERANCE
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.models._resources import run_rows
from metafem.models.contact_tables import refuse_beyond, rows_of, tables
from metafem.models.curve import Curve, RescaledState, Sensitivity, refuse_unloading, solved
from metafem.surface import Surface


@dataclass(frozen=True)
class LoadEquation:
    """Load equation for any law without adhesion; compiled kernels read the law from tables."""

    model: object  # to which the states refer
    law: Contact  # for unit E*
    surface: Surface | None = None  # which `path` and `areas` need, and whose summits are the default radii

    def path(self, values: FloatArray, by_load: bool, unloading: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,)."""
        refuse_unloading(self.law, unloading)
        height = cast("Surface", self.surface).height
        return self.curve(height, values) if by_load else self.at_approach(height, values)

    def curve(self, height: FloatArray, load: FloatArray, radius: Any = None) -> Curve:
        """Return equilibria at increasing loads (k,) for heights and radii (n,)."""
        radius = self.summits(radius)
        results, (base,), (depth,) = self._solved(height[None, :], load, radius)
        approach, carried, area, slope = (part[0] for part in results)
        last = partial(self._last, height, radius, base, depth)
        return Curve(approach, carried, area, slope, _error(carried, load), TOLERANCE, last)

    def summits(self, radius: Any) -> Any:
        """Return the given radii [mm], or what the law takes as the radii of the surface."""
        return self.law.summits(cast("Surface", self.surface)) if radius is None else radius

    def at_approach(self, height: FloatArray, approach: FloatArray) -> Curve:
        """Return equilibria at approaches (k,) for heights (n,)."""
        radius = self.summits(None)
        gap, table = self._sorted(height[None, :], radius)
        refuse_beyond(table, approach[-1] - gap, self.law)
        x = np.array(approach)  # a read-only array would compile the kernel again
        load, area, slope, residual = (np.zeros(len(x)) for _ in range(4))
        kernel.curve_at_approach(rows_of(table, 0), gap[0], x, load, area, slope)
        last = partial(self._last, height, radius, 0.0, x[-1])
        return Curve(x, load, area, slope, residual, TOLERANCE, last)

    def areas(self, height: FloatArray, radius: FloatArray | None, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) for heights and radii (m, n); see `Model.areas`."""
        summits = self.law.summits(cast("Surface", self.surface), radius)
        (_, carried, area, _), _, _ = self._solved(height, load, summits)
        return np.where(solved(_error(carried, load), TOLERANCE, carried, area), area, np.nan)

    def sensitivity(self, height: FloatArray, load: FloatArray, radius: Any = None) -> Sensitivity:
        """Return the law at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n).

        ``dA0/dh_i = A'_i - P'_i sum_j A'_j / sum_j P'_j`` for asperities in contact, where A' and P' are
        derivatives with respect to the indentation. For Hertz contacts this is
        ``pi R_i - sum_j pi R_j sqrt(R_i d_i) / sum_j sqrt(R_j d_j)``.
        """
        radius = self.summits(radius)
        curve = self.curve(height, load, radius)
        indentation = curve.approach[:, None] - (height.max() - height)

        def gradient() -> FloatArray:
            _, stiffness, _, area_rate = self.rates(indentation, radius)
            total = stiffness.sum(axis=1, keepdims=True)
            share = stiffness / np.where(total > 0.0, total, 1.0)
            return np.asarray(area_rate - area_rate.sum(axis=1, keepdims=True) * share)

        return Sensitivity(curve, gradient, indentation)

    def rates(self, indentation: FloatArray, radius: FloatArray) -> tuple[FloatArray, ...]:
        """Return loads [mm^2], dP/dd [mm], areas [mm^2] and dA/dd [mm] of contacts (k, n)."""
        table = tables(self.law, np.broadcast_to(radius, indentation.shape[1:]))
        refuse_beyond(table, indentation.max(axis=0), self.law)
        results = tuple(np.empty_like(indentation) for _ in range(4))
        kernel.rates(table, indentation, *results)
        return results

    def _solved(
        self, height: FloatArray, load: FloatArray, radius: FloatArray
    ) -> tuple[tuple[FloatArray, ...], FloatArray, FloatArray]:
        """Return approach, load, area and stiffness (m, k) of surfaces (m, n) at increasing loads (k,).

        Also return the last approaches (m,) as gap and indentation of a contact.
        """
        gap, table = self._sorted(height, radius)
        rising = np.array(load)
        results = tuple(np.empty((len(gap), len(load))) for _ in range(4))
        base, depth = np.empty(len(gap)), np.empty(len(gap))

        def run(rows: slice) -> None:
            last, depth[rows] = kernel.curves(
                rows_of(table, rows), gap[rows], rising, *(part[rows] for part in results)
            )
            base[rows] = np.take_along_axis(gap[rows], last[:, None], 1)[:, 0]

        # fewer than 2000 equilibria take less time than starting a second thread
        run_rows(run, len(gap), results[0].size, 2_000)
        refuse_beyond(table, results[0][:, -1:] - gap, self.law)
        return results, base, depth

    def _sorted(self, height: FloatArray, radius: FloatArray) -> tuple[FloatArray, Law]:
        """Return depths below the tallest summit, (m, n), each row sorted, and the laws in the same order."""
        gap = height.max(axis=1, keepdims=True) - height
        table = tables(self.law, np.broadcast_to(radius, height.shape))
        if (table.radius == table.radius.flat[0]).all() and (table.which == table.which.flat[0]).all():
            gap.sort(axis=1)
            return gap, table
        order = np.argsort(gap, axis=1, kind="stable")
        gap, radius, which, scale = (np.take_along_axis(part, order, 1) for part in (gap, *table[:3]))
        return gap, Law(radius, which, scale, table.data)

    def _last(self, height: FloatArray, radius: FloatArray, base: float, depth: float) -> RescaledState:
        """Return the state at the approach base + depth; their sum would lose digits of shallow contacts."""
        top = float(height.max())
        indentation = depth + (base - (top - height))
        load, _, area, _ = self.rates(indentation[None, :], radius)
        return RescaledState(load[0], area[0], indentation, top - (base + depth), self.model)


def _error(carried: FloatArray, load: FloatArray) -> FloatArray:
    """Return the relative errors of the loads `carried`; at zero load, the absolute errors."""
    return np.asarray(np.abs(carried - load) / np.where(load > 0.0, load, 1.0))
