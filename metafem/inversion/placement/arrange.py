"""Which asperity stands where: of no matter alone, but for interaction and misalignment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.inversion.placement.exchange import Forecast, after, drawn, exchanged, swap
from metafem.inversion.placement.objectives import Objective
from metafem.inversion.placement.sites import Places, places_for
from metafem.models import Independent, Interacting, Model
from metafem.progress import each
from metafem.surface import Surface

# Places up to which everything is tried as often as stated here; of more, less often.
FEW_PLACES = 128

# Times that a forecast's best exchanges are followed: from the given arrangement, and from the best one
# after it was stirred by exchanges at random, as many as this share of the places. By turns the forecast is
# that of the model and that of independent asperities: one serves few levels better, the other many heights.
MOST_TRIES, STIRRED = 8, 0.1

# What `Arrangement.order` holds where no asperity stands.
EMPTY = -1

# Exchanges that a forecast follows before it is measured against the model, at most; of many places a
# quarter of their number.
MOST_EXCHANGES = 16

# Measurements along the way to the best arrangement.
CORRECTIONS = 24

# Misfit at which nothing more is tried: the errors of made heights change A0 by tens of times more.
GOAL = 1e-4

# Exchanges, the best by the forecast, that are tried on the model at each step of the last descent.
TRIED = 40

# Steps of the last descent.
LAST_STEPS = 16


@dataclass(frozen=True, eq=False, repr=False)
class Arrangement(Value):
    """A surface whose asperities were assigned to its places.

    Attributes
    ----------
    surface : Surface
    places : ndarray, (m, 2)
        All places [mm], empty ones among them.
    order : ndarray of int, (m,)
        Asperity of the given surface that stands at each place, -1 where none does.
    sites : ndarray of int, (n,)
        Place of each asperity of the arranged surface: ``surface.position = places[sites]`` and
        ``surface.height = given.height[order[sites]]``.
    before, after : float
        Misfit of the objective [-] under the model as given and as arranged.
    objective : Objective
    model : Model

    Examples
    --------
    >>> import metafem as mf
    >>> height = 0.1 + 0.002 * np.arange(4)
    >>> surface = mf.Surface.square_lattice(height, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> found = mf.arrange(surface, mf.InsensitiveToTilt([0.05, 0.1]), mf.Independent())
    >>> bool((found.surface.height == surface.height[found.order[found.sites]]).all())
    True
    >>> found.after <= found.before
    True
    """

    surface: Surface
    places: FloatArray
    order: IntArray
    sites: IntArray
    before: float
    after: float
    objective: Objective
    model: Model


@checked_call
def arrange(
    surface: Surface,
    objective: Objective,
    model: Model | None = None,
    rng: Any = 0,
    *,
    places: ArrayLike | None = None,
) -> Arrangement:
    """Assign the asperities of a surface, each height with its radius, to its places or to some of more.

    The objective's residuals are forecast to first order for all exchanges of two asperities at once; the
    best are followed, measured under the model, and the forecast is renewed there. The best arrangement is
    stirred and followed again some times, and then descends by exchanges that the model itself has
    confirmed. Places that are empty so far take part in a second round, from the best of the first. The
    result is never worse than what was given; a misfit of 1e-4 is enough. Of more than 128 places less is
    tried: minutes for thousands of them.

    Parameters
    ----------
    surface : Surface
    objective : FollowLaw, InsensitiveToTilt, or several Together
    model : Model, optional
        Under which the objective is to hold, `Interacting()` unless told.
    rng : int or numpy Generator
        Seed of what is drawn at random.
    places : array_like, (m, 2), optional
        Where asperities may stand [mm], as ``design.template.position``: those of the surface, which it
        must hold to the bit, and more, of which as many stay empty. The surface's own unless told.

    Returns
    -------
    Arrangement

    Raises
    ------
    InvalidInput
        For arguments that cannot be used, places that lack one of the surface's or hold one twice, and
        more places than fit into the memory, 24 bytes for each pair.
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
    where, known = places_for(surface, solver, places)
    count, total = surface.count, len(where.position)
    given, own = np.full(total, EMPTY), where.numbers(surface.position)
    given[own] = np.arange(count)
    search = _Search(surface, where, np.sort(own), objective, known, check.generator(rng))
    first = search.measured(given)
    best = search.best(first)
    if total > count:
        best = replace(search, open_=np.arange(total)).best(best)
    order, sites = best.order, np.flatnonzero(best.order != EMPTY)
    for array in (order, sites):
        array.flags.writeable = False
    return Arrangement(
        best.surface, where.position, order, sites, _misfit(first), _misfit(best), objective, solver
    )


@dataclass(frozen=True, eq=False)
class _Measured:
    """An order of the asperities with its residuals under the model (q,)."""

    order: IntArray
    surface: Surface
    residual: FloatArray


def _squares(found: _Measured) -> float:
    return float(found.residual @ found.residual)


def _misfit(found: _Measured) -> float:
    return float(np.sqrt(_squares(found)))


def _affordable(most: int, places: int) -> int:
    """Return how often something is tried: the work grows at least with the square of the places."""
    return min(most, most * FEW_PLACES**2 // places**2)


@dataclass(frozen=True, eq=False)
class _Search:
    surface: Surface
    places: Places
    open_: IntArray
    objective: Objective
    model: Model
    rng: np.random.Generator

    def best(self, first: _Measured) -> _Measured:
        """Return the best arrangement that is found from one, with the open places taking part."""
        best = first
        tries = range(max(1, _affordable(MOST_TRIES, len(self.open_))))
        for k in each("try", tries, at_most=True):
            if _misfit(best) <= GOAL:
                break
            start = first if k < 2 else self.stirred(best)
            best = min(best, self.corrected(start, (self.model, Independent())[k % 2]), key=_squares)
        return self.confirmed(best)

    def measured(self, order: IntArray) -> _Measured:
        """Return the order with its residuals under the model."""
        sites = np.flatnonzero(order != EMPTY)
        surface = self.surface.replaced(
            position=self.places.position[sites],
            height=self.surface.height[order[sites]],
            radius=self.surface.radius[order[sites]],
        )
        return _Measured(order, surface, self.objective.residual(surface, self.model))

    def stirred(self, best: _Measured) -> _Measured:
        """Exchange some asperities at random."""
        order = best.order.copy()
        for _ in range(max(2, int(STIRRED * len(self.open_)))):
            i, j = self.rng.choice(self.open_, 2)
            swap(order, int(i), int(j))
        return self.measured(order)

    def forecast(self, best: _Measured, model: Model) -> Forecast:
        """Return the forecast about an order."""
        return self.objective.forecast(best.surface, model, self.places)

    def corrected(self, best: _Measured, model: Model) -> _Measured:
        """Follow the forecast, renewed wherever it led on; where it led astray it is trusted less."""
        trusted = max(MOST_EXCHANGES, len(self.open_) // 4)
        forecast = self.forecast(best, model)
        for _ in each("round", range(CORRECTIONS), at_most=True):
            if _misfit(best) <= GOAL:
                break
            missed = best.residual - forecast.residual()
            order = exchanged(forecast, missed, best.order, self.open_, trusted, self.rng)
            if (order == best.order).all():
                break
            found = self.measured(order)
            if _squares(found) < _squares(best):
                best, forecast = found, self.forecast(found, model)
            elif trusted == 1:
                break
            else:
                trusted = max(1, trusted // 3)
        return best

    def confirmed(self, best: _Measured) -> _Measured:
        """Make the exchanges that lower the misfit under the model, the best by the forecast first."""
        for _ in each("last step", range(_affordable(LAST_STEPS, len(self.open_))), at_most=True):
            if _misfit(best) <= GOAL:
                break
            places = drawn(self.open_, self.rng)
            squares = after(best.residual, self.forecast(best, self.model).changes(places))
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
