"""Load equation of asperities that do not interact, for any contact law without adhesion.

``P/E* = sum P(d_i)/E*`` with ``d_i = x - gap_i`` at the approach x, where gap_i is the depth of summit i
below the tallest. Loads are rescaled, P/E* [mm^2].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import elementwise

from metafem._kernels import independent as kernel
from metafem._kernels.contact import independent as tabulated
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import contacts, sizes_of
from metafem.errors import InvalidInput
from metafem.models._resources import run_rows
from metafem.models.contact_tables import deepest, rows_of, tables
from metafem.models.curve import Curve, RescaledState, Sensitivity, refuse_unloading, solved
from metafem.surface import Surface

# Largest relative error of the load. To avoid cancellation, the kernels solve for the indentation of the
# shallowest contact.
TOLERANCE = 1e-12

# With fewer equilibria than this, the solution takes less time than starting a second thread.
POINTS_PER_THREAD = 20_000

# The same number for tabulated laws; this many equilibria take two milliseconds.
TABULATED_PER_THREAD = 200

# The same number if only the areas of Hertz contacts are computed; this many take a millisecond.
AREAS_PER_THREAD = 5_000


@dataclass(frozen=True)
class LoadEquation:
    """Load equation for any law without adhesion; compiled kernels read the law from tables."""

    model: object  # to which the states refer
    law: Contact  # for unit E*

    def path(self, surface: Surface, values: FloatArray, by_load: bool, unloading: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,)."""
        refuse_unloading(self.law, unloading)
        height, radius = surface.height, self.law.summits(surface)
        return (self.curve if by_load else self.at_approach)(height, radius, values)

    def curve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        """Return equilibria at increasing loads (k,) for heights and radii (n,)."""
        results = self.solve(height[None, :], radius, load)
        return self._curve(height, radius, load, results, 0.0, results[0][0, -1])

    def at_approach(self, height: FloatArray, radius: FloatArray, approach: FloatArray) -> Curve:
        """Return equilibria at approaches (k,) for heights and radii (n,)."""
        load, area, slope = self._sums(height, radius, approach)
        last = partial(self._last, height, radius, 0.0, approach[-1])
        return Curve(np.array(approach), load, area, slope, np.zeros(len(approach)), TOLERANCE, last)

    def solve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) of surfaces (m, n) at increasing loads (k,)."""
        gap = height.max(axis=1, keepdims=True) - height
        table = tables(self.law, np.broadcast_to(radius, gap.shape))
        results = kernel.empty_results(len(gap), len(load))
        rising = np.array(load)  # a read-only array would compile the kernel again

        def run(rows: slice) -> None:
            tabulated.curves(rows_of(table, rows), gap[rows], rising, *(part[rows] for part in results))

        run_rows(run, len(gap), results[0].size, TABULATED_PER_THREAD)
        # surfaces with contacts beyond the tables are solved with the law itself, which may raise an error
        beyond = ~(results[0].max(axis=1, keepdims=True) - gap <= deepest(table)).all(axis=1)
        for row in np.flatnonzero(beyond):
            size = table.radius[row]
            approach = approach_at_load(self.law, gap[row], size, load)
            found = (approach, *self._sums(height[row], size, approach))
            for part, values in zip(results, found, strict=True):
                part[row] = values
        return results

    def areas(self, surface: Surface, height: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) of surfaces (m, n) at loads (k,); see `Model.areas`."""
        _, carried, area, _ = self.solve(height, radius, load)
        return np.where(solved(_error(carried, load), TOLERANCE, carried, area), area, np.nan)

    def sensitivity(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the law at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        curve = self.curve(height, radius, load)
        indentation = curve.approach[:, None] - (height.max() - height)

        def gradient() -> FloatArray:
            _, stiffness, _, area_rate = self.rates(indentation, radius)
            return at_fixed_load(stiffness, area_rate)

        return Sensitivity(curve, gradient, indentation)

    def contacts(
        self, height: FloatArray, radius: FloatArray, load: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return contact radii and indentations (k, n) [mm] at increasing loads (k,).

        An open asperity has the radius 0, and minus its gap as indentation.
        """
        indentation = self.curve(height, radius, load).approach[:, None] - (height.max() - height)
        return np.asarray(self.law.contact_radius(indentation, radius)), indentation

    def _curve(
        self,
        height: FloatArray,
        radius: FloatArray,
        load: FloatArray,
        results: tuple[FloatArray, ...],
        base: float,
        depth: float,
    ) -> Curve:
        """Return the curve of the first surface in `results`; its last approach is base + depth."""
        approach, carried, area, slope = (part[0] for part in results)
        last = partial(self._last, height, radius, base, depth)
        return Curve(approach, carried, area, slope, _error(carried, load), TOLERANCE, last)

    def _sums(self, height: FloatArray, radius: FloatArray, approach: FloatArray) -> tuple[FloatArray, ...]:
        """Return load [mm^2], area [mm^2] and stiffness [mm] at approaches (k,) [mm]."""
        return _sums(self.law, height.max() - height, radius, approach)

    def _last(self, height: FloatArray, radius: FloatArray, base: float, depth: float) -> RescaledState:
        """Return the state at the approach base + depth.

        The approach is split to avoid cancellation in the indentations of shallow contacts.
        """
        top = float(height.max())
        indentation = depth + (base - (top - height))
        carried, area = self._pressed(indentation, radius)
        return RescaledState(carried, area, indentation, top - (base + depth), self.model)

    def _pressed(self, indentation: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return loads [mm^2] and areas [mm^2] of contacts at indentations (n,) [mm]."""
        carried, area, *_ = contacts(self.law, indentation, radius)
        return carried, area

    def rates(self, indentation: FloatArray, radius: FloatArray) -> tuple[FloatArray, ...]:
        """Return loads [mm^2], dP/dd [mm], areas [mm^2] and dA/dd [mm] of contacts (k, n)."""
        size = np.broadcast_to(radius, indentation.shape[1:])
        table = tables(self.law, size)
        if (indentation > deepest(table)).any():
            found = contacts(self.law, indentation, size)
            return found.load, found.stiffness, found.area, self.law.area_slope(found.contact_radius, size)
        load, stiffness, area, area_slope = (np.empty_like(indentation) for _ in range(4))
        tabulated.each(table, indentation, load, stiffness, area, area_slope)
        return load, stiffness, area, area_slope


class Paraboloids(LoadEquation):
    """Load equation for Hertz's law, with kernels of its own."""

    def curve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        """Return equilibria at increasing loads (k,) for heights and radii (n,)."""
        gap, root = _sorted_by_gap(height[None, :], radius)
        results = kernel.empty_results(1, len(load))
        # a read-only array would compile the kernel again
        kernel.curves(gap, root, np.array(load), *results)
        base, depth = kernel.refine(gap[0], root[0], load[-1], results[0][0, -1])
        return self._curve(height, radius, load, results, base, depth)

    def solve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) of surfaces (m, n) at increasing loads (k,)."""
        gap, root = _sorted_by_gap(height, radius)
        results = kernel.empty_results(len(gap), len(load))

        def run(rows: slice) -> None:
            kernel.curves(gap[rows], root[rows], load, *(part[rows] for part in results))

        run_rows(run, len(gap), results[0].size, POINTS_PER_THREAD)
        return results

    def areas(self, surface: Surface, height: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) of surfaces (m, n) at loads (k,); see `Model.areas`."""
        gap, root = _sorted_by_gap(height, radius)
        area, load = np.empty((len(gap), len(load))), np.array(load)

        def run(rows: slice) -> None:
            kernel.areas(gap[rows], root[rows], load, area[rows])

        run_rows(run, len(gap), area.size, AREAS_PER_THREAD)
        return area

    def _sums(self, height: FloatArray, radius: FloatArray, approach: FloatArray) -> tuple[FloatArray, ...]:
        gap, root = _sorted_by_gap(height[None, :], radius)
        results = tuple(np.empty(len(approach)) for _ in range(3))
        kernel.curve_at_approach(gap[0], root[0], np.array(approach), *results)
        return results

    def _pressed(self, indentation: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        contact_radius = PARABOLOID.contact_radius(indentation, radius)  # closed form, exact to rounding
        return PARABOLOID.load(contact_radius, radius), PARABOLOID.area(contact_radius)

    def rates(self, indentation: FloatArray, radius: FloatArray) -> tuple[FloatArray, ...]:
        """Return loads [mm^2], dP/dd [mm], areas [mm^2] and dA/dd [mm] of contacts (k, n)."""
        d = np.maximum(indentation, 0.0)
        a = np.sqrt(radius * d)
        each = math.pi * radius
        return 4.0 / 3.0 * a * d, 2.0 * a, each * d, each * (indentation > 0.0)


def at_fixed_load(stiffness: FloatArray, area_rate: FloatArray) -> FloatArray:
    """Return dA0/dh at fixed load [mm], (k, n): ``A'_i - P'_i sum_j A'_j / sum_j P'_j``.

    P', A': derivatives of load and area with respect to the indentation, (k, n); 0 for open asperities.
    """
    total = stiffness.sum(axis=1, keepdims=True)
    share = stiffness / np.where(total > 0.0, total, 1.0)
    return np.asarray(area_rate - area_rate.sum(axis=1, keepdims=True) * share)


# a law that cannot carry the load leads to an infinite approach, and the residual shows it
@np.errstate(over="ignore", invalid="ignore")
def approach_at_load(law: Contact, gap: FloatArray, radius: FloatArray, load: FloatArray) -> FloatArray:
    """Return the approaches (k,) [mm] of one surface at loads (k,), for any law without adhesion.

    gap, radius: (n,) [mm]. Raises InvalidInput if a load exceeds the range of the law.
    """
    most = float((gap + law.largest_indentation(radius)).min())

    def excess(approach: FloatArray, load: FloatArray) -> FloatArray:
        return _sums(law, gap, radius, approach)[0] - load

    # first guess: about the indentation of the tallest asperity if it carries the load by itself
    high = np.minimum(np.cbrt(load**2 / sizes_of(radius)[gap.argmin()]), most)
    while (short := excess(high, load) < 0.0).any():
        if high[short].max() >= most:
            raise InvalidInput(
                f"the load {load[short].max():.4g} mm^2 needs an approach beyond {most:.4g} mm, up to which "
                f"{law!r} describes all contacts; use lighter loads or a law with a larger range"
            )
        high = np.where(short, np.minimum(2.0 * high, most), high)
    return np.asarray(elementwise.find_root(excess, (np.zeros(len(load)), high), args=(load,)).x)


def _sums(law: Contact, gap: FloatArray, radius: FloatArray, approach: FloatArray) -> tuple[FloatArray, ...]:
    """Return load [mm^2], area [mm^2] and stiffness [mm] of a surface at approaches (k,) [mm]."""
    found = contacts(law, approach[:, None] - gap, radius)
    return found.load.sum(axis=1), found.area.sum(axis=1), found.stiffness.sum(axis=1)


def _error(carried: FloatArray, load: FloatArray) -> FloatArray:
    """Return the relative errors of the loads `carried`; at zero load, the absolute errors."""
    return np.asarray(np.abs(carried - load) / np.where(load > 0.0, load, 1.0))


def _sorted_by_gap(height: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return depths below the tallest summit and square roots of radii, (m, n), each row sorted by depth."""
    gap = height.max(axis=1, keepdims=True) - height
    if radius.ndim == 0 or (radius == radius.flat[0]).all():
        gap.sort(axis=1)
        return gap, np.full_like(gap, math.sqrt(radius.flat[0]))
    order = np.argsort(gap, axis=1, kind="stable")
    root = np.sqrt(np.broadcast_to(radius, gap.shape))
    return np.take_along_axis(gap, order, 1), np.take_along_axis(root, order, 1)
