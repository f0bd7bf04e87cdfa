"""Curves of interacting contacts; each equilibrium is predicted from the previous ones.

Each nominal indentation z is nearly linear in the approach x, and exactly linear without interaction. The
prediction is the cubic that has the values and the tangents of the last two equilibria.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels import projected_cg
from metafem._kernels.compiled import compiled, inlined
from metafem._kernels.contact import hertz, tabulated
from metafem._kernels.coupling import State, copy, empty_state, quadratic_form, spread
from metafem._kernels.interacting import TOLERANCE, Scratch, empty_scratch, rates, refresh, settle

# Relative residual of the tangent. The stiffness is stationary at the tangent and has twice as many correct
# digits.
TANGENT = 1e-4

# Largest distance beyond the last equilibrium at which the cubic is used, divided by the distance between the
# two equilibria that define it.
REACH = 3.0

# Newton steps for the approach of a prediction, after a first step along the tangent. After two steps their
# error is below the error of the cubic.
PREDICTOR_STEPS = 2


class Memory(NamedTuple):
    """The last two equilibria of a curve: z and dz/dx of each, and the cubic through them; arrays (n,)."""

    before: np.ndarray
    before_rate: np.ndarray
    last: np.ndarray
    last_rate: np.ndarray
    square: np.ndarray  # coefficients of the cubic; `tangent` uses `square` as scratch
    cube: np.ndarray


class Results(NamedTuple):
    """Results of the equilibria of m surfaces at k loads or approaches, (m, k)."""

    approach: np.ndarray  # [mm]
    load: np.ndarray  # P/E* [mm^2]
    area: np.ndarray  # [mm^2]
    stiffness: np.ndarray  # dP/dx [mm]
    residual: np.ndarray
    radius: np.ndarray  # contact radius of the largest contact [mm]
    steps: np.ndarray  # number of Newton steps, including those from rejected predictions


def empty_memory(count: int) -> Memory:
    """Return an empty memory for `count` asperities."""
    return Memory(*(np.zeros(count) for _ in Memory._fields))


def empty_results(rows: int, columns: int) -> Results:
    """Return empty result arrays for `curves`."""
    return Results(*(np.zeros((rows, columns)) for _ in Results._fields))


def empty_workspace(count: int, order: int) -> tuple[State, Memory, Scratch]:
    """Return the arrays of one thread: state, memory and scratch."""
    return empty_state(count), empty_memory(count), empty_scratch(count, order)


@compiled
def uniform_approach(gap, law, load):
    """Return the approach [mm] at which independent asperities carry `load` within 10 %."""
    radius, which, scale, data = law
    x = math.inf
    for i in range(gap.size):  # asperity i needs this approach to carry the load by itself: an upper bound
        if data.size == 0:
            alone = hertz.indentation_at_load(radius[i], load)
        else:
            alone = tabulated.indentation_at_load(data, which[i], scale[i], load)
        x = min(x, gap[i] + alone)
    low, high = gap.min(), math.inf
    for _ in range(60):
        p = slope = 0.0
        for i in range(gap.size):
            d = x - gap[i]
            if d > 0.0:
                if data.size == 0:
                    a = hertz.contact_radius(radius[i], d)
                    own, rate = hertz.LOAD * a * d, hertz.STIFFNESS * a
                else:
                    own, rate = tabulated.load_and_rate(data, which[i], scale[i], d)
                p += own
                slope += rate
        if 0.9 * load <= p <= 1.01 * load:
            break
        if p < load:
            low = x
        else:
            high = x
        # if the load is convex, Newton's method does not overshoot from the right; a plastic load is concave
        x = x - (p - load) / slope if slope > 0.0 else low
        if not low < x < high:
            x = 0.5 * (low + high)
    return x


@compiled
def extrapolate(memory, points, width, ahead, law, z):
    """Fill z at a distance `ahead` beyond the last equilibrium; return its load and dP/dx."""
    radius, which, scale, data = law
    plain = data.size == 0
    cubic = points > 1 and ahead <= REACH * width
    load = slope = 0.0
    for i in range(z.size):
        square = memory.square[i] if cubic else 0.0
        cube = memory.cube[i] if cubic else 0.0
        z[i] = memory.last[i] + ahead * (memory.last_rate[i] + ahead * (square + ahead * cube))
        if z[i] > 0.0:
            if plain:
                a = hertz.contact_radius(radius[i], z[i])
                own, rate = hertz.LOAD * a * z[i], hertz.STIFFNESS * a
            else:
                own, rate = tabulated.load_and_rate(data, which[i], scale[i], z[i])
            load += own
            slope += rate * (memory.last_rate[i] + ahead * (2.0 * square + 3.0 * ahead * cube))
    return load, slope


@compiled
def predict(memory, points, width, ahead, target, law, z):
    """Fill the predicted z; return its distance: `ahead`, or the distance that gives a target load > 0."""
    if points > 1:
        for i in range(z.size):
            chord = (memory.last[i] - memory.before[i]) / width
            e = (memory.last_rate[i] - chord) / width
            f = (memory.before_rate[i] - memory.last_rate[i]) / width
            memory.square[i] = 3.0 * e + f
            memory.cube[i] = (2.0 * e + f) / width
    load, slope = extrapolate(memory, points, width, ahead, law, z)
    if target > 0.0:
        for _ in range(PREDICTOR_STEPS):
            if not (slope > 0.0):
                break
            ahead = max(0.0, ahead - (load - target) / slope)
            load, slope = extrapolate(memory, points, width, ahead, law, z)
    return ahead


@inlined
def tangent(field, order, self_term, state, count, points, memory, scratch):
    """Fill memory.last_rate = dz/dx and scratch.loads = dp/dP; return dP/dx [mm], or infinity if unstable."""
    matrix = refresh(field, order, self_term, state, count, scratch, False)
    load_rate = scratch.loads
    total = compliance = 0.0
    for k in range(count):
        i = state.closed[k]
        memory.square[i] = load_rate[i] if points > 0 else 0.0
        total += memory.square[i]
        compliance += 1.0 / abs(scratch.diagonal[i])
    load_rate[:] = 0.0
    warm = points > 0 and total > 0.5
    if warm:
        for k in range(count):
            load_rate[state.closed[k]] = memory.square[state.closed[k]] / total
    scratch.rhs[:] = 0.0
    shift, good = projected_cg.solve(
        matrix, scratch.diagonal, state.closed, count, True, 1.0, scratch.rhs,
        TANGENT / compliance, warm, load_rate, scratch.work,
    )  # fmt: skip
    rates(state, count, shift, scratch, memory.last_rate)
    for i in range(load_rate.size):
        memory.last_rate[i] /= shift
    form = quadratic_form(field, order, self_term, state, count, load_rate, scratch.work[1], scratch.work[2])
    return 1.0 / form if good and form > 0.0 else math.inf


@inlined
def independent_start(gap, law, control, by_load, z):
    """Fill the z of independent asperities; return the approach."""
    start = uniform_approach(gap, law, control) if by_load else control
    for i in range(z.size):
        z[i] = start - gap[i]
    return start


@compiled
def curves(field, order, law, self_term, gap, control, by_load, results, state, memory, scratch, all_z):
    """Fill the results (m, k) of m surfaces; fill `all_z` (k, n) with z of the last surface unless empty.

    self_term, gap and the arrays of the law are (m, n); control (k,) contains increasing loads or approaches.
    """
    n = gap.shape[1]
    load_rate = np.zeros(n)
    for row in range(gap.shape[0]):
        points = 0
        x = width = 0.0
        law_of_row = tabulated.part(law, row)
        for j in range(control.size):
            results.approach[row, j] = 0.0 if by_load else control[j]
            if control[j] <= 0.0:
                for i in range(n):
                    state.z[i] = min(results.approach[row, j], 0.0) - gap[row, i]
                    state.indentation[i] = state.z[i]
                    state.load[i] = state.square[i] = state.footprint[i] = 0.0
                if all_z.size > 0:
                    copy(state.z, all_z[j])
                continue
            target = control[j] if by_load else 0.0
            alone = points == 0
            while True:
                if alone:
                    start = independent_start(gap[row], law_of_row, control[j], by_load, state.z)
                else:
                    ahead = control[j] - x
                    if by_load:
                        ahead = (target - results.load[row, j - 1]) / results.stiffness[row, j - 1]
                    start = x + predict(memory, points, width, ahead, target, law_of_row, state.z)
                new, count, load, residual, steps = settle(
                    field, order, law_of_row, self_term[row], gap[row], start, target, state, scratch
                )
                results.steps[row, j] += steps
                if residual <= TOLERANCE or alone:
                    break
                alone = True  # a prediction can fail if new contacts form
            if all_z.size > 0:
                copy(state.z, all_z[j])
            results.approach[row, j] = new
            results.load[row, j] = load
            results.residual[row, j] = residual
            results.area[row, j], results.radius[row, j] = areas(order, law_of_row, state, count)
            if residual > TOLERANCE or count == 0:
                points = 0
                continue
            copy(memory.last, memory.before)
            copy(memory.last_rate, memory.before_rate)
            copy(state.z, memory.last)
            copy(load_rate, scratch.loads)
            stiffness = tangent(field, order, self_term[row], state, count, points, memory, scratch)
            results.stiffness[row, j] = stiffness
            if stiffness == math.inf:  # the equilibrium is not a minimum of the energy
                results.residual[row, j] = 1.0
                points = 0
                continue
            copy(scratch.loads, load_rate)
            width = new - x
            x = new
            points = min(2, points + 1) if width > 0.0 else 1


@compiled
def areas(order, law, state, count):
    """Fill the areas; return their sum [mm^2], and the largest contact radius [mm]."""
    area = largest = 0.0
    if order > 1 and law.data.size > 0:
        spread(order, law, state)
    else:
        copy(state.square, state.footprint)
    for k in range(count):
        i = state.closed[k]
        area += state.footprint[i]
        largest = max(largest, state.square[i])
    return math.pi * area, math.sqrt(largest)
