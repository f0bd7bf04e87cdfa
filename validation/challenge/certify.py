"""Choose the multipliers of the certificates, by nonnegative least squares.

python -m validation.challenge.certify
"""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
from scipy.optimize import nnls

from validation.challenge.certificates import FOLDER, Case, possible
from validation.challenge.task import Target, names, target

# Number of intervals of the area at the load that is divided.
CASES = 40


def certify(name: str) -> float:
    """Write the certificate of a target that divides the best load, and return its bound."""
    wanted = target(name)
    loads = [0] if wanted.friction.free else range(len(wanted.friction.load))
    found = max(
        (_certificate(wanted, load, 1 if wanted.friction.free else CASES) for load in loads), key=_least
    )
    bound, load, edges, cases = found
    lines = ",\n".join(f"    {json.dumps(each)}" for each in cases)
    head = (
        f'  "target": "{name}",\n  "bound": {bound:.6g},\n  "load": {load},\n  "edges": {json.dumps(edges)}'
    )
    (FOLDER / f"{name}.json").write_text(f'{{\n{head},\n  "cases": [\n{lines}\n  ]\n}}\n', "utf-8")
    return bound


def _least(found: tuple) -> float:
    return found[0]


def _certificate(wanted: Target, load: int, count: int) -> tuple:
    """Return the bound, the divided load, the edges of its intervals, and the multipliers of each case."""
    low, high = possible(wanted, load)
    edges = [float(f"{edge:.8g}") for edge in np.linspace(low - 1e-6, high + 1e-6, count + 1)]
    every = [Case(wanted, load, *ends) for ends in pairwise(edges)]
    cases = [_multipliers(case) for case in every]
    return min(case.bound(own) for case, own in zip(every, cases, strict=True)), load, edges, cases


def _multipliers(case: Case) -> list[tuple[str, int, int, float]]:
    """Return the multipliers of the best bound in one case.

    The x nearest to 1 with ``C x >= b`` is ``1 + C^T m/2``, where m solves the dual problem, minimise
    ``|C^T m|^2/4 - m.(b - C 1)``. It is a problem of nonnegative least squares (Lawson and Hanson, chapter
    23): with ``E = [C^T; (b - C 1)^T]`` and u >= 0 that minimises ``|E u - e|``, e the last unit vector, and
    the residual ``r = e - E u``, m is ``2 u/r_last``. Without such x, r is 0 and any large m is a proof.
    """
    lines = [case.constraint(row) for row in case.rows()]
    c, b = np.array([line for line, _ in lines]), np.array([least for _, least in lines])
    size = np.linalg.norm(c, axis=1)
    c, b = c / size[:, None], b / size
    e = np.vstack([c.T, b - c.sum(axis=1)])
    aim = np.append(np.zeros(c.shape[1]), 1.0)
    u, _ = nnls(e, aim, maxiter=10_000)
    multiplier = 2.0 * u / max((aim - e @ u)[-1], 1e-3) / size
    return [
        (*row, float(f"{m:.12g}")) for row, m in zip(case.rows(), multiplier.tolist(), strict=True) if m > 0.0
    ]


if __name__ == "__main__":
    for each in names():
        if target(each).level == "impossible":
            print(f"{each}: {100.0 * certify(each):.6g} %")
