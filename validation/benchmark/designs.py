"""Times of the paper's designs, of 10,000 laws at once, and of the commands."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import numpy as np

import metafem as mf
from validation.paper.surfaces import fig3, fig4, fig5
from validation.timing import Row, best, spent

SURFACES, LOADS, ASPERITIES = 10_000, 100, 64

# The claims that need the independent model only.
INDEPENDENT = (
    "bounds", "equations", "fig3_operating_points", "fig4_linear", "fig5_bilinear", "table_s1", "table_s2",
)  # fmt: skip


def rows() -> list[Row]:
    """Measure designs, laws, commands and the claims of the independent model."""
    points = fig3()

    def coupled(substrate: mf.HalfSpace | mf.BondedLayer) -> mf.Design:
        return mf.design(points.target, points.template, mf.Interacting(substrate=substrate), points.limits)

    measured = [
        Row(f"one design, {name}", allowed, 1e3 * best(work, 10), "ms")
        for name, allowed, work in (
            ("operating points", 20.0, fig3),
            ("linear law", 2.0, lambda: fig4("red")),
            ("bilinear law", 20.0, lambda: fig5("red")),
            ("operating points on a half-space", 15.0, lambda: coupled(mf.HalfSpace())),
            ("operating points on a layer", 15.0, lambda: coupled(mf.BondedLayer())),
        )
    ]
    height = np.random.default_rng(0).exponential(0.03, (SURFACES, ASPERITIES))
    load = np.linspace(0.01, 0.6, LOADS)
    seconds = best(lambda: mf.Independent().curves(height, 0.526, load), 3)
    measured.append(Row("10⁶ points of A0(P), 64 asperities", 2.0, seconds, "s"))
    metafem = [sys.executable, "-m", "metafem"]
    # the first run fills the file cache
    _, *helps = (spent([*metafem, "--help"]).processor for _ in range(4))
    measured.append(Row("metafem --help, processor time", 0.25, min(helps), "s"))
    with tempfile.TemporaryDirectory() as folder:
        # A separate cache shows the first run on a machine; the second run reads it.
        environment = os.environ | {"METAFEM_CACHE_DIR": str(Path(folder) / "cache")}
        demo = [*metafem, "demo", "linear", "--force", "--json"]
        for what, allowed in (("the first time", 45.0), ("once compiled", 8.0)):
            seconds = spent(demo, cwd=folder, env=environment).seconds
            measured.append(Row(f"metafem demo linear, {what}", allowed, seconds, "s"))
        seconds = spent([sys.executable, "-m", "validation", "-o", folder, *INDEPENDENT]).seconds
    measured.append(Row("validation of the independent model", 30.0, seconds, "s"))
    return measured
