"""Initial guess of a resolved solution: Hertzian contacts coupled as point loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Hertz

# Tolerance of the initial guess, whose model is less accurate than this.
TOLERANCE = 1e-6
MAX_STEPS = 50
MAX_HALVINGS = 8

# With a larger residual the guess is no better than independent contacts.
GIVEN_UP = 0.1


@dataclass(frozen=True, eq=False)
class Start:
    """Indentations d (n,) [mm], negative where open, and the approach [mm]."""

    indentation: FloatArray
    approach: float


def start(
    influence: FloatArray,
    gap: FloatArray,
    radius: FloatArray,
    *,
    approach: float | None = None,
    load: float | None = None,
    guess: Start | None = None,
) -> Start:
    """Solve ``d + K P(d) + gap - approach = 0`` by damped Newton steps on the closed contacts.

    Parameters
    ----------
    influence : ndarray, (n, n)
        K [1/mm].
    gap, radius : ndarray, (n,)
        Depths below the tallest summit and radii [mm].
    approach, load : float, optional
        One of them: the approach [mm], or the sum of P/E* [mm^2], which must be positive.
    guess : Start, optional
        A neighbouring solution.
    """
    law = Hertz()
    if guess is not None:
        d, z = guess.indentation, guess.approach if approach is None else approach
    else:
        if approach is None:
            assert load is not None
            # the tallest alone would have the largest indentation, n equal ones the smallest
            z = float(law.indentation_at_load(load, radius[gap.argmin()]))
        else:
            z = approach
        d = z - gap
    error = np.inf
    for _ in range(MAX_STEPS):
        a = law.contact_radius(d, radius)
        p = law.load(a, radius)
        f = d + influence @ p + gap - z
        slope = law.stiffness(a, radius)
        error = _error(f, d, p, load)
        if error <= TOLERANCE:
            break
        step, rise = _newton_step(influence, f, slope, None if load is None else load - float(p.sum()))
        for halvings in range(MAX_HALVINGS):
            share = 0.5**halvings
            new, height = d + share * step, z + share * rise
            q = law.load_at_indentation(new, radius)
            if _error(new + influence @ q + gap - height, new, q, load) < error:
                break
        d, z = new, height
    if error > GIVEN_UP and influence.any():
        # on very thin layers the point-load model has no solution
        return start(np.zeros_like(influence), gap, radius, approach=approach, load=load)
    return Start(d, z)


def _error(f: FloatArray, d: FloatArray, p: FloatArray, load: float | None) -> float:
    largest = float(np.abs(f).max()) / float(np.abs(d).max())
    return largest if load is None else largest + abs(float(p.sum()) - load) / load


def _newton_step(
    influence: FloatArray, f: FloatArray, slope: FloatArray, missing: float | None
) -> tuple[FloatArray, float]:
    """Return the steps of d and of the approach; `missing` is the load that is still to be carried."""
    closed = np.flatnonzero(slope > 0.0)
    part = influence[:, closed] * slope[closed]
    matrix = part[closed] + np.eye(closed.size)
    right = np.stack([-f[closed], np.ones(closed.size)], axis=1)
    fixed, per_rise = np.linalg.solve(matrix, right).T
    rise = 0.0
    if missing is not None:
        rise = (missing - float(slope[closed] @ fixed)) / float(slope[closed] @ per_rise)
    step = rise - f
    closed_step = fixed + rise * per_rise
    step = step - part @ closed_step
    step[closed] = closed_step
    return step, rise
