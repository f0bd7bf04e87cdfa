"""How much of the misfit each cause explains."""

from __future__ import annotations

import numpy as np

from metafem.calibration.diagnosis.causes import GROUPS, Causes
from metafem.calibration.diagnosis.update import Posterior


def shares(causes: Causes, posterior: Posterior) -> tuple[dict[str, float], float, float]:
    """Return the share of each cause in the explained misfit [-], the misfit without any, and with all.

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
    loads = cho_solve(cho_factor(matrix[load, load], lower=True), force[load])
    before = float(residual @ residual - force[load] @ loads)
    means = cho_solve(cho_factor(matrix, lower=True), force)
    terms = (force - information[:, load] @ loads) * means
    parts = {
        name: sum(float(terms[causes.where[one]].sum()) for one in members if one in causes.sd)
        for name, members in GROUPS.items()
        if any(one in causes.sd for one in members)
    }
    explained = sum(parts.values())
    found = {name: part / explained if explained > 0.0 else 0.0 for name, part in parts.items()}
    return found, before, before - explained
