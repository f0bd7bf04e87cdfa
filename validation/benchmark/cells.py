"""Random cells of 4 to 9 asperities with random heights and exponents: how many of their laws are recovered.

Run ``python -m validation.benchmark.cells``.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import metafem as mf
from validation.scenes.cells import LIMITS, PITCH, cell

# Number of cells, and the misfit of a recovered law.
CELLS, RECOVERED = 200, 2e-3

# Steps of the exponents that a design may have [-]; None for any exponent.
STEPS = (None, 0.01, 0.1)


def main() -> None:
    """Print how many laws are recovered, their misfits and the times."""
    for step in STEPS:
        name = "any exponents" if step is None else f"exponents in steps of {step:g}"
        _report(f"independent, {name}", step, CELLS, mf.Independent(mf.Elastic()))
    model = mf.Interacting(contact=mf.Elastic())
    _report("periodic at order 3, any exponents", None, CELLS, model, periodic=True)


def _report(name: str, step: float | None, trials: int, model: Any, periodic: bool = False) -> None:
    tools, misfits, times, worst = mf.PowerRange(1.2, 6.0, step), list[float](), list[float](), list[str]()
    for seed in range(trials):
        surface, load = cell(seed)
        if periodic:
            side = PITCH * np.ceil(np.sqrt(surface.count))
            surface = surface.replaced(cell=mf.PeriodicCell(side, side))
        law = mf.SampledLaw(load, model.curve(surface, load).area)
        template = surface.replaced(height=np.full(surface.count, LIMITS.max_height), cap=mf.Sphere())
        start = time.perf_counter()
        try:
            misfits.append(mf.design(law, template, model, LIMITS, tools=tools).misfit)
        except mf.Infeasible:
            misfits.append(np.inf)
        times.append(time.perf_counter() - start)
        if misfits[-1] > RECOVERED:
            worst.append(f"{seed} ({100.0 * misfits[-1]:.2g} %)")
    found = int((np.array(misfits) <= RECOVERED).sum())
    print(
        f"{name}: {found} of {trials} laws recovered to .2 %, median misfit {100 * np.median(misfits):.3f} %"
    )
    print(f"{name}: median {np.median(times):.3f} s, longest {max(times):.2f} s; not recovered: {len(worst)}")
    print(*worst[:10], sep=", ")


if __name__ == "__main__":
    main()
