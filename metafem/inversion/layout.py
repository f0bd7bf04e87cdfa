"""Which asperity stands where: of no matter alone, but for interaction and misalignment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.inversion.exchange import Forecast, after, drawn, exchanged, swap
from metafem.inversion.judge import UNCOUPLED
from metafem.inversion.objectives import Objective
from metafem.models import Interacting, Model
from metafem.substrate import HalfSpace
from metafem.surface import Surface

# Arrangements, the given one among them, from which a forecast's best exchanges are followed.
STARTS = 3

# Exchanges that a forecast follows before it is measured against the model, at most.
MOST_EXCHANGES = 64

# Measurements of the forecast's error along the way to the best arrangement.
CORRECTIONS = 24

# Misfit at which nothing more is tried: the errors of made heights change A0 by tens of times more.
GOAL = 1e-4

# Exchanges, the best by the forecast, that are tried on the model at each step of the last descent.
TRIED = 12

# Steps of the last descent.
LAST_STEPS = 16


@dataclass(frozen=True, eq=False)
class Arrangement:
    """A surface whose asperities were assigned to its places.

    Attributes
    ----------
    surface : Surface
    order : ndarray of int, (n,)
        Asperity of the given surface that stands at each place.
    before, after : float
        Misfit of the objective [-] under the model as given and as arranged.
    objective : Objective
    model : Model
    """

    surface: Surface
    order: IntArray
    before: float
    after: float
    objective: Objective
    model: Model


def arrange(surface: Surface, objective: Objective, model: Model | None = None, rng: Any = 0) -> Arrangement:
    """Assign the asperities of a surface, each height with its radius, to its places.

    The objective's residuals are forecast to first order in the interaction for all exchanges of two
    asperities at once; the best are followed from several random starts, measured under the model, and
    the forecast is corrected by what it missed. The best arrangement then descends by exchanges that the
    model itself has confirmed. The result is never worse than what was given; a misfit of 1e-4 is enough.

    Parameters
    ----------
    surface : Surface
    objective : FollowLaw, InsensitiveToTilt, or several Together
    model : Model, optional
        Under which the objective is to hold, `Interacting()` unless told.
    rng : int or numpy Generator
        Seed of the random starts.

    Returns
    -------
    Arrangement

    Raises
    ------
    InvalidInput
        For arguments that cannot be used.
    NotConverged
        If an equilibrium of the model did not converge.

    Notes
    -----
    For independent asperities the places do not matter, so `FollowLaw` leaves them as they are.

    Examples
    --------
    >>> import metafem as mf
    >>> height = 0.1 + 0.002 * np.arange(16)
    >>> surface = mf.Surface.square_lattice(height, (4, 4), radius=0.526, material=mf.Material(1.36))
    >>> result = mf.arrange(surface, mf.InsensitiveToTilt([0.05, 0.1]))
    >>> result.after < 0.5 * result.before
    True
    """
    solver: Model = Interacting() if model is None else model
    check.instance("surface", surface, Surface, "a metafem.Surface")
    check.instance("model", solver, Model, "a model such as metafem.Interacting()")
    check.instance("objective", objective, Objective, "such as metafem.FollowLaw(...)")
    generator = check.generator(rng)
    forecast = objective.forecast(surface, _influence(surface, solver))
    search = _Search(surface, objective, solver, forecast, generator)
    first = search.measured(np.arange(surface.count))
    best = first
    for start in range(STARTS):
        if _misfit(best) <= GOAL:
            break
        order = first.order if start == 0 else generator.permutation(surface.count)
        found = search.corrected(first if start == 0 else search.measured(order))
        best = min(best, found, key=_squares)
    best = search.confirmed(best)
    best.order.flags.writeable = False
    placed = search.placed(best.order)
    return Arrangement(placed, best.order, _misfit(first), _misfit(best), objective, solver)


@dataclass(frozen=True, eq=False)
class _Measured:
    """An order of the asperities with its residuals under the model (q,)."""

    order: IntArray
    residual: FloatArray


def _squares(found: _Measured) -> float:
    return float(found.residual @ found.residual)


def _misfit(found: _Measured) -> float:
    return float(np.sqrt(_squares(found)))


@dataclass(frozen=True, eq=False)
class _Search:
    surface: Surface
    objective: Objective
    model: Model
    forecast: Forecast
    rng: np.random.Generator

    def placed(self, order: IntArray) -> Surface:
        """Return the surface with asperity order[i] at place i."""
        return self.surface.replaced(height=self.surface.height[order], radius=self.surface.radius[order])

    def measured(self, order: IntArray) -> _Measured:
        """Return the order with its residuals under the model."""
        return _Measured(order, self.objective.residual(self.placed(order), self.model))

    def corrected(self, best: _Measured) -> _Measured:
        """Follow the forecast; what it missed corrects it, and where it led astray it is trusted less."""
        trusted = MOST_EXCHANGES
        for _ in range(CORRECTIONS):
            if _misfit(best) <= GOAL:
                break
            missed = best.residual - self.forecast.placed(best.order).residual()
            order = exchanged(self.forecast, missed, best.order, trusted, self.rng)
            if (order == best.order).all():
                break
            found = self.measured(order)
            if _squares(found) < _squares(best):
                best = found
            elif trusted == 1:
                break
            else:
                trusted = max(1, trusted // 3)
        return best

    def confirmed(self, best: _Measured) -> _Measured:
        """Make the exchanges that lower the misfit under the model, the best by the forecast first."""
        for _ in range(LAST_STEPS):
            if _misfit(best) <= GOAL:
                break
            places = drawn(self.surface.count, self.rng)
            squares = after(best.residual, self.forecast.placed(best.order).changes(places))
            squares[np.tril_indices(len(places))] = np.inf
            trials = []
            for flat in np.argsort(squares, axis=None, kind="stable")[:TRIED]:
                a, b = np.unravel_index(int(flat), squares.shape)
                order = best.order.copy()
                swap(order, int(places[a]), int(places[b]))
                trials.append(self.measured(order))
            found = min([best, *trials], key=_squares)
            if found is best:
                break
            best = found
        return best


def _influence(surface: Surface, model: Model) -> FloatArray:
    """Return the influence of the places on each other; that of the half-space where a model has none."""
    if isinstance(model, UNCOUPLED):
        return np.zeros((surface.count, surface.count))
    substrate = model.substrate if isinstance(model, Interacting) else HalfSpace()
    return np.array(substrate.influence_matrix(surface), dtype=np.float64)
