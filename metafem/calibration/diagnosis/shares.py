"""The share of the misfit that each cause explains, and causes that the data do not distinguish."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from metafem._validate import FloatArray
from metafem.calibration.diagnosis.causes import GROUPS, Causes
from metafem.calibration.diagnosis.update import Posterior


def shares(causes: Causes, posterior: Posterior) -> tuple[dict[str, float], dict[str, float], float, float]:
    """Return the share of each group of causes in the explained misfit, the largest first.

    The other values are the misfit without each group, without all groups and with all groups.

    The misfit without causes is that of the values linearised at the posterior, ``r'S^-1 r``, with the
    residuals r of the prior prediction and the covariance S of the measurement, loads included. With all:
    ``r'(S + J J')^-1 r = r'S^-1 r - sum_c (J_c'S^-1 r).m_c`` with the posterior means m: cause c explains the
    term c. It is negative if the cause corrects an excess of another one.
    """
    at = posterior.linear
    residual = at.residual + at.gradient @ posterior.mean
    information, force = at.gradient.T @ at.gradient, at.gradient.T @ residual
    matrix = information + np.eye(causes.size)
    square = float(residual @ residual)

    def without(places: Iterable[slice]) -> tuple[FloatArray, float]:
        """Return the means of the other unknowns and their misfit."""
        on, found = np.ones(causes.size, dtype=bool), np.zeros(causes.size)
        for where in places:
            on[where] = False
        found[on] = cho_solve(cho_factor(matrix[np.ix_(on, on)], lower=True), force[on])
        return found, square - float(force @ found)

    loads, before = without(where for name, where in causes.where.items() if name != "load")
    means, after = without(())
    terms = (force - information @ loads) * means
    groups = {
        name: [causes.where[one] for one in members if one in causes.sd] for name, members in GROUPS.items()
    }
    share = {
        name: sum(float(terms[where].sum()) for where in places) / (before - after) if before > after else 0.0
        for name, places in groups.items()
        if places
    }
    share = dict(sorted(share.items(), key=lambda item: -item[1]))
    return share, {name: without(groups[name])[1] for name in share}, before, after


# Share of the prior variance above which a cause is not seen, even with all other causes known.
UNSEEN = 0.7

# Share of the prior variance above which a combination is unresolved: three quarters of the standard
# deviation.
UNRESOLVED = 0.55

# Smallest component of a combination that is named, over the largest component.
NAMED = 0.3

# Steps of the rotation to combinations of few errors.
ROTATIONS = 50


@dataclass(frozen=True)
class Unresolved:
    """Errors that the measured values do not determine: one, or several that compensate each other.

    Attributes
    ----------
    change : mapping of str to float
        Changes of the errors by one standard deviation [rad or relative]; together they remain within the
        errors of the measurement.
    variance_left : float
        Variance that the measurement leaves, over that of the prior [-].

    Examples
    --------
    >>> Unresolved({"composite_modulus": 0.03, "friction": 0.02}, 0.9).variance_left
    0.9
    """

    change: Mapping[str, float]
    variance_left: float


def unresolved(causes: Causes, covariance: FloatArray) -> tuple[Unresolved, ...]:
    """Return what is not resolved among the errors of the whole part.

    covariance: of the unknowns over their prior standard deviations, (p, p). The combinations are
    eigenvectors of the posterior covariance relative to the prior one, with all other unknowns free. Those
    that are not resolved are rotated in their space until each has few errors.
    """
    names = causes.common
    index = np.array([causes.where[name].start for name in names], dtype=np.intp)
    sd = np.array([causes.sd[name] for name in names])
    block = covariance[np.ix_(index, index)]
    # the other errors of the whole part are known; single errors and loads stay unknown
    unseen = 1.0 / np.diag(np.linalg.inv(block)) > UNSEEN
    found = [Unresolved({names[i]: sd[i].item()}, float(block[i, i])) for i in np.flatnonzero(unseen)]
    seen = np.flatnonzero(~unseen)
    part = block[np.ix_(seen, seen)]
    values, vectors = np.linalg.eigh(part)
    for vector in _sparse(vectors[:, values >= UNRESOLVED]).T:
        vector = vector * np.sign(vector[np.abs(vector).argmax()])
        left = float(vector @ part @ vector)
        size = np.sqrt(left) * vector * sd[seen]
        large = np.flatnonzero(np.abs(vector) >= NAMED * np.abs(vector).max())
        found.append(Unresolved({names[seen[i]]: float(size[i]) for i in large}, left))
    return tuple(found)


def _sparse(vectors: FloatArray) -> FloatArray:
    """Return orthonormal vectors (q, u) of the same space with few large entries each.

    Varimax: Kaiser, Psychometrika 23, 187 (1958), doi:10.1007/BF02289233.
    """
    rotated = vectors
    for _ in range(ROTATIONS if vectors.shape[1] > 1 else 0):
        target = rotated * (rotated**2 - (rotated**2).mean(axis=0))
        left, _, right = np.linalg.svd(vectors.T @ target)
        rotated = vectors @ (left @ right)
    return rotated
