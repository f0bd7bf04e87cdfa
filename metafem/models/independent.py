"""Independent asperities: contacts without interaction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._kernels import independent as kernel
from metafem._kernels.contact import independent as tabulated
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput
from metafem.models._resources import run_rows
from metafem.models.adhesion.curves import (
    adhesive_law,
    curve_of_heights,
    independent_areas,
    independent_curve,
    independent_sensitivity,
    refuse_merging,
)
from metafem.models.contact_sums import approach_at_load, contacts, sums
from metafem.models.contact_tables import deepest, rows_of, tables
from metafem.models.curve import Curve, RescaledState, Sensitivity, controlled, refuse_flattening, solved
from metafem.models.model import Uncoupled
from metafem.surface import Surface

# Relative error of the load. The unknown is the indentation of the shallowest contact, to keep its digits.
TOLERANCE = 1e-12

# With fewer points than this the solution takes less time than the start of a second thread.
POINTS_PER_THREAD = 20_000

# The same for laws of tables: two milliseconds.
TABULATED_PER_THREAD = 200

# The same where only areas of Hertz contacts are computed: a millisecond.
AREAS_PER_THREAD = 5_000


@dataclass(frozen=True)
class Independent(Uncoupled):
    """Independent asperities under a common plane.

    ``A0 = sum A(d_i)`` and ``P/E* = sum P(d_i)/E*`` with ``d_i = max(h_i - delta, 0)``; for Hertz contacts
    ``A0 = sum pi R_i d_i`` and ``P/E* = sum 4/3 sqrt(R_i) d_i^(3/2)``. The load equation is increasing in the
    approach; it is solved by Newton's method inside a bracket in compiled kernels, which read laws other than
    Hertz's from tables.
    Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242.

    Parameters
    ----------
    contact : Contact
        Law of one contact: `Hertz()`, the default, `SphericalCap()`, `PowerCap(...)`, or any object with the
        methods of `metafem.contact.Contact` whose load increases with the indentation.

    Raises
    ------
    InvalidInput
        If `contact` is not a contact law.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (1, 1), radius=0.526, material=Material(1.36))
    >>> round(equilibrium(surface, Independent(), load=0.01).approach, 6)
    0.038668
    >>> from metafem import PowerCap
    >>> round(equilibrium(surface, Independent(PowerCap(4)), load=0.01).approach, 6)
    0.021002
    """

    unloads: ClassVar[bool] = True

    contact: Contact = PARABOLOID

    def __post_init__(self) -> None:
        laws = "a contact law such as metafem.Hertz() or metafem.PowerCap(4)"
        check.instance("contact", self.contact, Contact, laws)

    def __repr__(self) -> str:
        """Return the constructor's call, without the default law."""
        return f"{type(self).__name__}({'' if self._hertz else f'contact={self.contact!r}'})"

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``, with a law other than Hertz's."""
        return "independent" if self._hertz else f"independent, {self.contact!r}"

    @property
    def _hertz(self) -> bool:
        """Whether the contacts are Hertz's, which have a kernel of their own."""
        return self.contact == PARABOLOID

    def curve(
        self,
        surface: Surface,
        load: FloatArray | None = None,
        *,
        approach: FloatArray | None = None,
        unloading: bool = False,
    ) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2] or approaches [mm], (k,).

        unloading: at these on the way back from the largest; loads of adhesive contacts may be negative.
        """
        values, by_load = controlled(load, approach)
        law = self.contact.for_material(surface.material)
        adhesive = adhesive_law(law)
        if adhesive is not None:
            return independent_curve(self, adhesive, surface, values, by_load, unloading)
        refuse_flattening(law, unloading)
        if by_load:
            return self.curve_of(surface.height, surface.radius, values, law)
        last = partial(self._last, law, surface.height, surface.radius, 0.0, values[-1])
        if law != PARABOLOID:
            carried, area, slope = sums(law, surface.gap, surface.radius, values)
            return Curve(np.array(values), carried, area, slope, np.zeros(len(values)), TOLERANCE, last)
        gap, root = _sorted_by_gap(surface.height[None, :], surface.radius)
        carried, area, slope = (np.empty(len(values)) for _ in range(3))
        kernel.curve_at_approach(gap[0], root[0], values, carried, area, slope)
        return Curve(np.array(values), carried, area, slope, np.zeros(len(values)), TOLERANCE, last)

    def curve_of(
        self, height: FloatArray, radius: FloatArray, load: FloatArray, contact: Contact | None = None
    ) -> Curve:
        """As `curve` at loads, for heights and radii (n,) without a surface, which takes as long to check.

        contact: the contact law for unit E*; default: that of the model.
        """
        law = self.contact if contact is None else contact
        adhesive = adhesive_law(law)
        if adhesive is not None:
            return curve_of_heights(self, adhesive, height, radius, load)
        if law != PARABOLOID:
            results = _solved(law, height[None, :], radius, load)
            approach, carried, area, slope = (part[0] for part in results)
            error = np.abs(carried - load) / np.where(load > 0.0, load, 1.0)
            last = partial(self._last, law, height, radius, 0.0, approach[-1])
            return Curve(approach, carried, area, slope, error, TOLERANCE, last)
        gap, root = _sorted_by_gap(height[None, :], radius)
        results = kernel.empty_results(1, len(load))
        # a read-only array would compile the kernel again
        kernel.curves(gap, root, np.array(load), *results)
        approach, carried, area, slope = (part[0] for part in results)
        error = np.abs(carried - load) / np.where(load > 0.0, load, 1.0)
        base, depth = kernel.refine(gap[0], root[0], load[-1], approach[-1])
        last = partial(self._last, law, height, radius, base, depth)
        return Curve(approach, carried, area, slope, error, TOLERANCE, last)

    def _last(
        self, law: Contact, height: FloatArray, radius: FloatArray, base: float, depth: float
    ) -> RescaledState:
        """Return the state at the approach base + depth, whose parts keep the digits of shallow contacts."""
        top = float(height.max())
        indentation = depth + (base - (top - height))
        if law == PARABOLOID:  # the closed form in d loses no digits
            contact_radius = PARABOLOID.contact_radius(indentation, radius)
            carried, area = PARABOLOID.load(contact_radius, radius), PARABOLOID.area(contact_radius)
        else:
            carried, area, *_ = contacts(law, indentation, radius)
        return RescaledState(carried, area, indentation, top - (base + depth), self)

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads (k,), and dA0/dh of each height at fixed load [mm], (k, n).

        ``A'_i - P'_i sum_j A'_j / sum_j P'_j`` with the derivatives by the indentation, for asperities in
        contact; with Hertz contacts ``pi R_i - sum_j pi R_j sqrt(R_i d_i) / sum_j sqrt(R_j d_j)``.
        height: summit heights (n,) [mm] in place of the surface's own; they are not checked.
        """
        law = self.contact.for_material(surface.material)
        return self.sensitivity_of(surface.height if height is None else height, surface.radius, load, law)

    def sensitivity_of(
        self, height: FloatArray, radius: FloatArray, load: FloatArray, contact: Contact | None = None
    ) -> Sensitivity:
        """As `sensitivity`, for heights and radii (n,) without a surface.

        contact: the contact law for unit E*; default: that of the model.
        """
        law = self.contact if contact is None else contact
        adhesive = adhesive_law(law)
        if adhesive is not None:
            return independent_sensitivity(self, adhesive, height, radius, load)
        curve = self.curve_of(height, radius, load, law)
        indentation = curve.approach[:, None] - (height.max() - height)
        return Sensitivity(curve, partial(_gradient, law, indentation, radius), indentation)

    def curves(
        self, height: ArrayLike, radius: ArrayLike, rescaled_load: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Friction laws of many surfaces at once, for Hertz contacts through one compiled kernel.

        Parameters
        ----------
        height : array_like, (m, n) or (n,)
            Lists of summit heights [mm].
        radius : float or array_like, (n,) or (m, n)
            Summit radii [mm].
        rescaled_load : array_like, (k,)
            Loads P/E* [mm^2], not negative, in any order.

        Returns
        -------
        approach, load, area, stiffness : ndarray, (m, k)
            Approach [mm], load recomputed at it [mm^2], real contact area [mm^2] and derivative of
            the rescaled load by the approach [mm].

        Examples
        --------
        >>> approach, load, area, stiffness = Independent().curves([[0.1], [0.2]], 0.5, [0.01, 0.02])
        >>> area.shape, bool((area[0] == area[1]).all())
        ((2, 2), True)
        """
        heights = check.lists("height", height, None)
        radii = check.lists("radius", radius, None).reshape(np.shape(radius))
        if radii.shape not in ((), heights.shape[1:], heights.shape):
            raise InvalidInput(
                f"radius has shape {radii.shape}; it must be one number or have shape "
                f"{heights.shape[1:]} or {heights.shape}"
            )
        if not (radii > 0.0).all():
            raise InvalidInput(f"radius = {radius!r:.80} must be finite and greater than 0")
        loads = check.loads("rescaled_load", rescaled_load)
        if not self._hertz:
            order = np.argsort(loads, kind="stable")
            back = np.argsort(order, kind="stable")
            adhesive = adhesive_law(self.contact)
            if adhesive is None:
                results = _solved(self.contact, heights, radii, loads[order])
            else:
                every = zip(heights, np.broadcast_to(radii, heights.shape), strict=True)
                found = [curve_of_heights(self, adhesive, *row, loads[order]) for row in every]
                names = ("approach", "load", "area", "stiffness")
                results = tuple(np.array([getattr(curve, name) for curve in found]) for name in names)
            approach, carried, area, slope = (part[:, back] for part in results)
            return approach, carried, area, slope
        gap, root = _sorted_by_gap(heights, radii)
        order = np.argsort(loads, kind="stable")
        rising, results = loads[order], kernel.empty_results(len(gap), len(loads))

        def run(rows: slice) -> None:
            kernel.curves(gap[rows], root[rows], rising, *(part[rows] for part in results))

        run_rows(run, len(gap), len(gap) * len(loads), POINTS_PER_THREAD)
        back = np.argsort(order, kind="stable")
        approach, carried, area, slope = (part[:, back] for part in results)
        return approach, carried, area, slope

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """A0 [mm^2] at increasing rescaled loads (k,) for many surfaces, (m, k); it ignores positions.

        height, radius: (m, n) [mm]; None is that of the surface.
        """
        given = surface.radius if radius is None else radius
        law = self.contact.for_material(surface.material)
        adhesive = adhesive_law(law)
        if adhesive is not None:
            refuse_merging(adhesive, surface)
            return independent_areas(adhesive, height, given, load)
        if law != PARABOLOID:
            _, carried, area, _ = _solved(law, height, given, load)
            error = np.abs(carried - load) / np.where(load > 0.0, load, 1.0)
            return np.where(solved(error, TOLERANCE, carried, area), area, np.nan)
        gap, root = _sorted_by_gap(height, given)
        area, load = np.empty((len(gap), len(load))), np.array(load)

        def run(rows: slice) -> None:
            kernel.areas(gap[rows], root[rows], load, area[rows])

        run_rows(run, len(gap), area.size, AREAS_PER_THREAD)
        return area


def _solved(law: Contact, height: FloatArray, radius: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
    """Return approach, load, area and stiffness (m, k) of surfaces (m, n) of any law at increasing loads."""
    gap = height.max(axis=1, keepdims=True) - height
    table = tables(law, np.broadcast_to(radius, gap.shape))
    results = kernel.empty_results(len(gap), len(load))
    rising = np.array(load)  # a read-only array would compile the kernel again

    def run(rows: slice) -> None:
        tabulated.curves(rows_of(table, rows), gap[rows], rising, *(part[rows] for part in results))

    run_rows(run, len(gap), results[0].size, TABULATED_PER_THREAD)
    # beyond its tables a law is solved by itself, or refuses
    beyond = ~(results[0].max(axis=1, keepdims=True) - gap <= deepest(table)).all(axis=1)
    for row in np.flatnonzero(beyond):
        size = table.radius[row]
        approach = approach_at_load(law, gap[row], size, load)
        for part, found in zip(results, (approach, *sums(law, gap[row], size, approach)), strict=True):
            part[row] = found
    return results


def _gradient(law: Contact, indentation: FloatArray, radius: FloatArray) -> FloatArray:
    """Return dA0/dh at fixed load [mm] of contacts with indentations (k, n); for open ones it is zero."""
    if law == PARABOLOID:
        alone = math.pi * radius * (indentation > 0.0)
        share = np.sqrt(radius * np.maximum(indentation, 0.0))
    else:
        _, share, _, alone = _each(law, indentation, radius)
    total = share.sum(axis=1, keepdims=True)
    share /= np.where(total > 0.0, total, 1.0)
    return np.asarray(alone - alone.sum(axis=1, keepdims=True) * share)


def _each(law: Contact, indentation: FloatArray, radius: FloatArray) -> tuple[FloatArray, ...]:
    """Return load, stiffness, area and its derivative by the indentation of contacts (k, n) of any law."""
    size = np.broadcast_to(radius, indentation.shape[1:])
    table = tables(law, size)
    if (indentation > deepest(table)).any():
        found = contacts(law, indentation, size)
        return found.load, found.stiffness, found.area, law.area_slope(found.contact_radius, size)
    results = tuple(np.empty_like(indentation) for _ in range(4))
    tabulated.each(table, indentation, *results)
    return results


def _sorted_by_gap(height: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return gaps below the tallest and square roots of the radii, (m, n), rows sorted by gap."""
    gap = height.max(axis=1, keepdims=True) - height
    if radius.ndim == 0 or (radius == radius.flat[0]).all():
        gap.sort(axis=1)
        return gap, np.full_like(gap, math.sqrt(radius.flat[0]))
    order = np.argsort(gap, axis=1, kind="stable")
    root = np.sqrt(np.broadcast_to(radius, gap.shape))
    return np.take_along_axis(gap, order, 1), np.take_along_axis(root, order, 1)
