"""How much of the misfit each cause explains."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.diagnosis.causes import GROUPS, Causes
from metafem.calibration.diagnosis.update import Posterior


class Shares(NamedTuple):
    """What each group of causes explains, the largest share first, and the misfit without and with all."""

    share: dict[str, float]  # of the explained misfit [-]
    without: dict[str, float]  # the misfit if a group is left out
    before: float
    after: float


def shares(causes: Causes, posterior: Posterior) -> Shares:
    """Return the share of each group of causes in the explained misfit.

    The misfit without causes is that of the values linearised at the posterior, ``r'S^-1 r``, with the
    residuals r of the prior prediction and the covariance S of the measurement, loads included. With all:
    ``r'(S + J J')^-1 r = r'S^-1 r - sum_c (J_c'S^-1 r).m_c`` with the posterior means m: cause c explains the
    term c. It is negative where a cause corrects what another one does too much.
    """
    from scipy.linalg import cho_factor, cho_solve

    at, load = posterior.linear, causes.where["load"]
    residual = at.residual + at.gradient @ posterior.mean
    information, force = at.gradient.T @ at.gradient, at.gradient.T @ residual
    matrix = information + np.eye(causes.size)
    square = float(residual @ residual)

    def solved(on: np.ndarray) -> tuple[FloatArray, float]:
        found = np.zeros(causes.size)
        found[on] = cho_solve(cho_factor(matrix[np.ix_(on, on)], lower=True), force[on])
        return found, square - float(force @ found)

    groups = {
        name: [causes.where[one] for one in members if one in causes.sd]
        for name, members in GROUPS.items()
        if any(one in causes.sd for one in members)
    }
    alone = np.zeros(causes.size, dtype=bool)
    alone[load] = True
    loads, before = solved(alone)
    means, after = solved(np.ones(causes.size, dtype=bool))
    terms = (force - information @ loads) * means
    share, without = {}, {}
    for name, places in groups.items():
        part = sum(float(terms[where].sum()) for where in places)
        share[name] = part / (before - after) if before > after else 0.0
        on = np.ones(causes.size, dtype=bool)
        for where in places:
            on[where] = False
        without[name] = solved(on)[1]
    order = sorted(share, key=lambda name: -share[name])
    return Shares(
        {name: share[name] for name in order}, {name: without[name] for name in order}, before, after
    )
