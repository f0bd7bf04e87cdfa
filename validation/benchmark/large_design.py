"""Time, memory and size of the report of a design of 10,000 asperities with its part files."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from metafem.files import demo_text
from validation.timing import Row

# Rows of the lattice, and the width of a block that holds it at the pitch of the demo.
SIDE, BLOCK = 100, '"156 mm"'


def rows() -> list[Row]:
    """Run `metafem design` on a lattice of 100 x 100 in a separate process."""
    text = demo_text("linear").replace("shape = [8, 8]", f"shape = [{SIDE}, {SIDE}]")
    text = text.replace('width = "20 mm"', f"width = {BLOCK}").replace(
        'length = "20 mm"', f"length = {BLOCK}"
    )
    with tempfile.TemporaryDirectory() as parent:
        Path(parent, "large.toml").write_text(text, "utf-8")
        command = [sys.executable, "-m", "metafem", "design", "large.toml", "-o", "large", "--json"]
        start = time.perf_counter()
        process = subprocess.Popen(command, cwd=parent, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            raise RuntimeError(f"the design ended with {process.returncode}")
        page = Path(parent, "large", "report.html").stat().st_size
    return [
        Row("design of 10,000 asperities with part files", 30.0, seconds, "s"),
        Row("peak memory of that design", 1.0, used.ru_maxrss / 2**20, "GiB"),
        Row("size of its report", 5.0, page / 1e6, "MB"),
    ]
