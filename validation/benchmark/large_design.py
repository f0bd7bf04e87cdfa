"""Time, memory and size of the report of a design of 10,000 asperities with its part files."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from metafem.files import demo_text
from validation.timing import Row, spent

# Rows of the lattice, and the width of a block that holds it at the pitch of the demo.
SIDE, BLOCK = 100, '"156 mm"'


def rows() -> list[Row]:
    """Run `metafem design` on a lattice of 100 x 100 in a separate process."""
    text = demo_text("linear").replace("shape = [8, 8]", f"shape = [{SIDE}, {SIDE}]")
    for length in ("width", "length"):
        text = text.replace(f'{length} = "20 mm"', f"{length} = {BLOCK}")
    with tempfile.TemporaryDirectory() as parent:
        Path(parent, "large.toml").write_text(text, "utf-8")
        command = [sys.executable, "-m", "metafem", "design", "large.toml", "-o", "large", "--json"]
        used = spent(command, cwd=parent)
        page = Path(parent, "large", "report.html").stat().st_size
    return [
        Row("design of 10,000 asperities with part files", 30.0, used.seconds, "s"),
        Row("peak memory of that design", 1.0, used.memory, "GiB"),
        Row("size of its report", 5.0, page / 1e6, "MB"),
    ]
