"""Assignment of asperities to sites, which affects interaction and the sensitivity to misalignment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.inversion.placement.exchange import (
    EXCHANGE_GAIN,
    FEW_SITES,
    FORECAST_SITES,
    Forecast,
    Sites,
    after,
    sites_for,
    swap,
)
from metafem.inversion.placement.objectives import Objective
from metafem.models import Independent, Interacting, Model
from metafem.models.model import contact_of
from metafem.progress import each
from metafem.surface import Surface

# Value of `Arrangement.order` at an empty site.
EMPTY = -1

# Maximum number of rounds of exchanges. The first two rounds start from the initial arrangement, the others
# from the best arrangement after random exchanges, whose number is this fraction of the number of sites. The
# forecasts of the model and of independent asperities alternate: one of them is better for few levels, the
# other for many different heights.
MOST_ROUNDS, EXCHANGED_FRACTION = 8, 0.1

# Maximum number of exchanges by one forecast before the model is evaluated; with many sites, a quarter of the
# number of sites.
MOST_EXCHANGES = 16

# Maximum number of model evaluations in one round.
MOST_EVALUATIONS = 24

# Misfit at which the search ends: height errors change A0 by tens of times more.
GOAL = 1e-4

# Number of exchanges that are evaluated under the model in each final step, those with the best forecasts,
# and maximum number of final steps.
EVALUATED_EXCHANGES, LAST_STEPS = 40, 16

# Exchanges end at this predicted misfit, which is far below the error of the forecast.
FORECAST_GOAL = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Arrangement(Value):
    """A surface whose asperities were assigned to sites by `arrange`.

    Attributes
    ----------
    surface : Surface
    position : ndarray, (m, 2)
        Positions of all sites [mm], including empty sites.
    order : ndarray of int, (m,)
        For each site, the index of its asperity in the original surface; -1 for an empty site.
    sites : ndarray of int, (n,)
        Site of each asperity of the arranged surface: ``surface.position = position[sites]`` and
        ``surface.height = original.height[order[sites]]``.
    before, after : float
        Misfit of the objective [-] under the model for the original and for the arranged surface.
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
    position: FloatArray
    order: IntArray
    sites: IntArray
    before: float
    after: float
    objective: Objective
    model: Model


