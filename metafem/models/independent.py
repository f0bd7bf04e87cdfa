"""Independent asperities: Hertz contacts without interaction."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_class
from metafem._validate import FloatArray
from metafem.contact import Hertz
from metafem.errors import InvalidInput
from metafem.models._resources import run_rows
from metafem.models.interacting.model import Interacting
from metafem.models.model import ContactState, Curve, Sensitivity, Status
from metafem.surface import Surface

# Relative error of the load. The unknown is the indentation of the shallowest contact, to keep its digits.
TOLERANCE = 1e-12

# With fewer points than this the solution takes less time than the start of a second thread.
POINTS_PER_THREAD = 20_000


@checked_class
@dataclass(frozen=True)
class Independent:
    """Independent Hertzian asperities under a common plane.

    ``A0 = sum pi R_i d_i`` and ``P/E* = sum 4/3 sqrt(R_i) d_i^(3/2)`` with ``d_i = max(h_i - delta, 0)``.
    The load equation is convex and increasing in the approach; it is solved by Newton's method inside a
    bracket, from the side on which it cannot overshoot. Greenwood and Williamson, Proc. R. Soc. A 295,
    300 (1966), doi:10.1098/rspa.1966.0242.

    Examples
    --------
    >>> from metafem import Material, Surface, equilibrium
    >>> surface = Surface.square_lattice(0.1, (1, 1), radius=0.526, material=Material(1.36))
    >>> round(equilibrium(surface, Independent(), load=0.01).approach, 6)
    0.038668
    """

    @property
    def tolerance(self) -> float:
        """Largest relative error of the load of a converged state."""
        return TOLERANCE

    @property
    def name(self) -> str:
        """Name of the model in texts and for ``--model``."""
        return "independent"

    @property
    def couples(self) -> bool:
        """Whether the load of a contact depends on the others at given indentations: no."""
        return False

    @property
    def gradient_model(self) -> Independent:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """Order 3 on the half-space."""
        return Interacting()

    def solve(self, surface: Surface, approach: float) -> ContactState:
        """Equilibrium at a given approach [mm]."""
        return self._state(surface, approach, approach - surface.gap)

    def solve_load(self, surface: Surface, load: float) -> ContactState:
        """Equilibrium at a rescaled load P/E* [mm^2]."""
        from metafem._kernels import independent as kernel

        gap, root = _sorted_by_gap(surface.height[None, :], surface.radius)
        approach = kernel.approach_at_load(gap[0], root[0], load, 0.0)
        base, depth = kernel.refine(gap[0], root[0], load, approach)
        state = self._state(surface, base + depth, depth + (base - surface.gap))
        wanted = surface.material.composite_modulus * load
        error = abs(state.load - wanted) / wanted if wanted > 0.0 else state.load
        well = error <= TOLERANCE
        return replace(state, residual=error, status=Status.CONVERGED if well else Status.NOT_CONVERGED)

    def _state(self, surface: Surface, approach: float, indentation: FloatArray) -> ContactState:
        modulus = surface.material.composite_modulus
        law = Hertz()
        contact_radius = law.contact_radius(indentation, surface.radius)
        load = modulus * law.load(contact_radius, surface.radius)
        area = law.area(contact_radius)
        total = math.fsum(load)
        separation = float(surface.height.max()) - approach
        return ContactState(
            load=total,
            area=math.fsum(area),
            separation=separation,
            approach=approach,
            stiffness=modulus * math.fsum(law.stiffness(contact_radius, surface.radius)),
            asperity_load=load,
            asperity_area=area,
            residual=0.0,
            status=Status.CONVERGED,
            model=self,
            base_gap=separation,
        )

    def curve(self, surface: Surface, load: FloatArray) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2], (k,)."""
        return self._curve(surface.height, surface.radius, load)

    def _curve(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Curve:
        approach, carried, area, slope = self.curves(height, radius, load)
        error = np.abs(carried[0] - load) / np.where(load > 0.0, load, 1.0)
        return Curve(approach[0], carried[0], area[0], slope[0], error)

    def curve_at(self, surface: Surface, approach: FloatArray) -> Curve:
        """Equilibria at given approaches [mm], (k,)."""
        from metafem._kernels import independent as kernel

        gap, root = _sorted_by_gap(surface.height[None, :], surface.radius)
        load, area, slope = (np.empty(len(approach)) for _ in range(3))
        kernel.curve_at_approach(gap[0], root[0], approach, load, area, slope)
        return Curve(np.array(approach), load, area, slope, np.zeros(len(approach)))

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads (k,), and dA0/dh of each height at fixed load [mm], (k, n).

        ``pi R_i - sum_j pi R_j sqrt(R_i d_i) / sum_j sqrt(R_j d_j)`` for the asperities in contact.
        height: summit heights (n,) [mm] in place of the surface's own; they are not checked.
        """
        return self.sensitivity_of(surface.height if height is None else height, surface.radius, load)

    def sensitivity_of(self, height: FloatArray, radius: FloatArray, load: FloatArray) -> Sensitivity:
        """As `sensitivity`, for heights and radii (n,) without a surface, which takes as long to check."""
        curve = self._curve(height, radius, load)
        indentation = curve.approach[:, None] - (height.max() - height)
        own = math.pi * radius * (indentation > 0.0)
        share = np.sqrt(radius * np.maximum(indentation, 0.0))
        whole = share.sum(axis=1, keepdims=True)
        share /= np.where(whole > 0.0, whole, 1.0)
        return Sensitivity(curve, own - own.sum(axis=1, keepdims=True) * share, indentation)

    def curves(
        self, height: ArrayLike, radius: ArrayLike, rescaled_load: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Friction laws of many surfaces at once, through one compiled kernel.

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
        from metafem._kernels import independent as kernel

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
        gap, root = _sorted_by_gap(heights, radii)
        order = np.argsort(loads, kind="stable")
        rising = loads[order]
        results = kernel.empty_results(len(gap), len(loads))

        def run(rows: slice) -> None:
            kernel.curves(gap[rows], root[rows], rising, *(part[rows] for part in results))

        run_rows(run, len(gap), len(gap) * len(loads), POINTS_PER_THREAD)
        back = np.argsort(order, kind="stable")
        approach, carried, area, slope = (part[:, back] for part in results)
        return approach, carried, area, slope


def _sorted_by_gap(height: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return gaps below the tallest and square roots of the radii, (m, n), rows sorted by gap."""
    gap = height.max(axis=1, keepdims=True) - height
    if radius.ndim == 0 or (radius == radius.flat[0]).all():
        gap.sort(axis=1)
        return gap, np.full_like(gap, math.sqrt(radius.flat[0]))
    order = np.argsort(gap, axis=1, kind="stable")
    root = np.sqrt(np.broadcast_to(radius, gap.shape))
    return np.take_along_axis(gap, order, 1), np.take_along_axis(root, order, 1)
