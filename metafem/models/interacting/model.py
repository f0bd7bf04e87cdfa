"""Asperities that interact through the elastic block."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_class
from metafem._validate import FloatArray
from metafem.contact import Contact, Hertz
from metafem.errors import InvalidInput, NotConverged
from metafem.models._resources import require_memory, run_rows
from metafem.models.interacting.cap_influence import pedestal_influence, pedestal_notes
from metafem.models.interacting.large import LargeScene, Last
from metafem.models.interacting.newton_krylov import TOLERANCE as FAST_TOLERANCE
from metafem.models.model import ContactState, Curve, Sensitivity, Status
from metafem.substrate import BondedLayer, HalfSpace, Radial, Substrate
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem._kernels.continuation import Results
    from metafem._kernels.coupling import Coupling

# Largest residual of a returned state; the kernel aims a digit lower.
TOLERANCE = 1e-12

# Scenes up to this size are solved with all pairs in dense matrices: at 2000 a product takes as long as
# the transforms of a lattice, and the matrices of order 3 need 0.5 GB.
DENSE_LIMIT = 2000

# Pairs of asperities, times loads, below which a second thread does not pay: about a millisecond.
PAIRS_PER_THREAD = 200_000


# Influences that are kept for the next call, and the largest scene of which one is: seven matrices of
# 256 sites take 3.5 MiB.
KEPT_FIELDS, MOST_KEPT = 8, 256

# Placeholder where the states of a curve are not recorded.
NO_TRAIL = np.empty((0, 0))


@checked_class
@dataclass(frozen=True)
class Interacting:
    """Hertzian asperities coupled through an elastic substrate.

    The indentations are ``d_i = h_i - delta - u_i`` with the displacement ``u_i`` by the other asperities,
    and ``P_i = 4/3 E* sqrt(R_i) d_i^(3/2)``.

    Order 1 represents the other asperities by point loads, ``u_i = sum_j P_j/E* G(r_ij)``. Order 3 adds
    all three terms of the next order: the finite size of the sources, ``a_j^2/10 lap G``; the curvature of
    the field, ``1/R_i + sum_j P_j/E* lap G/2``; and its slope, which shifts the contact by ``-R grad u``.
    They are the gradient of one energy, to first order in the shifts. Both orders include the regular self
    terms of the substrate.

    Against resolved contacts on a half-space, up to a/pitch = 0.32, the error of order 3 is at most 0.025 %
    in the total load at fixed approach and 0.08 % in A0 at fixed load; that of order 1 is 0.08 % and 0.9 %.

    Parameters
    ----------
    order : {1, 3}
    substrate : Substrate
        `HalfSpace()`, `BondedLayer()`, or any other.
    contact : Contact
        Law of one contact: `Hertz()`.
    pedestal : bool
        Add the compliance of the caps themselves in the limit of light loads; tabulated up to h/R = 0.6.

    Raises
    ------
    InvalidInput
        For an order that does not exist, or a substrate or contact that cannot be used.

    Examples
    --------
    >>> from metafem import Material, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, Interacting(), load=1.28)
    >>> round(state.area, 3), round(state.separation, 4)
    (6.462, -0.0227)
    """

    order: int = 3
    substrate: Substrate = field(default_factory=HalfSpace)
    contact: Contact = field(default_factory=Hertz)
    pedestal: bool = False

    def __post_init__(self) -> None:
        whole = isinstance(self.order, int | np.integer) and not isinstance(self.order, bool)
        if not whole or self.order not in (1, 3):
            raise InvalidInput(f"order = {self.order!r} does not exist; it must be 1 or 3")
        if isinstance(self.substrate, type) or not isinstance(self.substrate, Substrate):
            raise InvalidInput(
                f"substrate = {self.substrate!r} must be a substrate such as metafem.HalfSpace()"
            )
        if not isinstance(self.contact, Hertz):
            raise InvalidInput(f"contact = {self.contact!r} must be metafem.Hertz()")
        if not isinstance(self.pedestal, bool):
            raise InvalidInput(f"pedestal = {self.pedestal!r} must be True or False")

    @property
    def tolerance(self) -> float:
        """Largest residual of a converged state of up to 2000 asperities; 1e-9 above."""
        return TOLERANCE

    @property
    def name(self) -> str:
        """Name of the model in texts: its substrate, and other attributes that are not the default."""
        substrate = getattr(
            self.substrate, "name", type(self.substrate).__name__
        )  # a user's substrate may have no name
        order = "" if self.order == 3 else f", order {self.order}"
        return f"{substrate}{order}{', with pedestals' if self.pedestal else ''}"

    @property
    def couples(self) -> bool:
        """Whether the load of a contact depends on the others at given indentations: yes."""
        return True

    @property
    def gradient_model(self) -> Interacting:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """The same model of order 3."""
        return replace(self, order=3)

    def solve(self, surface: Surface, approach: float) -> ContactState:
        """Equilibrium at a given approach [mm]."""
        return self._state(surface, approach, by_load=False)

    def solve_load(self, surface: Surface, load: float) -> ContactState:
        """Equilibrium at a given rescaled load P/E* [mm^2]."""
        return self._state(surface, load, by_load=True)

    def curve(self, surface: Surface, load: FloatArray) -> Curve:
        """Equilibria at increasing rescaled loads P/E* [mm^2], (k,)."""
        return self._curve(surface, np.asarray(load), by_load=True)

    def curve_at(self, surface: Surface, approach: FloatArray) -> Curve:
        """Equilibria at increasing approaches [mm], (k,)."""
        return self._curve(surface, np.asarray(approach), by_load=False)

    def curves(
        self, surface: Surface, height: ArrayLike, rescaled_load: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Friction laws of many lists of heights on the sites of one surface, in compiled code.

        Parameters
        ----------
        surface : Surface
            Positions, radii, material and block; its own heights are not used.
        height : array_like, (m, n) or (n,)
            Lists of summit heights [mm].
        rescaled_load : array_like, (k,)
            Loads P/E* [mm^2], not negative, in any order.

        Returns
        -------
        approach, load, area, stiffness : ndarray, (m, k)
            Approach [mm], load recomputed at it [mm^2], real contact area [mm^2] and derivative of
            the rescaled load by the approach [mm].

        Raises
        ------
        InvalidInput
            For heights or loads outside their range, and a layer thinner than the contacts.
        NotConverged
            If a residual exceeds 1e-12 (1e-9 above 2000 asperities); all results are attached.

        Examples
        --------
        >>> from metafem import Material
        >>> surface = Surface([[0, 0], [1.5, 0]], [0.1, 0.1], 0.526, Material(1.36))
        >>> approach, load, area, stiffness = Interacting().curves(
        ...     surface, [[0.1, 0.1], [0.1, 0.2]], [0.01, 0.02]
        ... )
        >>> area.round(4)
        array([[0.0988, 0.1568],
               [0.0784, 0.1245]])
        """
        heights = check.lists("height", height, surface.count)
        loads = check.loads("rescaled_load", rescaled_load)
        results, _ = self._run(surface, heights, loads, by_load=True)
        _refuse_thin_layer(self.substrate.for_surface(surface), float(results.radius.max()))
        worst = float(results.residual.max())
        promise = self._promise(surface)
        if not worst <= promise:
            count = int((~(results.residual <= promise)).sum())
            raise NotConverged(f"{count} equilibria not converged: largest residual {worst:.2g}", results)
        return results.approach, results.load, results.area, results.stiffness

    def _promise(self, surface: Surface) -> float:
        """Return the residual that is promised for a surface of this size."""
        return TOLERANCE if surface.count <= DENSE_LIMIT else FAST_TOLERANCE

    def _curve(self, surface: Surface, control: FloatArray, by_load: bool) -> Curve:
        results, _ = self._run(surface, surface.height[None, :], control, by_load)
        _refuse_thin_layer(self.substrate.for_surface(surface), float(results.radius.max()))
        approach, load, area, stiffness, residual = (results[k][0] for k in range(5))
        return Curve(approach, load, area, stiffness, residual, self._promise(surface))

    def _state(self, surface: Surface, control: float, by_load: bool) -> ContactState:
        results, last = self._run(surface, surface.height[None, :], np.array([control]), by_load)
        modulus = surface.material.composite_modulus
        bound = self.substrate.for_surface(surface)
        _refuse_thin_layer(bound, float(results.radius.max()))
        approach = float(results.approach[0, 0])
        separation = float(surface.height.max()) - approach
        residual = float(results.residual[0, 0])
        return ContactState(
            load=modulus * float(results.load[0, 0]),
            area=float(results.area[0, 0]),
            separation=separation,
            approach=approach,
            stiffness=modulus * float(results.stiffness[0, 0]),
            asperity_load=modulus * last.load,
            asperity_area=math.pi * last.square,
            residual=residual,
            status=Status.CONVERGED if residual <= self._promise(surface) else Status.NOT_CONVERGED,
            model=self,
            base_gap=self._base_gap(surface, separation, last),
            notes=(*last.notes, *(pedestal_notes(surface) if self.pedestal else ())),
        )

    def _base_gap(self, surface: Surface, separation: float, last: Last) -> float:
        """Return what is left beside a summit; the shift of a contact adds less than a micron to it."""
        if not last.load.any():
            return separation
        left = surface.height - last.indentation
        if self.pedestal:  # the cap's foot sinks, the base beside it hardly
            left = left - pedestal_influence(surface.height, surface.radius)[0] * last.load
        return float(left.min())

    def _run(
        self, surface: Surface, height: FloatArray, control: FloatArray, by_load: bool
    ) -> tuple[Results, Last]:
        """Solve (m, n) heights at (k,) loads or approaches, in any order; keep the last state."""
        from metafem._kernels import continuation as kernel

        own = np.zeros(height.shape)
        if self.pedestal:
            own += pedestal_influence(height, surface.radius)[0]
        gap = height.max(axis=1, keepdims=True) - height
        order = np.argsort(control, kind="stable")
        rising = np.ascontiguousarray(control[order])
        results = kernel.empty_results(len(height), len(rising))
        bound = self.substrate.for_surface(surface)
        if surface.count > DENSE_LIMIT and isinstance(bound, Radial):
            large = LargeScene(surface, bound, self.order)
            for row in range(len(height)):
                part = kernel.Results(*(array[row] for array in results))
                last = large.follow(own[row], gap[row], rising, by_load, part)
        else:
            coupling, self_term = self._coupling(surface)
            last = self._run_dense(surface, coupling, own + self_term, gap, rising, by_load, results)
        back = np.argsort(order, kind="stable")
        return kernel.Results(*(array[:, back] for array in results)), last

    def _run_dense(
        self,
        surface: Surface,
        coupling: Coupling,
        own: FloatArray,
        gap: FloatArray,
        rising: FloatArray,
        by_load: bool,
        results: Results,
        trail: FloatArray = NO_TRAIL,
    ) -> Last:
        """Fill the results by the compiled kernel, in up to two threads."""
        from metafem._kernels import continuation as kernel

        radius = np.array(np.broadcast_to(surface.radius, gap.shape), order="C")
        last = Last(np.zeros(surface.count), np.zeros(surface.count), np.zeros(surface.count))

        def run(rows: slice) -> None:
            state, memory, scratch = kernel.empty_workplace(surface.count, self.order)
            part = kernel.Results(*(array[rows] for array in results))
            kernel.curves(
                coupling, self.order, radius[rows], own[rows], gap[rows], rising, by_load, part,
                state, memory, scratch, trail,
            )  # fmt: skip
            if rows.stop == len(gap):
                last.load[:], last.square[:] = state.load, state.square
                last.indentation[:] = state.indentation

        run_rows(run, len(gap), gap.size * surface.count * len(rising), PAIRS_PER_THREAD)
        return last

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads (k,), and dA0/dh of each height at fixed load [mm], (k, n).

        One solution of each load's contact system serves for all heights; beyond the size of the dense
        solver by conjugate gradients, to 1e-9.
        height: summit heights (n,) [mm] in place of the surface's own; they are not checked.
        """
        from metafem._kernels import continuation as kernel
        from metafem.models.interacting.sensitivity import area_gradients

        heights = surface.height if height is None else height
        gap = heights.max() - heights
        own, rate = np.zeros((1, surface.count)), np.zeros(surface.count)
        if self.pedestal:
            own[0], rate = pedestal_influence(heights, surface.radius)
        results = kernel.empty_results(1, len(load))
        trail, gradients = np.empty((2, len(load), surface.count))
        bound = self.substrate.for_surface(surface)
        if surface.count > DENSE_LIMIT and isinstance(bound, Radial):
            gradients[:] = 0.0
            part = kernel.Results(*(array[0] for array in results))
            LargeScene(surface, bound, self.order).follow(own[0], gap, load, True, part, trail, gradients)
            gradients *= 1.0 - rate * Hertz().load_at_indentation(trail, surface.radius)
        else:
            coupling, self_term = self._coupling(surface)
            own += self_term
            self._run_dense(surface, coupling, own, gap[None, :], load, True, results, trail)
            gradients = area_gradients(coupling, self.order, surface.radius, own[0], trail, rate)
        approach, carried, area, stiffness, residual = (results[k][0] for k in range(5))
        curve = Curve(approach, carried, area, stiffness, residual, self._promise(surface))
        return Sensitivity(curve, gradients, trail)

    def _coupling(self, surface: Surface) -> tuple[Coupling, FloatArray]:
        """Return the influence of the asperities on each other, and their own regular terms (n,)."""
        bound = self.substrate.for_surface(surface)
        # a radial influence depends on the sites alone
        if isinstance(bound, Radial) and isinstance(bound, Hashable) and surface.count <= MOST_KEPT:
            return _kept_field(bound, self.order, _Sites(surface.position.tobytes(), surface))
        return _field(self.substrate, self.order, surface)


@dataclass(frozen=True)
class _Sites:
    """Sites of a surface, equal where they are equal to the bit."""

    position: bytes
    surface: Surface = field(compare=False)


@lru_cache(maxsize=KEPT_FIELDS)
def _kept_field(substrate: Radial, order: int, sites: _Sites) -> tuple[Coupling, FloatArray]:
    """Return the influence between sites, computed once for all heights on them."""
    return _field(substrate, order, sites.surface)


def _field(substrate: Substrate, order: int, surface: Surface) -> tuple[Coupling, FloatArray]:
    """Compute the influence of the asperities on each other, and their own regular terms (n,)."""
    from metafem._kernels.coupling import Coupling

    # the matrices, those with their ends exchanged, the Jacobian, and as much while they are made
    require_memory(8 * surface.count**2 * (3 if order == 1 else 14), f"{surface.count} asperities")
    influence = np.array(substrate.influence_matrix(surface), dtype=np.float64, order="C")
    own = np.diagonal(influence).copy()
    np.fill_diagonal(influence, 0.0)
    if order == 1:
        return Coupling(influence, *(np.empty((0, 0)) for _ in range(6))), own
    derivatives = [np.ascontiguousarray(d) for d in substrate.influence_derivatives(surface)]
    return Coupling(influence, *derivatives, *(np.ascontiguousarray(d.T) for d in derivatives)), own


def _refuse_thin_layer(substrate: Substrate, contact_radius: float) -> None:
    """Raise InvalidInput where contacts are wider than the layer is thick: no expansion holds there."""
    thickness = substrate.thickness if isinstance(substrate, BondedLayer) else None
    if thickness is not None and contact_radius > thickness:
        raise InvalidInput(
            f"the layer of {thickness:g} mm is thinner than the contacts, whose radius is "
            f"{contact_radius:.4g} mm; use resolved contacts or a thicker layer"
        )
