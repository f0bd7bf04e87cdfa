"""Objectives of an arrangement: relative differences of A0, whose sum of squares is minimised."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.contact import Contact
from metafem.errors import refuse_if
from metafem.inversion.placement.exchange import Coupled, Forecast, Joined, Sites, Tilted
from metafem.models import Independent, Model
from metafem.models.model import contact_of
from metafem.surface import STEEPEST, Surface

# Default misalignment [rad]: Aymard et al. state the change of their laws for this angle,
# doi:10.1126/science.adk4234.
TILT = math.radians(0.1)

# Number of evenly spaced directions of the tilt. Five or more give the exact mean square over all directions
# for changes of up to second order in the tilt.
DIRECTIONS = 6


@dataclass(frozen=True, eq=False, init=False, repr=False)
class FollowLaw(Value):
    """Minimise the deviation of the law under the model from a curve A(P).

    The residuals are ``r_k = (A0(P_k)/A_k - 1) / sqrt(K)``, so the misfit is the root mean square over K
    loads. With too few loads the law does not improve between them. For 64 asperities 20 loads are enough.

    Parameters
    ----------
    rescaled_load : array_like, (K,)
        P/E* [mm^2], positive and increasing.
    rescaled_friction : array_like, (K,), optional
        The curve F/(sigma B) [mm^2], positive and increasing; default: the law of independent asperities.

    Raises
    ------
    InvalidInput
        If the arrays differ in length, a value is not finite, or the points do not increase.

    Examples
    --------
    >>> FollowLaw([0.1, 0.2]).rescaled_friction is None
    True
    """

    rescaled_load: FloatArray
    rescaled_friction: FloatArray | None

    def __init__(self, rescaled_load: ArrayLike, rescaled_friction: ArrayLike | None = None) -> None:
        load = _loads(rescaled_load)
        friction = None
        if rescaled_friction is not None:
            friction = check.array("rescaled_friction", rescaled_friction, shape=(len(load),))
            friction = check.increasing("rescaled_friction", friction)
        object.__setattr__(self, "rescaled_load", load)
        object.__setattr__(self, "rescaled_friction", friction)

    def residual(self, surface: Surface, model: Model) -> FloatArray:
        """Return the residuals, (K,) [-]."""
        area = model.curve(surface, self.rescaled_load).area
        return np.asarray((area / self._target(surface, model) - 1.0) / math.sqrt(len(area)))

    def forecast(self, surface: Surface, model: Model, sites: Sites) -> Forecast:
        """Return the predicted residuals ``-sum_ij dA0/dh_i G_ij P_j/E*``, relative to the curve.

        Displacements due to the loads on other asperities act like a decrease of the heights. The gradients
        and the loads are those of the current arrangement.
        """
        found = model.gradient_model.sensitivity(surface, self.rescaled_load)
        law = _law(model, surface)
        summits = law.summits(surface)
        load = law.load(law.contact_radius(found.indentation, summits), summits)
        weight = -found.gradient / (self._target(surface, model)[:, None] * math.sqrt(len(load)))
        rows = sites.indices(surface.position)
        left, right = (_spread(values, rows, sites, 0.0) for values in (weight, load))
        return Coupled(left, right, sites.influence)

    def _target(self, surface: Surface, model: Model) -> FloatArray:
        if self.rescaled_friction is not None:
            return self.rescaled_friction
        return Independent(contact=_law(model, surface)).curve(surface, self.rescaled_load).area


@dataclass(frozen=True, eq=False, init=False, repr=False)
class InsensitiveToTilt(Value):
    """Minimise the change of the law due to a small misalignment of the plane.

    A tilt by (t_x, t_y) raises the summits by ``x_i t_x + y_i t_y``. To first order, this changes A0 at a
    fixed load by ``sum_i dA0/dh_i (x_i t_x + y_i t_y)``. The gradients dA0/dh_i sum to zero, so these first
    moments do not depend on the origin. For independent Hertz contacts they are the first moments of
    ``pi R_i - c sqrt(R_i d_i)``. A tilt of 0.1 degrees raises a summit at 10 mm by 17 um, as much as many
    indentations. The misfit is therefore the rms of the full change A0(tilted)/A0 - 1 over the loads and six
    directions.

    Parameters
    ----------
    rescaled_load : array_like, (K,)
        P/E* [mm^2], positive and increasing.
    angle : float
        Tilt [rad], up to pi/4; default: 0.1 degrees. For small tilts the misfit depends only on the first
        moments.

    Raises
    ------
    InvalidInput
        If the loads do not increase, or the angle is outside its range.

    Examples
    --------
    >>> InsensitiveToTilt([0.1, 0.2]).rescaled_load
    array([0.1, 0.2])
    """

    rescaled_load: FloatArray
    angle: float

    def __init__(self, rescaled_load: ArrayLike, angle: float = TILT) -> None:
        object.__setattr__(self, "rescaled_load", _loads(rescaled_load))
        object.__setattr__(self, "angle", check.number("angle", angle, above=0.0, at_most=STEEPEST))

    def residual(self, surface: Surface, model: Model) -> FloatArray:
        """Return the residuals, (6 K,) [-]."""
        surface.refuse_tilt()
        heights = surface.height + np.vstack([np.zeros(surface.count), self._lifts(surface.position)])
        level, *tilted = model.areas(surface, self.rescaled_load, heights)
        return np.ravel(tilted / level - 1.0) / math.sqrt(DIRECTIONS * len(level))

    def forecast(self, surface: Surface, model: Model, sites: Sites) -> Forecast:
        """Return the predicted changes of A0 for independent asperities at the same loads."""
        found = model.gradient_model.sensitivity(surface, self.rescaled_load)
        depth, law = found.indentation, _law(model, surface)
        radius = law.summits(surface)
        a, size = law.contact_radius(depth, radius), np.broadcast_to(radius, depth.shape)
        rate = law.area_slope(a, size).sum(axis=1) / law.stiffness(a, size).sum(axis=1)
        scale = 1.0 / (found.curve.area * math.sqrt(DIRECTIONS * len(depth)))
        # an asperity that no tilt brings into contact represents an empty site
        rows = sites.indices(surface.position)
        depth, radius = _spread(depth, rows, sites, -math.inf), _spread(radius, rows, sites, 1.0)
        return Tilted(law, depth, radius, self._lifts(sites.position), scale, rate)

    def _lifts(self, position: FloatArray) -> FloatArray:
        """Return the rise of each site by each tilt, (6, m) [mm]."""
        direction = 2.0 * math.pi * np.arange(DIRECTIONS) / DIRECTIONS
        slope = math.tan(self.angle) * np.stack([np.cos(direction), np.sin(direction)], axis=1)
        return np.asarray(slope @ position.T)


@dataclass(frozen=True, init=False)
class WeightedObjectives:
    """Weighted combination of objectives, ``sum_i w_i misfit_i^2``.

    Parameters
    ----------
    objectives : sequence of objectives
    weights : array_like, optional
        Positive weights; default: equal weights. They are divided by their sum.

    Raises
    ------
    InvalidInput
        If there is no objective, the number of weights differs, or a weight is not positive.

    Examples
    --------
    >>> load = [0.1, 0.2]
    >>> WeightedObjectives([FollowLaw(load), InsensitiveToTilt(load)], [3.0, 1.0]).weights
    (0.75, 0.25)
    """

    objectives: tuple[Objective, ...]
    weights: tuple[float, ...]

    def __init__(self, objectives: Sequence[Objective], weights: ArrayLike | None = None) -> None:
        parts = tuple(objectives)
        refuse_if(not parts, "objectives is empty; at least one is needed")
        for i, part in enumerate(parts):
            check.instance(f"objectives[{i}]", part, Objective, "such as metafem.FollowLaw(...)")
        values = check.array("weights", np.ones(len(parts)) if weights is None else weights,
                             shape=(len(parts),))  # fmt: skip
        refuse_if(values.min() <= 0.0, f"weights holds {values.min():g}; all must be greater than 0")
        object.__setattr__(self, "objectives", parts)
        object.__setattr__(self, "weights", tuple((values / values.sum()).tolist()))

    def residual(self, surface: Surface, model: Model) -> FloatArray:
        """Return the residuals of all objectives, multiplied by the square roots of their weights, (q,)."""
        pairs = zip(self.weights, self.objectives, strict=True)
        return np.concatenate([math.sqrt(w) * part.residual(surface, model) for w, part in pairs])

    def forecast(self, surface: Surface, model: Model, sites: Sites) -> Forecast:
        """Return the forecasts of all objectives, multiplied by the square roots of their weights."""
        parts = tuple(part.forecast(surface, model, sites) for part in self.objectives)
        return Joined(tuple(math.sqrt(w) for w in self.weights), parts)


# An objective defines the misfit of an arrangement by relative differences of A0, and predicts them.
Objective = FollowLaw | InsensitiveToTilt | WeightedObjectives


def _law(model: Model, surface: Surface) -> Contact:
    """Return the contact law of a model for the material of a surface."""
    return contact_of(model).bound(surface)


def _spread(values: FloatArray, rows: IntArray, sites: Sites, vacant: float) -> FloatArray:
    """Return values of asperities (..., n) for all sites (..., m), with `vacant` at empty sites."""
    result = np.full((*values.shape[:-1], len(sites.position)), vacant, values.dtype)
    result[..., rows] = values
    return result


def _loads(given: ArrayLike) -> FloatArray:
    return check.increasing("rescaled_load", check.array("rescaled_load", given, shape=(None,)))
