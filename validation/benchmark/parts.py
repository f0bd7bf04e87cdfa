"""Time and memory of writing the part, its mould and its drawing, each in a separate process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

from validation.timing import Row

# Rows of a square lattice, and the allowed seconds and megabytes.
CASES = ((8, 5.0, 300.0), (100, 30.0, 1024.0))

WORK = """
import resource, sys, tempfile, time
from pathlib import Path
import numpy as np
import metafem as mf
from metafem.files import PartOptions, planned

rows = int(sys.argv[1])
height = 0.084 + np.random.default_rng(0).uniform(0.0, 0.12, rows**2)
block = mf.Block(1.6 * rows, 1.6 * rows, 7.2)
lattice = {"radius": 0.526, "material": mf.Material(1.36), "block": block}
surface = mf.Surface.square_lattice(height, (rows, rows), **lattice)
start = time.perf_counter()
with tempfile.TemporaryDirectory() as folder:
    planned(surface, surface, PartOptions()).write(Path(folder))
print(time.perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
"""


def rows() -> Iterator[Row]:
    """Measure the part, its mould and its drawing."""
    for lattice, seconds, megabytes in CASES:
        command = [sys.executable, "-c", WORK, str(lattice)]
        printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        spent, used = (float(number) for number in printed.split())
        what = f"files of a part of {lattice**2:,} asperities"
        yield Row(what, seconds, spent, "s")
        yield Row(f"{what}, peak memory", megabytes, used, "MiB")
