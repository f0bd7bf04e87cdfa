"""Interacting asperities without adhesion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from metafem._kernels import curve as kernel
from metafem._kernels.equations import State
from metafem._kernels.gradient import area_gradients
from metafem._kernels.law import Law
from metafem._kernels.newton import ON_CURVE, TOLERANCE
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, NotConverged
from metafem.models._resources import run_rows
from metafem.models.contact_tables import deepest, rows_of, tables
from metafem.models.curve import (
    Curve,
    RescaledState,
    Sensitivity,
    areas_one_by_one,
    refuse_unloading,
    solved,
)
from metafem.models.interacting.influence import Coupled, coupling_between, refuse_wide
from metafem.models.interacting.newton_krylov import NOT_RECORDED, ContactEquations, large_scene
from metafem.models.interacting.newton_krylov import TOLERANCE as FAST_TOLERANCE
from metafem.models.interacting.sums import find_grid, find_lattice
from metafem.notes import Note, information
from metafem.substrate import Radial

# Largest numbers of asperities that are solved with dense matrices over all pairs. The first number applies
# to lattices with order 3, the second to all other scenes. Times per load of a curve of order 3 on a layer,
# with dense matrices and with FFTs on the lattice: .3 and 3 ms for 400 asperities, 4 and 4 ms for 625, 10 and
# 5 ms for 900. For 2000 asperities the matrices of order 3 need 0.3 GB.
LATTICE_LIMIT, DENSE_LIMIT = 400, 2000

# Number of pairs of asperities, times loads, below which a second thread saves no time: about a millisecond.
PAIRS_PER_THREAD = 200_000

# The same number for a single list of heights, whose curve is divided into two: the second half begins from
# independent contacts, which takes as long as a few loads. The number does not depend on the machine, because
# the last digits depend on the division.
PAIRS_PER_HALF = 4_000_000


@dataclass(frozen=True, eq=False)
class Solution:
    """Results (m, k) for m lists of heights, and the last list of heights (n,) with its last state."""

    results: kernel.Results
    height: FloatArray
    last: State
    tolerance: FloatArray | float  # (k,)
    gradient: Callable[[], FloatArray]  # returns dA0/dh without the change of the pedestals
    notes: tuple[Note, ...] = ()

    @property
    def solved(self) -> np.ndarray:
        """Whether each equilibrium has converged to finite values, (m, k)."""
        return solved(self.results.residual, self.tolerance, self.results.load, self.results.area)


class ElasticCoupling(Coupled):
    """Interacting asperities without adhesion, solved with dense matrices, or fast sums for larger scenes."""

    @cached_property
    def summed(self) -> Radial | None:
        """The substrate if fast sums are used; None if dense matrices are used."""
        count, substrate = self.surface.count, self.substrate
        if count <= LATTICE_LIMIT or not isinstance(substrate, Radial):
            return None
        if count > DENSE_LIMIT:
            return substrate
        position, cell = self.surface.position, self.surface.cell
        if cell is not None:
            return substrate if find_grid(position, cell) else None
        return substrate if self.order == 3 and find_lattice(position) else None

    def path(self, values: FloatArray, by_load: bool, unloading: bool) -> Curve:
        """Return equilibria at increasing loads or approaches (k,)."""
        refuse_unloading(self.law, unloading)
        solution = self._solve(self.surface.height[None, :], values, by_load)
        self._refuse_thin_layer(solution.results)
        return self._curve(solution)

    def solve(self, height: FloatArray, load: FloatArray) -> tuple[FloatArray, ...]:
        """Return approach, load, area and stiffness (m, k) for heights (m, n) at increasing loads (k,)."""
        solution = self._solve(height, load, by_load=True)
        results = solution.results
        self._refuse_thin_layer(results)
        failed = ~solution.solved
        if failed.any():
            worst = float(results.residual[failed].max())
            raise NotConverged(
                f"{int(failed.sum())} equilibria not converged: largest residual {worst:.2g}", results
            )
        return results.approach, results.load, results.area, results.stiffness

    def sensitivity(self, height: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n)."""
        indentation = np.zeros((len(load), self.surface.count))
        solution = self._solve(height[None, :], load, True, indentation)

        def gradient() -> FloatArray:
            found = solution.gradient()
            if not self.pedestal:
                return found
            carried = self.law.contacts(indentation, self.law.summits(self.surface)).load
            return self.on_pedestals(found, height, carried)

        return Sensitivity(self._curve(solution), gradient, indentation)

    def areas(self, height: FloatArray, radius: FloatArray | None, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) for heights and radii (m, n); see `Model.areas`."""
        if radius is not None and self.summed is not None:
            return areas_one_by_one(self.model.curve, self.surface, load, height, radius, None)
        solution = self._solve(height, load, True, radius=radius)
        self._refuse_thin_layer(solution.results)
        return np.where(solution.solved, solution.results.area, np.nan)

    def _curve(self, solution: Solution) -> Curve:
        approach, load, area, stiffness, residual = (part[0] for part in solution.results[:5])

        def last() -> RescaledState:
            state = solution.last
            parts = state.load, math.pi * state.footprint, state.indentation
            return self.state(solution.height, *parts, solution.notes)

        return Curve(approach, load, area, stiffness, residual, solution.tolerance, last)

    def _solve(
        self,
        height: FloatArray,
        control: FloatArray,
        by_load: bool,
        indentation: FloatArray = NOT_RECORDED,
        radius: FloatArray | None = None,
    ) -> Solution:
        """Return the solution for heights (m, n) at increasing loads or approaches (k,).

        radius: (m, n) [mm]; default: the surface's. `indentation` (k, n) [mm] is filled with the nominal
        indentations of the last list of heights unless empty.
        """
        gap = height.max(axis=1, keepdims=True) - height
        surface, bound = self.surface, self.substrate
        size = surface.radius if radius is None else radius
        self_term = np.zeros(height.shape) + self.pedestals(height, size)
        found = np.zeros((len(kernel.Results._fields), len(height), len(control)))
        results = kernel.Results(*found)
        law = tables(self.law, np.broadcast_to(self.law.summits(surface, radius), gap.shape))
        if self.summed is not None:
            sums, coarse = large_scene(surface, self.summed, self.order)
            self_term += sums.self_influence
            for row in range(len(height)):
                part = kernel.Results(*(array[row] for array in results))
                scene = rows_of(law, row), self_term[row], gap[row]
                equations = ContactEquations(sums, self.order, *scene, coarse)
                last = equations.follow(control, by_load, part, indentation)
            self._refuse_deep(law, -1, last)
            notes = (information(sums.note),)
            by_height = partial(equations.area_gradients, indentation)
            return Solution(results, height[-1], last, FAST_TOLERANCE, by_height, notes)
        coupling, regular = coupling_between(surface, bound, self.order)
        self_term += regular
        tolerance = np.full(len(control), ON_CURVE)  # those of the kernel
        tolerance[-1] = TOLERANCE
        control = np.array(control)  # a read-only array would compile the kernel again
        states = {}

        def run(rows: slice, loads: slice) -> None:
            state = State(surface.count)
            part = np.zeros_like(found[:, rows, loads], order="C")  # a view would compile the kernel again
            kernel.curves(
                coupling, self.order, rows_of(law, rows), self_term[rows], gap[rows], control[loads], by_load,
                part, state.block, state.closed, self._matrix(), indentation[loads],
            )  # fmt: skip
            found[:, rows, loads] = part
            states[rows.stop, loads.stop] = state

        whole, pairs = (len(gap), len(control)), gap.size * surface.count * len(control)
        if len(gap) == 1:
            run_rows(partial(run, slice(0, 1)), len(control), pairs, PAIRS_PER_HALF)
        else:
            run_rows(partial(run, loads=slice(0, len(control))), len(gap), pairs, PAIRS_PER_THREAD)
        for (end, _), state in states.items():
            self._refuse_deep(law, end - 1, state)

        def gradients() -> FloatArray:
            found = np.empty_like(indentation)
            system = coupling, self.order, rows_of(law, -1), self_term[-1]

            def run(part: slice) -> None:
                state = State(surface.count)
                area_gradients(
                    *system, indentation[part], state.block, state.closed, self._matrix(), found[part]
                )

            run_rows(run, len(found), len(found) * surface.count**2, PAIRS_PER_THREAD)
            return found

        return Solution(results, height[-1], states[whole], tolerance, gradients)

    def _matrix(self) -> FloatArray:
        """Return the matrix of one thread for Newton's method; order 1 needs none."""
        size = 0 if self.order == 1 else self.surface.count
        return np.zeros((size, size))

    def _refuse_deep(self, law: Law, row: int, state: State) -> None:
        """Raise InvalidInput if an indentation of a surface exceeds the range of the law."""
        if not law.data.size:
            return
        limit = deepest(rows_of(law, row))
        if (state.z > limit).any():
            i = int((state.z > limit).argmax())
            raise InvalidInput(
                f"asperity {i} is indented by more than {limit[i]:.4g} mm, up to which "
                f"{self.model.contact!r} is described; use lighter loads or a law with a larger range"
            )

    def _refuse_thin_layer(self, results: kernel.Results) -> None:
        """Raise InvalidInput if a contact exceeds the layer thickness or the cell: the expansion fails."""
        refuse_wide(self.surface, float(results.radius.max()))
        thickness = getattr(self.substrate, "thickness", None)
        # neither the solution nor its contact radii are accurate in this range
        if thickness is not None and float(results.radius.max()) > thickness:
            raise InvalidInput(
                f"the layer of {thickness:g} mm is thinner than the contacts: order {self.order} holds for "
                f"contact radii up to {thickness:g} mm; use resolved contacts or a thicker layer"
            )
