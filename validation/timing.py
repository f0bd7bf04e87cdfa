"""Rows of required and measured numbers, and how times are measured."""

from __future__ import annotations

import os
import resource
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

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
    unit: str = ""


def best(work: Callable[[], object], repeats: int) -> float:
    """Shortest time of several runs [s], after one run that is not timed."""
    work()
    return min(took(work)[0] for _ in range(repeats))


def took(work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds of one run, and its result."""
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def peak_memory() -> float:
    """Peak memory of this process until now [GiB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20


@dataclass(frozen=True)
class Spent:
    """What a process took: seconds on the clock and of its processor, and its peak memory [GiB]."""

    seconds: float
    processor: float
    memory: float


def spent(command: Sequence[str], **options: Any) -> Spent:
    """Run a command, with options of `subprocess.Popen`, and measure what it takes; it must end with 0."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, **quiet, **options)
    seconds, (_, status, used) = took(lambda: os.wait4(process.pid, 0))
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return Spent(seconds, used.ru_utime + used.ru_stime, used.ru_maxrss / 2**20)


def kernel_time(model: mf.Interacting, surface: mf.Surface, loads: int) -> float:
    """Seconds per load of one curve inside the compiled kernel, on one core, compilation excluded."""
    bound = model.substrate.for_surface(surface)
    coupling, self_influence = coupling_between(surface, bound, model.order)
    results = continuation.empty_results(1, loads)
    workspace = continuation.empty_workspace(surface.count, model.order)
    rising = np.linspace(0.5 / loads, 0.5, loads)
    law = tables(model.contact.bound(surface), surface.radius[None])
    scene = (coupling, model.order, law, self_influence[None], surface.gap[None], rising)
    work = partial(continuation.curves, *scene, True, results, *workspace, NOT_RECORDED)
    return best(work, 20) / loads
