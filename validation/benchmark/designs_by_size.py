"""Times and misfits of designs and drafts of 64 to 10,000 asperities on a layer."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import metafem as mf
from metafem.inversion.problem import drafting
from metafem.inversion.targets.target import Target
from metafem.models.model import Model
from validation.scenes.sized_designs import LAYER, tasks, template
from validation.timing import Row, best, took

# Largest time of a design by the number of asperities, and of a draft of 400 by its model [s].
SECONDS, LARGEST = {64: 0.1, 400: 0.3, 1600: 1.0}, {10_000: 10.0}
DRAFTS = {"independent": (mf.Independent(), 0.05), "layer": (LAYER, 0.12)}

# Largest misfit of each target: 1 % counts as reached, and the heights of a density have their own intercept.
MISFIT = {"linear": 0.03, "operating points": 1e-9, "sampled": 1e-3, "power": 1e-3, "line over a range": 4e-3}


def rows() -> Iterator[Row]:
    """Measure designs of up to 1600 asperities, and drafts of 400."""
    for count, allowed in SECONDS.items():
        yield from _designs(count, allowed)
    for name, (model, allowed) in DRAFTS.items():
        for kind, task in tasks(400).items():
            seconds = best(partial(_draft, model, *task), 5)
            yield Row(f"draft, 400 asperities, {kind}, {name}", allowed, seconds, "s")


def long_rows() -> Iterator[Row]:
    """Measure designs of 10,000 asperities."""
    for count, allowed in LARGEST.items():
        yield from _designs(count, allowed)


def _designs(count: int, allowed: float) -> Iterator[Row]:
    for kind, (target, limits) in tasks(count).items():
        times, designs = {}, {}
        for name, model in (("independent", mf.Independent()), ("layer", LAYER)):
            # the first run compiles kernels and is counted only if it is the faster one
            runs = [took(partial(mf.design, target, template(count), model, limits)) for _ in range(3)]
            times[name], designs[name] = min(seconds for seconds, _ in runs), runs[-1][1]
        what = f"{count:,} asperities, {kind}"
        yield Row(f"{what}: time", allowed, times["layer"], "s")
        yield Row(f"{what}: misfit", MISFIT[kind], designs["layer"].misfit)
        yield Row(
            f"{what}: time over the independent design", float("inf"), times["layer"] / times["independent"]
        )


def _draft(model: Model, target: Target, limits: mf.Limits) -> mf.Design:
    with drafting():
        return mf.design(target, template(400), model, limits)
