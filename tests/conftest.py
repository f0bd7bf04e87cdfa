"""Settings, scenes and results that tests share."""

import fcntl
import gc
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from shutil import rmtree

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import settings

import metafem as mf
from metafem import cli

# Property tests draw the same cases on every run and are never timed.
settings.register_profile("metafem", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("metafem")

# The tests of the README's second command, and the processor time [s] that none of them may take.
CORE, LONGEST = Path(__file__).parent / "core", 2.0

# One process shares the browser and the server of these tests.
BROWSER = "tests/browser/"


def in_core(item):
    """Whether a test belongs to the README's second command."""
    return item.path.is_relative_to(CORE) and item.get_closest_marker("slow") is None


def pytest_sessionstart(session):
    """Compile the kernels once, before processes start that would each compile them."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as many processes as processors are busy
    if session.config.getoption("numprocesses", None) and not session.config.option.collectonly:
        command = [sys.executable, "-m", "tests.kernels"]
        parts = [subprocess.Popen([*command, part], cwd=CORE.parents[1]) for part in ("0", "1")]
        codes = [part.wait() for part in parts]
        assert codes == [0, 0], "the kernels could not be compiled"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark as slow every test that the README's second command does not run."""
    for item in items:
        if not in_core(item):
            item.add_marker("slow")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item):
    """Fail a core test that takes too much processor time."""
    start = sum(os.times()[:4])
    result = yield
    taken = sum(os.times()[:4]) - start
    # a process of its own may have compiled kernels
    if in_core(item) and taken > LONGEST and "PYTEST_XDIST_WORKER" in os.environ:
        pytest.fail(f"{taken:.1f} s of processor time; a core test may take {LONGEST:g} s", pytrace=False)
    return result


def pytest_xdist_make_scheduler(config, log):
    """Give the tests of a file to one process where files are dealt out, and the browser's tests to one."""
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid):
            return BROWSER if nodeid.startswith(BROWSER) else nodeid.partition("::")[0]

    return Scheduling(config, log) if config.getvalue("dist") == "loadfile" else None


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


def paper_lattice():
    """Return the paper's lattice with a material pair and a block."""
    return mf.Surface.square_lattice(
        0.12,
        radius=RADIUS,
        material=MATERIAL,
        friction=mf.Friction(0.358, 0.85),
        block=mf.Block(20.0, 20.0, 7.2),
    )


@pytest.fixture
def template():
    """The paper's lattice with a material pair and a block."""
    return paper_lattice()


@pytest.fixture
def rough(template):
    """The same lattice with exponential heights."""
    return template.replaced(height=np.random.default_rng(1).exponential(0.03, template.count) + 0.05)


@pytest.fixture(scope="session")
def once(tmp_path_factory):
    """A function that returns a folder, which one of all processes fills; the others wait for it.

    The folder is read only: copy what a test changes.
    """
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base

    def filled(name, fill):
        folder, whole = shared / name, shared / f"{name}.whole"
        with (shared / f"{name}.lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # until the file is closed
            if not whole.exists():
                rmtree(folder, ignore_errors=True)  # of a test that failed
                folder.mkdir()
                fill(folder)
                whole.touch()
        return folder

    return filled


@pytest.fixture(scope="session")
def demo_results(once):
    """A function that returns the folder in which a demo ran, and the data that it printed.

    Each demo runs once for all processes, with ``--json``.
    """

    @cache
    def made(name):
        def run(folder):
            with pytest.MonkeyPatch.context() as patch:
                patch.chdir(folder)
                result = CliRunner().invoke(cli.main, ["demo", name, "--json"])
            assert result.exit_code == 0, result.output
            folder.with_suffix(".json").write_text(result.stdout, "utf-8")

        folder = once(f"demo-{name}", run)
        return folder, json.loads(folder.with_suffix(".json").read_text("utf-8"))

    return made


@pytest.fixture(scope="session")
def full_report(once):
    """The report of a design with three studies."""

    def write(folder):
        from metafem.report import page

        design = mf.design(mf.LinearLaw(6.87), paper_lattice(), limits=mf.Limits(0.12, offset=0.084))
        studies = {
            "manufacturing": mf.studies.manufacturing(design.surface, (0.001, 0.003), draws=20),
            "misalignment": mf.studies.misalignment(design.surface, [0.0005, 0.001], assignments=2),
            "uncertainty": mf.studies.uncertainty(
                design.surface, {"composite_modulus": 0.04, "radius": 0.002}
            ),
        }
        (folder / "report.html").write_text(page(design, studies=studies), "utf-8")

    return once("full-report", write) / "report.html"
