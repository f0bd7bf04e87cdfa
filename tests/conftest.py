"""Settings, scenes and results that tests share."""

import fcntl
import gc
import json
import os
from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import settings

import metafem as mf
from metafem import cli

# Property tests draw the same cases on every run and are never timed.
settings.register_profile("metafem", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("metafem")

# One process compiles the kernels of interacting asperities in the first file, which takes 20 s. The second
# runs the next files, which need none of them.
FIRST = (
    *("models/test_contract.py", "fe/block3d/test_block3d.py", "fe/axisymmetric/test_press.py"),
    *("validation/test_benchmarks.py", "studies/test_element_checks.py"),
)

# Examples that solve finite elements for longer than a few seconds.
SLOW_EXAMPLES = (
    *("hertz_check", "cap_check", "cell_check", "layer_check"),
    *("FiniteContact", "press_finite", "tabulated_contact"),
    *("search_contact", "ActiveSetContact", "measure_pedestal"),
)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark the examples that take long as slow, and sort the files: large ones first, to end together."""
    for item in items:
        if isinstance(item, pytest.DoctestItem) and item.name.endswith(SLOW_EXAMPLES):
            item.add_marker("slow")
    count = Counter(item.path for item in items)
    first = [Path(__file__).parent / name for name in FIRST]
    items.sort(key=lambda i: (first.index(i.path) if i.path in first else len(first), -count[i.path]))


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Search for no garbage while tests are collected: it takes a quarter of that time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


MATERIAL = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)
RADIUS = 0.526


@pytest.fixture
def template():
    """The paper's lattice with a material pair and a block."""
    return mf.Surface.square_lattice(
        0.12,
        radius=RADIUS,
        material=MATERIAL,
        friction=mf.Friction(0.358, 0.85),
        block=mf.Block(20.0, 20.0, 7.2),
    )


@pytest.fixture
def rough(template):
    """The same lattice with exponential heights."""
    return template.replaced(height=np.random.default_rng(1).exponential(0.03, template.count) + 0.05)


@pytest.fixture(scope="session")
def demo_results(tmp_path_factory):
    """A function that returns the folder in which a demo ran, and the data that it printed.

    Each demo runs once for all processes, with ``--json``. The folder is read only: copy what a test changes.
    """
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base

    @cache
    def made(name):
        folder, printed = shared / f"demo-{name}", shared / f"demo-{name}.json"
        with (shared / f"demo-{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # until the file is closed
            if not printed.exists():
                folder.mkdir()
                with pytest.MonkeyPatch.context() as patch:
                    patch.chdir(folder)
                    result = CliRunner().invoke(cli.main, ["demo", name, "--json"])
                assert result.exit_code == 0, result.output
                printed.write_text(result.stdout, "utf-8")
        return folder, json.loads(printed.read_text("utf-8"))

    return made