def arrange(
    surface: Surface,
    objective: Objective,
    model: Model | None = None,
    rng: Any = 0,
    *,
    position: ArrayLike | None = None,
) -> Arrangement:
    """Return an arrangement: the asperities of a surface assigned to its sites, or also to additional sites.

    Each asperity keeps its height and radius. The residuals of the objective are predicted to first order,
    simultaneously for all exchanges of two asperities. The best exchanges are made, the model is evaluated,
    and the prediction is recomputed. These steps are repeated from random changes of the best arrangement.
    Finally, only exchanges that lower the misfit under the model itself are made. If there are empty sites,
    a second search starts from the best result and includes them. The misfit never increases, and the search
    ends at a misfit of 1e-4. With more than 128 sites there are fewer trials. Thousands of sites take
    minutes.

    Parameters
    ----------
    surface : Surface
    objective : FollowLaw, InsensitiveToTilt, or several `WeightedObjectives`
    model : Model, optional
        Model under which the misfit of the objective is lowered; default: ``Interacting()``.
    rng : int or numpy Generator
        Seed of the random exchanges.
    position : array_like, (m, 2), optional
        Positions of all sites [mm], such as ``design.template.position``. They must include the exact
        positions of the surface; there may be more sites than asperities. Default: the positions of the
        surface.

    Returns
    -------
    Arrangement

    Raises
    ------
    InvalidInput
        If an argument is outside its range or has the wrong type, if `position` lacks a position of the
        surface or repeats a position, or if the sites need too much memory, 24 bytes for each pair of sites.
    NotConverged
        If an equilibrium of the model did not converge.

    Notes
    -----
    The law of independent asperities does not depend on the sites, so `FollowLaw` does not change them.

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
    where, known = sites_for(surface, solver, position)
    count, total = surface.count, len(where.position)
    given, occupied = np.full(total, EMPTY), where.indices(surface.position)
    given[occupied] = np.arange(count)
    search = _Search(surface, where, np.sort(occupied), objective, known, check.generator(rng))
    first = search.measured(given)
    best = search.best(first)
    if total > count:
        best = replace(search, open_sites=np.arange(total)).best(best)
    order, sites = best.order, np.flatnonzero(best.order != EMPTY)
    for array in (order, sites):
        array.flags.writeable = False
    return Arrangement(
        best.surface, where.position, order, sites, first.misfit, best.misfit, objective, solver
    )


@dataclass(frozen=True, eq=False)
class _Measured:
    """An assignment of asperities to sites with its residuals (q,) [-] under the model."""

    order: IntArray
    surface: Surface
    residual: FloatArray

    @property
    def misfit(self) -> float:
        """Root of the sum of squares of the residuals [-]."""
        return float(np.sqrt(self.residual @ self.residual))


@dataclass(frozen=True, eq=False)
class _Search:
    surface: Surface
    sites: Sites
    open_sites: IntArray
    objective: Objective
    model: Model
    rng: np.random.Generator

    def affordable(self, most: int) -> int:
        """Return the number of trials: `most` up to 128 sites, fewer for more sites.

        The time for a trial grows at least with the square of the number of sites.
        """
        return min(most, most * FEW_SITES**2 // len(self.open_sites) ** 2)

    def best(self, first: _Measured) -> _Measured:
        """Return the best arrangement found by exchanges between `open_sites`, starting from `first`."""
        best, independent = first, Independent(contact=contact_of(self.model))
        tries = range(max(1, self.affordable(MOST_ROUNDS)))
        for k in each("round", tries, at_most=True):
            if best.misfit <= GOAL:
                break
            start = first if k < 2 else self.disturbed(best)
            best = min(
                best, self.corrected(start, (self.model, independent)[k % 2]), key=attrgetter("misfit")
            )
        return self.confirmed(best)

    def measured(self, order: IntArray) -> _Measured:
        """Return an assignment (m,) with its residuals under the model."""
        sites = np.flatnonzero(order != EMPTY)
        surface = self.surface.only(order[sites], position=self.sites.position[sites])
        return _Measured(order, surface, self.objective.residual(surface, self.model))

    def disturbed(self, best: _Measured) -> _Measured:
        """Return the arrangement after random exchanges."""
        order = best.order.copy()
        for _ in range(max(2, int(EXCHANGED_FRACTION * len(self.open_sites)))):
            i, j = self.rng.choice(self.open_sites, 2)
            swap(order, int(i), int(j))
        return self.measured(order)

    def drawn(self) -> IntArray:
        """Return the sites whose exchanges are forecast in one step: all sites, or random ones if many."""
        if len(self.open_sites) <= FORECAST_SITES:
            return self.open_sites
        return np.asarray(self.rng.choice(self.open_sites, FORECAST_SITES, replace=False))

    def exchanged(self, best: _Measured, forecast: Forecast, most: int) -> IntArray:
        """Return the assignment (m,) after at most `most` exchanges.

        Each exchange is the one with the smallest predicted sum of squares. The error of the forecast is
        assumed constant.
        """
        order, residual = best.order.copy(), best.residual
        for _ in range(most):
            if residual @ residual <= FORECAST_GOAL**2:
                break
            sites = self.drawn()
            change = forecast.changes(sites)
            squares = after(residual, change)
            a, b = np.unravel_index(int(squares.argmin()), squares.shape)
            if not squares[a, b] < residual @ residual * (1.0 - EXCHANGE_GAIN):
                break
            residual = residual + change[:, a, b]
            i, j = int(sites[a]), int(sites[b])
            swap(order, i, j)
            forecast = forecast.swapped(i, j)
        return order

    def corrected(self, best: _Measured, model: Model) -> _Measured:
        """Return the arrangement after exchanges by the forecast.

        After an improvement the forecast is recomputed; otherwise fewer exchanges are made at a time.
        """
        most = max(MOST_EXCHANGES, len(self.open_sites) // 4)
        forecast = self.objective.forecast(best.surface, model, self.sites)
        for _ in each("exchange", range(MOST_EVALUATIONS), at_most=True):
            if best.misfit <= GOAL:
                break
            order = self.exchanged(best, forecast, most)
            if (order == best.order).all():
                break
            found = self.measured(order)
            if found.misfit < best.misfit:
                best, forecast = found, self.objective.forecast(found.surface, model, self.sites)
            elif most == 1:
                break
            else:
                most = max(1, most // 3)
        return best

    def confirmed(self, best: _Measured) -> _Measured:
        """Return the arrangement after exchanges that each lower the misfit under the model.

        In each step the exchanges with the best forecasts are evaluated under the model.
        """
        for _ in each("last step", range(self.affordable(LAST_STEPS)), at_most=True):
            if best.misfit <= GOAL:
                break
            sites = self.drawn()
            forecast = self.objective.forecast(best.surface, self.model, self.sites)
            squares = after(best.residual, forecast.changes(sites))
            squares[np.tril_indices(len(sites))] = np.inf
            trials = []
            for flat in np.argsort(squares, axis=None, kind="stable")[:EVALUATED_EXCHANGES]:
                a, b = np.unravel_index(int(flat), squares.shape)
                order = best.order.copy()
                swap(order, int(sites[a]), int(sites[b]))
                trials.append(self.measured(order))
            found = min([best, *trials], key=attrgetter("misfit"))
            if found is best:
                break
            best = found
        return best
