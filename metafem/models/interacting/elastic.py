"""Interacting asperities without adhesion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from metafem._kernels import curve as kernel
from metafem._kernels.equations import State
from metafem._kernels.gradient import area_gradients
from metafem._kernels.law import Law
from metafem._kernels.newton import ON_CURVE, TOLERANCE
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.pedestal import TALLEST, pedestal_influence
from metafem.errors import InvalidInput
from metafem.models._resources import run_rows
from metafem.models.contact_tables import refuse_beyond, rows_of, tables
from metafem.models.curve import (
    Curve,
    RescaledState,
    Sensitivity,
    areas_one_by_one,
    refuse_unloading,
    solved,
)
from metafem.models.interacting.influence import coupling_between, refuse_wide
from metafem.models.interacting.newton_krylov import NOT_RECORDED, ContactEquations, large_scene
from metafem.models.interacting.newton_krylov import TOLERANCE as FAST_TOLERANCE
from metafem.models.interacting.sums import find_grid, find_lattice
from metafem.notes import Note, information
from metafem.substrate import Radial, Substrate
from metafem.surface import Surface

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


# The results (6, m, k) of the kernel for m lists of heights, their tolerances (k,), the last state of the
# last list, a function that returns its dA0/dh (k, n) without the change of the pedestals, and notes.
Solved = tuple[FloatArray, FloatArray | float, State, Callable[[], FloatArray], tuple[Note, ...]]


@dataclass(frozen=True)
class ElasticCoupling:
    """Interacting asperities of one surface, with their contact law, substrate and order.

    They are solved with dense matrices, or with fast sums for larger scenes. `AdhesiveAsperities` solve them
    with adhesion.
    """

    model: Any  # to which the states refer
    surface: Surface
    law: Contact  # for unit E*
    substrate: Substrate  # with the thickness and the material of the surface
    order: int
    pedestal: bool

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
        found = self._solve(self.surface.height[None, :], values, by_load)
        self._refuse_thin_layer(found[0])
        return self._curve(self.surface.height, found)

    def sensitivity(self, height: FloatArray, load: FloatArray) -> Sensitivity:
        """Return the curve at increasing loads (k,), and dA0/dh at fixed load [mm], (k, n).

        The derivatives by all heights need one solution of a linear system per load. If fast sums are used,
        it is solved by conjugate gradients to 1e-9.
        """
        indentation = np.zeros((len(load), self.surface.count))
        found = self._solve(height[None, :], load, True, indentation)

        def gradient() -> FloatArray:
            plain = found[3]()
            if not self.pedestal:
                return plain
            carried = self.law.contacts(indentation, self.law.summits(self.surface)).load
            return self.on_pedestals(plain, height, carried)

        return Sensitivity(self._curve(height, found), gradient, indentation)

    def areas(self, height: FloatArray, radius: FloatArray | None, load: FloatArray) -> FloatArray:
        """Return A0 [mm^2] (m, k) for heights and radii (m, n); see `Model.areas`."""
        if radius is not None and self.summed is not None:
            return areas_one_by_one(self.model.curve, self.surface, load, height, radius, None)
        results, tolerance, *_ = self._solve(height, load, True, radius=radius)
        self._refuse_thin_layer(results)
        _, carried, area, _, residual, _ = results
        return np.where(solved(residual, tolerance, carried, area), area, np.nan)

    def _curve(self, height: FloatArray, found: Solved) -> Curve:
        results, tolerance, last, _, notes = found
        approach, load, area, stiffness, residual, _ = results[:, 0]

        def state() -> RescaledState:
            return self.state(height, last.load, math.pi * last.footprint, last.indentation, notes)

        return Curve(approach, load, area, stiffness, residual, tolerance, state)

    def _solve(
        self,
        height: FloatArray,
        control: FloatArray,
        by_load: bool,
        indentation: FloatArray = NOT_RECORDED,
        radius: FloatArray | None = None,
    ) -> Solved:
        """Return the solution for heights (m, n) at increasing loads or approaches (k,).

        radius: (m, n) [mm]; default: the surface's. `indentation` (k, n) [mm] is filled with the nominal
        indentations of the last list of heights unless empty.
        """
        gap = height.max(axis=1, keepdims=True) - height
        size = self.surface.radius if radius is None else radius
        own = np.zeros(height.shape) + self.pedestals(height, size)
        law = tables(self.law, np.broadcast_to(self.law.summits(self.surface, radius), gap.shape))
        if self.summed is None:
            return self._solve_dense(law, own, gap, control, by_load, indentation)
        sums, coarse = large_scene(self.surface, self.summed, self.order)
        own += sums.self_influence
        found = np.zeros((6, len(gap), len(control)))
        for row in range(len(gap)):
            equations = ContactEquations(sums, self.order, rows_of(law, row), own[row], gap[row], coarse)
            last = equations.follow(control, by_load, found[:, row], indentation)
        refuse_beyond(rows_of(law, -1), last.z, self.law)
        gradients = partial(equations.area_gradients, indentation)
        return found, FAST_TOLERANCE, last, gradients, (information(sums.note),)

    def _solve_dense(
        self,
        law: Law,
        own: FloatArray,
        gap: FloatArray,
        control: FloatArray,
        by_load: bool,
        indentation: FloatArray,
    ) -> Solved:
        """Return the solution with dense matrices; own: self terms of the pedestals (m, n) [1/mm]."""
        coupling, regular = coupling_between(self.surface, self.substrate, self.order)
        own = own + regular
        found = np.zeros((6, len(gap), len(control)))
        tolerance = np.full(len(control), ON_CURVE)  # those of the kernel
        tolerance[-1] = TOLERANCE
        control = np.array(control)  # a read-only array would compile the kernel again
        states = {}

        def run(rows: slice, loads: slice) -> None:
            state = State(self.surface.count)
            part = np.zeros_like(found[:, rows, loads], order="C")  # a view would compile the kernel again
            kernel.curves(
                coupling, self.order, rows_of(law, rows), own[rows], gap[rows], control[loads], by_load,
                part, state.block, state.closed, self._matrix(), indentation[loads],
            )  # fmt: skip
            found[:, rows, loads] = part
            states[rows.stop, loads.stop] = state

        (rows, loads), pairs = found.shape[1:], gap.size * self.surface.count * len(control)
        if rows == 1:
            run_rows(partial(run, slice(0, 1)), loads, pairs, PAIRS_PER_HALF)
        else:
            run_rows(partial(run, loads=slice(0, loads)), rows, pairs, PAIRS_PER_THREAD)
        for (end, _), state in states.items():
            refuse_beyond(rows_of(law, end - 1), state.z, self.law)

        def gradients() -> FloatArray:
            found = np.empty_like(indentation)
            system = coupling, self.order, rows_of(law, -1), own[-1]

            def run(part: slice) -> None:
                state = State(self.surface.count)
                area_gradients(
                    *system, indentation[part], state.block, state.closed, self._matrix(), found[part]
                )

            run_rows(run, len(found), len(found) * self.surface.count**2, PAIRS_PER_THREAD)
            return found

        return found, tolerance, states[rows, loads], gradients, ()

    def _matrix(self) -> FloatArray:
        """Return the matrix of one thread for Newton's method; order 1 needs none."""
        size = 0 if self.order == 1 else self.surface.count
        return np.zeros((size, size))

    def _refuse_thin_layer(self, results: FloatArray) -> None:
        """Raise InvalidInput if a contact exceeds the layer thickness or the cell: the expansion fails."""
        widest = float(results[kernel.RADIUS].max())
        refuse_wide(self.surface, widest)
        thickness = getattr(self.substrate, "thickness", None)
        # neither the solution nor its contact radii are accurate in this range
        if thickness is not None and widest > thickness:
            raise InvalidInput(
                f"the layer of {thickness:g} mm is thinner than the contacts: order {self.order} holds for "
                f"contact radii up to {thickness:g} mm; use resolved contacts or a thicker layer"
            )

    def pedestals(self, height: FloatArray, radius: FloatArray) -> FloatArray | float:
        """Return the displacement of each summit by the compliance of its cap, per unit of P/E* [1/mm]."""
        return pedestal_influence(height, radius)[0] if self.pedestal else 0.0

    def on_pedestals(self, gradient: FloatArray, height: FloatArray, load: FloatArray) -> FloatArray:
        """Return dA0/dh (k, n) [mm] with the change of the caps' compliance, at loads (k, n) [mm^2]."""
        if not self.pedestal:
            return gradient
        return gradient * (1.0 - pedestal_influence(height, self.surface.radius)[1] * load)

    def state(
        self,
        height: FloatArray,
        load: FloatArray,
        area: FloatArray,
        indentation: FloatArray,
        notes: tuple[Note, ...] = (),
    ) -> RescaledState:
        """Return the state of asperities (n,)."""
        # the foot of a cap sinks with its summit, while the adjacent base hardly sinks; the shift of a
        # contact adds less than a micrometre to the base gap
        base = height - indentation - self.pedestals(height, self.surface.radius) * load
        ratio, name = self.surface.height / self.surface.radius, "height of a summit over its radius"
        tall = int((ratio > TALLEST).sum())
        if self.pedestal and tall:
            text = f"{tall} summits are higher than {TALLEST:g} R; their pedestals are taken as that high"
            most = float(ratio.max())
            notes += (Note(text, quantity=name, value=most, bound=TALLEST, remedies=("radius",)),)
        if self.surface.cell is not None and not hasattr(self.substrate, "thickness"):
            text = (
                "the separation is measured from the mean plane of the deformed periodic surface: the mean "
                "displacement of a half-space diverges and is left out"
            )
            notes += (information(text),)
        return RescaledState(load, area, indentation, float(base.min()), self.model, notes)
