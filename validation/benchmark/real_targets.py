"""Targets of random real surfaces under their own model: refusals, misses and times of their designs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich.console import Console
from rich.progress import track

from validation.scenes.real_targets import outcome, real_target
from validation.timing import Row

TARGETS = 1000

# Misfit above which a design misses its target.
MISSED = 2e-3


def rows() -> Iterator[Row]:
    """Design the targets of 1,000 random surfaces. The time of a design without a surface counts as well."""
    outcome(real_target(0))  # compiles the kernels
    shown = Console(stderr=True)
    found = [outcome(real_target(seed)) for seed in track(range(TARGETS), "targets", console=shown)]
    misfit, seconds = np.array([(each.misfit, each.seconds) for each in found]).T
    refused = np.isinf(misfit)
    yield Row(f"{TARGETS} targets of real surfaces: refused", 0.0, refused.sum())
    missed = 100.0 * (misfit[~refused] > MISSED).sum() / TARGETS
    yield Row(f"missed by more than {MISSED:.1%}", 0.5, missed, "%")
    yield Row("median time of a design", 0.05, float(np.median(seconds)), "s")
    yield Row("99 % of the times are below", 0.3, float(np.quantile(seconds, 0.99)), "s")
    for law in sorted({each.law for each in found}):
        which = np.array([each.law == law for each in found])
        lost = which & (misfit > MISSED)
        yield Row(f"{law}, {which.sum()} targets: refused or missed", 0.005 * which.sum(), lost.sum())
        yield Row(f"{law}: 99 % of the times", 0.3, float(np.quantile(seconds[which], 0.99)), "s")
