"""Share of the misfit that each cause explains, and causes that the data do not distinguish."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from metafem._validate import FloatArray
from metafem.calibration.diagnosis.causes import GROUPS, Causes
from metafem.calibration.diagnosis.update import Posterior


def shares(causes: Causes, posterior: Posterior) -> tuple[dict[str, float], dict[str, float], float, float]:
    """Return the shares of the causes in the explained misfit, the largest first, and misfits.

    The last three values are the misfits without each cause, without all causes and with all causes.

    The misfit without causes is ``r'S^-1 r``. r are the residuals of the prior prediction, linearised at the
    posterior, and S is the covariance of the measurement including the loads. The misfit with all causes is
    ``r'(S + J J')^-1 r = r'S^-1 r - sum_c (J_c'S^-1 r).m_c`` with the posterior means m. Cause c explains the
    term c of this sum. The term is negative if the cause compensates an excess of another cause.
    """
    at = posterior.linear
    residual = at.residual + at.gradient @ posterior.mean
    information, force = at.gradient.T @ at.gradient, at.gradient.T @ residual
    matrix = information + np.eye(causes.size)
    square = float(residual @ residual)

    def without(places: Iterable[slice]) -> tuple[FloatArray, float]:
        """Return the posterior means (p,) and the misfit with the unknowns at `places` fixed at 0."""
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


# Remaining fraction of the prior variance above which the data do not determine a cause, even if all other
# causes are known.
UNSEEN = 0.7

# Remaining fraction of the prior variance above which a combination is unresolved (three quarters of the
# standard deviation).
UNRESOLVED = 0.55

# Smallest component of a combination that is stated, over the largest component.
NAMED = 0.3

# Number of steps of the rotation to combinations of few errors.
ROTATIONS = 50


@dataclass(frozen=True)
class Unresolved:
    """An error that the measured values do not determine, or several errors that compensate each other.

    Attributes
    ----------
    change : mapping of str to float
        Changes of the errors by one standard deviation [rad or relative]. Made together, the changes alter
        the measured values by less than the measurement errors.
    variance_left : float
        Posterior variance over prior variance [-].

    Examples
    --------
    >>> Unresolved({"composite_modulus": 0.03, "friction": 0.02}, 0.9).variance_left
    0.9
    """

    change: Mapping[str, float]
    variance_left: float


def unresolved(causes: Causes, covariance: FloatArray) -> tuple[Unresolved, ...]:
    """Return the unresolved errors and combinations of errors of the entire part.

    `covariance` (p, p) is the posterior covariance of the unknowns over their prior standard deviations. The
    combinations are eigenvectors of the block of `covariance` for the errors of the entire part. Unresolved
    eigenvectors are rotated within the space that they span until each combines few errors.
    """
    names = causes.common
    index = np.array([causes.where[name].start for name in names], dtype=np.intp)
    sd = np.array([causes.sd[name] for name in names])
    block = covariance[np.ix_(index, index)]
    # here the other errors of the entire part are known; the errors of asperities and loads are unknown
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
    """Return orthonormal vectors (q, u) that span the same space and have few large entries each.

    Varimax rotation: Kaiser, Psychometrika 23, 187 (1958), doi:10.1007/BF02289233.
    """
    rotated = vectors
    for _ in range(ROTATIONS if vectors.shape[1] > 1 else 0):
        target = rotated * (rotated**2 - (rotated**2).mean(axis=0))
        left, _, right = np.linalg.svd(vectors.T @ target)
        rotated = vectors @ (left @ right)
    return rotated
