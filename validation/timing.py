"""Rows of required and measured numbers, and how times are measured."""

from __future__ import annotations

import resource
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import metafem as mf
from metafem._kernels import continuation
from metafem.models.contact_tables import tables
from metafem.models.interacting.influence import coupling_between
from metafem.models.interacting.large import NOT_RECORDED


@dataclass(frozen=True)
class Row:
    """A measured number and the largest one that is allowed, in the same unit."""

    what: str
    required: float
    measured: float
    unit: str


def best(work: Callable[[], object], repeats: int) -> float:
    """Shortest time of several runs [s], after one run that is not timed."""
    work()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def processor_time(command: list[str], repeats: int = 3) -> float:
    """Least processor time of a command [s], after one run that fills the file cache."""
    times = []
    for _ in range(repeats + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    return min(times[1:])


def kernel_time(model: mf.Interacting, surface: mf.Surface, loads: int) -> float:
    """Seconds per load of one curve inside the compiled kernel, on one core, compilation excluded."""
    bound = model.substrate.for_surface(surface)
    coupling, self_influence = coupling_between(surface, bound, model.order)
    results = continuation.empty_results(1, loads)
    workspace = continuation.empty_workspace(surface.count, model.order)
    rising = np.linspace(0.5 / loads, 0.5, loads)
    law = tables(model.contact.for_material(surface.material), surface.radius[None])
    gap = surface.gap[None]
    arguments = (
        coupling,
        model.order,
        law,
        self_influence[None],
        gap,
        rising,
        True,
        results,
        *workspace,
        NOT_RECORDED,
    )
    return best(lambda: continuation.curves(*arguments), 20) / loads
