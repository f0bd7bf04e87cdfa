"""Seconds of the first demo after an installation, which compiles the kernels, and of the second."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from metafem._caches import VARIABLE
from validation.timing import Row

# For two idle cores, the installation apart [s]; the README states both together.
FIRST, SECOND = 60.0, 8.0

DEMO = [sys.executable, "-m", "metafem", "demo", "linear", "--force"]


def rows() -> list[Row]:
    """Run the demo twice in an empty folder with an empty cache."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, VARIABLE: str(Path(folder) / "caches")}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        environment["PYTHONPATH"] = str(Path(__file__).parents[2])

        def seconds() -> float:
            start = time.perf_counter()
            subprocess.run(DEMO, cwd=folder, env=environment, check=True, capture_output=True)
            return time.perf_counter() - start

        return [
            Row("the first demo, with all kernels to compile", FIRST, seconds(), "s"),
            Row("the second demo", SECOND, seconds(), "s"),
        ]
