"""Height maps: time and memory of a map of 36 megapixels, errors over the smallest possible, and coverage."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import metafem as mf
from validation.check import rms
from validation.scenes.cap_bound import smallest_errors
from validation.scenes.height_maps import Placement, Roughness, height_map
from validation.timing import Row

PIXEL, RADIUS = 2e-3, 0.526
LARGE = (6000, 6000)

# Correlation lengths of the roughness [mm].
LENGTHS = (4e-3, 8e-3, 12e-3, 20e-3, 30e-3)

# Maps of nine caps for each length.
MAPS = 12

MEASURED = """
import json, resource, sys, time
import numpy as np
import metafem as mf
from validation.benchmark.topography import lattice
mf.calibration.measured_surface  # imports
values = np.load(sys.argv[1])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
start = time.perf_counter()
made = mf.calibration.measured_surface(values, 2e-3, lattice(8))
taken = time.perf_counter() - start
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps([taken, (peak - before) / 1024, made.surface.count]))
"""


def rows() -> Iterator[Row]:
    """Measure a map of 12 x 12 mm in a process of its own, and small maps of several roughnesses."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "map.npy"
        np.save(path, height_map(lattice(8), LARGE, PIXEL))
        run = subprocess.run([sys.executable, "-c", MEASURED, str(path)], check=True, capture_output=True)
    taken, memory, count = json.loads(run.stdout)
    yield Row("map of 36 megapixels, 64 caps: time", 30.0, taken, "s")
    yield Row("memory beyond the map of 137 MiB", 512.0, memory, "MiB")
    yield Row("caps that were not measured", 0.0, 64.0 - count)
    for length in LENGTHS:
        error, score, bound = _errors(length)
        what = f"correlation length {1e3 * length:g} um, {len(error)} caps"
        yield Row(f"{what}: height error, root mean square", 0.1, 1e3 * rms(error[:, 2]), "um")
        yield Row(f"{what}: the smallest possible", 0.1, 1e3 * rms(bound), "um")
        yield Row(f"{what}: radius", 0.5, 100.0 * rms(error[:, 3]) / RADIUS, "%")
        yield Row(f"{what}: position", 0.5, 1e3 * rms(np.hypot(error[:, 0], error[:, 1])), "um")
        # of 108 values the coverage has a standard error of 4.5 %
        yield Row(f"{what}: coverage of 68 % off by, heights", 13.5, _off(score[:, 2]), "%")
        yield Row(f"{what}: coverage of 68 % off by, radii", 13.5, _off(score[:, 3]), "%")


def lattice(side: int) -> mf.Surface:
    """Return a square lattice of caps from 0.05 to 0.27 mm, in any order."""
    height = np.random.default_rng(side).permutation(np.linspace(0.05, 0.27, side * side))
    return mf.Surface.square_lattice(height, (side, side), radius=RADIUS, material=mf.Material(1.36))


def _errors(length: float):
    """Return errors (n, 4) of x, y, height and radius, over their standard errors too, and the bounds."""
    design = lattice(3)
    errors, scores = [], []
    for seed in range(MAPS):
        values = height_map(
            design, (2400, 2400), PIXEL, placement=Placement(0.01, (2.4011, 2.3993)),
            roughness=Roughness(length=length), rng=seed,
        )  # fmt: skip
        made = mf.calibration.measured_surface(values, PIXEL, design)
        error = np.column_stack([made.position_error, made.height_error, made.radius_error])
        errors.append(error)
        scores.append(
            error / np.column_stack([made.position_sd, made.position_sd, made.height_sd, made.radius_sd])
        )
    bound = [smallest_errors(h, RADIUS, Roughness(length=length))[0] for h in design.height.tolist()]
    return np.concatenate(errors), np.concatenate(scores), np.array(bound)


def _off(score: np.ndarray) -> float:
    return 100.0 * abs(float((np.abs(score) < 1.0).mean()) - 0.6827)
