"""Asperities that interact through the elastic block."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._kernels import continuation as kernel
from metafem._kernels.contact.tabulated import Law
from metafem._kernels.continuation import Results
from metafem._kernels.coupling import State
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.errors import InvalidInput, NotConverged
from metafem.models._resources import run_rows
from metafem.models.adhesion.curves import adhesive_law
from metafem.models.contact_sums import contacts
from metafem.models.contact_tables import deepest, rows_of, tables
from metafem.models.curve import (
    Curve,
    RescaledState,
    Sensitivity,
    areas_one_by_one,
    controlled,
    refuse_flattening,
    solved,
)
from metafem.models.interacting.adhesive import adhesive_areas, adhesive_curve, adhesive_sensitivity
from metafem.models.interacting.cap_influence import pedestal_influence, pedestal_notes
from metafem.models.interacting.kept_coupling import coupling_between
from metafem.models.interacting.large import NOT_RECORDED, LargeScene
from metafem.models.interacting.newton_krylov import TOLERANCE as FAST_TOLERANCE
from metafem.models.interacting.sensitivity import area_gradients
from metafem.notes import Note, information
from metafem.substrate import HalfSpace, Radial, Substrate
from metafem.surface import Surface

# Largest residual of a converged state; the kernel aims a digit lower.
TOLERANCE = 1e-12

# Scenes up to this size are solved with all pairs in dense matrices: at 2000 a product takes as long as
# the transforms of a lattice, and the matrices of order 3 need 0.5 GB.
DENSE_LIMIT = 2000

# Pairs of asperities, times loads, below which a second thread does not pay: about a millisecond.
PAIRS_PER_THREAD = 200_000


@dataclass(frozen=True)
class Interacting:
    """Asperities coupled through an elastic substrate.

    The indentations are ``d_i = h_i - delta - u_i`` with the displacement ``u_i`` by the other asperities,
    and each contact has the load and area of its law, for Hertz's ``P_i = 4/3 E* sqrt(R_i) d_i^(3/2)``.

    Order 1 represents the other asperities by point loads, ``u_i = sum_j P_j/E* G(r_ij)``. Order 3 adds
    all three terms of the next order: the finite size of the sources, ``M_j/4 lap G`` with the second moment
    M of their pressure, for Hertz contacts ``a_j^2/10 lap G`` per load; the curvature of the field,
    ``sum_j P_j/E* lap G/2``, which adds to that of the summit; and its slope, which tilts the contact and
    for Hertz contacts shifts it by ``-R grad u``. They are the gradient of one energy, to first order in the
    shifts. Contacts so flat that the slope D' at their edge is below 0.005 are tilted as one with that slope.
    Both orders include the regular self terms of the substrate.

    Against resolved contacts on a half-space, up to a/pitch = 0.32, the error of order 3 is at most 0.025 %
    in the total load at fixed approach and 0.25 % in A0 at fixed load (0.12 % for up to nine contacts); that
    of order 1 in A0 reaches 3 %.
    On a bonded layer the error of order 3 in A0 is at most 0.2 % up to a/t = 0.3 with nu = 0.5, and less for
    smaller Poisson's ratios; it grows as (a/t)^5. The notes of a state or law warn where contacts overlap and
    where the estimated error of order 3 exceeds 4 % in A0, and tell where a/r exceeds 0.32. Lengths are in
    mm, loads in N, moduli in MPa.

    Parameters
    ----------
    order : {1, 3}
    substrate : Substrate
        `HalfSpace()`, `BondedLayer()`, or any other.
    contact : Contact
        Law of one contact; default: `Hertz()`. Laws known only as P(d), A(d) need order 1.
    pedestal : bool
        Add the compliance of the caps themselves in the limit of light loads; tabulated up to h/R = 0.6.

    Raises
    ------
    InvalidInput
        For an order that does not exist, or a substrate or contact that cannot be used. When solving: on a
        layer thinner than the contact radius.
    NotConverged
        When solving with `equilibrium`, `friction_law` and `Curve.checked`, if an equilibrium is not found to
        the tolerance.

    Examples
    --------
    >>> from metafem import Material, equilibrium
    >>> surface = Surface.square_lattice(0.1, (8, 8), radius=0.526, material=Material(1.36))
    >>> state = equilibrium(surface, Interacting(), load=0.5)
    >>> round(state.area, 3), round(state.separation, 4)
    (3.461, 0.0431)
    """

    couples: ClassVar[bool] = True
    unloads: ClassVar[bool] = True

    order: int = 3
    substrate: Substrate = field(default_factory=HalfSpace)
    contact: Contact = PARABOLOID
    pedestal: bool = False

    def __post_init__(self) -> None:
        integer = isinstance(self.order, int | np.integer) and not isinstance(self.order, bool)
        if not integer or self.order not in (1, 3):
            raise InvalidInput(f"order = {self.order!r} does not exist; it must be 1 or 3")
        check.instance("substrate", self.substrate, Substrate, "a substrate such as metafem.HalfSpace()")
        laws = "a contact law such as metafem.Hertz() or metafem.PowerCap(4)"
        check.instance("contact", self.contact, Contact, laws)
        if self.order > self.contact.largest_order:
            raise InvalidInput(
                f"order = {self.order} needs the profile of the contacts, which {self.contact!r} does not "
                "have; use order=1"
            )
        check.instance("pedestal", self.pedestal, bool, "True or False")

    @property
    def name(self) -> str:
        """Name of the model in texts: its substrate, and other attributes that are not the default."""
        # a user's substrate may have no name
        substrate = getattr(self.substrate, "name", type(self.substrate).__name__)
        order = "" if self.order == 3 else f", order {self.order}"
        law = "" if self.contact == PARABOLOID else f", {self.contact!r}"
        return f"{substrate}{order}{', with pedestals' if self.pedestal else ''}{law}"

    @property
    def gradient_model(self) -> Interacting:
        """The model itself."""
        return self

    @property
    def reference(self) -> Interacting:
        """The same model of the largest order that its contact law allows."""
        return replace(self, order=self.contact.largest_order)

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
        adhesive = adhesive_law(self.contact, surface.material)
        if adhesive is not None:
            return adhesive_curve(self, adhesive, surface, values, by_load, unloading)
        refuse_flattening(self.contact, unloading)
        solution = self._solve(surface, surface.height[None, :], values, by_load)
        self._refuse_thin_layer(surface, solution.results)
        return self._curve(surface, solution)

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
        order = np.argsort(loads, kind="stable")
        back = np.argsort(order, kind="stable")
        solution = self._solve(surface, heights, loads[order], by_load=True)
        results = type(solution.results)(*(array[:, back] for array in solution.results))
        self._refuse_thin_layer(surface, results)
        failed = ~solution.solved
        if failed.any():
            worst = float(results.residual.max())
            raise NotConverged(
                f"{int(failed.sum())} equilibria not converged: largest residual {worst:.2g}", results
            )
        return results.approach, results.load, results.area, results.stiffness

    def sensitivity(
        self, surface: Surface, load: FloatArray, height: FloatArray | None = None
    ) -> Sensitivity:
        """Law at increasing rescaled loads (k,), and dA0/dh of each height at fixed load [mm], (k, n).

        One solution of each load's contact system serves for all heights; beyond the size of the dense
        solver by conjugate gradients, to 1e-9.
        height: summit heights (n,) [mm] in place of the surface's own; they are not checked.
        """
        heights = surface.height if height is None else height
        adhesive = adhesive_law(self.contact, surface.material)
        if adhesive is not None:
            return adhesive_sensitivity(self, adhesive, surface, load, heights)
        indentation, room = np.zeros((2, len(load), surface.count))
        solution = self._solve(surface, heights[None, :], load, True, indentation, room)

        def gradient() -> FloatArray:
            gradient = solution.gradient()
            if self.pedestal:
                _, rate = pedestal_influence(heights, surface.radius)
                law = self.contact.for_material(surface.material)
                gradient *= 1.0 - rate * contacts(law, indentation, surface.radius).load
            return gradient

        return Sensitivity(self._curve(surface, solution), gradient, indentation)

    def areas(
        self,
        surface: Surface,
        load: FloatArray,
        height: FloatArray,
        radius: FloatArray | None = None,
        position: FloatArray | None = None,
    ) -> FloatArray:
        """A0 [mm^2] at increasing rescaled loads (k,) for many surfaces, (m, k); nan if not converged.

        height, radius: (m, n) [mm]; position: (m, n, 2) [mm]; None is that of the surface. Where positions
        vary, and radii beyond the size of the dense solver, the surfaces are solved one by one.
        """
        if position is not None or (radius is not None and surface.count > DENSE_LIMIT):
            return areas_one_by_one(self.curve, surface, load, height, radius, position)
        adhesive = adhesive_law(self.contact, surface.material)
        if adhesive is not None:
            return adhesive_areas(self, adhesive, surface, load, height, radius)
        solution = self._solve(surface, height, load, True, radius=radius)
        self._refuse_thin_layer(surface, solution.results)
        return np.where(solution.solved, solution.results.area, np.nan)

    def _curve(self, surface: Surface, solution: _Solution) -> Curve:
        approach, load, area, stiffness, residual = (part[0] for part in solution.results[:5])
        last = partial(self._last, surface, solution)
        return Curve(approach, load, area, stiffness, residual, solution.tolerance, last)

    def _last(self, surface: Surface, solution: _Solution) -> RescaledState:
        state, height = solution.last, solution.height
        base = height - state.indentation
        if self.pedestal:  # the foot of the cap sinks with the summit, the base beside it hardly
            base = base - pedestal_influence(height, surface.radius)[0] * state.load
        notes = (*solution.notes, *(pedestal_notes(surface) if self.pedestal else ()))
        area = math.pi * state.square
        # the shift of a contact adds less than a micrometre to the base gap
        return RescaledState(state.load, area, state.indentation, float(base.min()), self, notes)

    def _solve(
        self,
        surface: Surface,
        height: FloatArray,
        control: FloatArray,
        by_load: bool,
        indentation: FloatArray = NOT_RECORDED,
        gradient: FloatArray = NOT_RECORDED,
        radius: FloatArray | None = None,
    ) -> _Solution:
        """Solve heights (m, n) at increasing loads or approaches (k,), with radii (m, n) or the surface's.

        Nominal indentations of the last heights, and beyond the size of the dense solver dA0/dh without the
        change of the pedestals, are filled where there is room for them, (k, n) [mm].
        """
        gap = height.max(axis=1, keepdims=True) - height
        self_term = np.zeros(height.shape)
        if self.pedestal:
            self_term += pedestal_influence(height, surface.radius if radius is None else radius)[0]
        results = kernel.empty_results(len(height), len(control))
        bound = self.substrate.for_surface(surface)
        size = np.broadcast_to(surface.radius if radius is None else radius, gap.shape)
        law = tables(self.contact.for_material(surface.material), size)
        if surface.count > DENSE_LIMIT and isinstance(bound, Radial):
            large = LargeScene(surface, bound, self.order)
            for row in range(len(height)):
                part = kernel.Results(*(array[row] for array in results))
                last = large.follow(
                    rows_of(law, row), self_term[row], gap[row], control, by_load, part, indentation, gradient
                )
            self._refuse_deep(rows_of(law, -1), last)
            notes = (information(large.sums.note),)
            return _Solution(results, height[-1], last, FAST_TOLERANCE, lambda: gradient, notes)
        coupling, regular = coupling_between(surface, bound, self.order)
        self_term += regular
        control = np.array(control)  # a read-only array would compile the kernel again
        states = {}

        def run(rows: slice) -> None:
            state, memory, scratch = kernel.empty_workspace(surface.count, self.order)
            part = kernel.Results(*(array[rows] for array in results))
            kernel.curves(
                coupling, self.order, rows_of(law, rows), self_term[rows], gap[rows], control, by_load, part,
                state, memory, scratch, indentation,
            )  # fmt: skip
            states[rows.stop] = state

        run_rows(run, len(gap), gap.size * surface.count * len(control), PAIRS_PER_THREAD)
        for end, state in states.items():
            self._refuse_deep(rows_of(law, end - 1), state)
        system = coupling, self.order, rows_of(law, -1), self_term[-1]
        gradients = partial(area_gradients, *system, indentation)
        return _Solution(results, height[-1], states[len(gap)], TOLERANCE, gradients)

    def _refuse_deep(self, law: Law, state: State) -> None:
        """Raise InvalidInput where contacts are deeper than their law describes."""
        if not law.data.size:
            return
        limit = deepest(law)
        if (state.z > limit).any():
            i = int((state.z > limit).argmax())
            raise InvalidInput(
                f"asperity {i} is indented by more than {limit[i]:.4g} mm, up to which {self.contact!r} is "
                "described; use lighter loads or a law with a larger range"
            )

    def _refuse_thin_layer(self, surface: Surface, results: Results) -> None:
        """Raise InvalidInput where contacts are wider than the layer is thick: no expansion holds there."""
        thickness = getattr(self.substrate.for_surface(surface), "thickness", None)
        # the solution is not valid there, and neither are the radii of its contacts
        if thickness is not None and float(results.radius.max()) > thickness:
            raise InvalidInput(
                f"the layer of {thickness:g} mm is thinner than the contacts: order {self.order} holds for "
                f"contact radii up to {thickness:g} mm; use resolved contacts or a thicker layer"
            )


@dataclass(frozen=True, eq=False)
class _Solution:
    """Results (m, k) of m lists of heights, and the last heights (n,) with their last state."""

    results: Results
    height: FloatArray
    last: State
    tolerance: float
    gradient: Callable[[], FloatArray]  # dA0/dh without the change of the pedestals, where it was asked for
    notes: tuple[Note, ...] = ()

    @property
    def solved(self) -> np.ndarray:
        """Whether each equilibrium is converged and finite, (m, k)."""
        return solved(self.results.residual, self.tolerance, self.results.load, self.results.area)
