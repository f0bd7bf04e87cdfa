"""Settings, scenes and results that tests share."""

import json
from functools import cache

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import settings

import metafem as mf
from metafem import cli

# Property tests draw the same cases on every run and are never timed.
settings.register_profile("metafem", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("metafem")

# Examples that solve finite elements for longer than a few seconds.
SLOW_EXAMPLES = ("hertz_check", "cap_check", "cell_check", "FiniteContact")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark the examples that take long as slow."""
    for item in items:
        if isinstance(item, pytest.DoctestItem) and item.name.endswith(SLOW_EXAMPLES):
            item.add_marker("slow")


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

    Each demo runs once, with ``--json``. The folder is read only: copy what a test changes.
    """

    @cache
    def made(name):
        folder = tmp_path_factory.mktemp(name)
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(folder)
            result = CliRunner().invoke(cli.main, ["demo", name, "--json"])
        assert result.exit_code == 0, result.output
        return folder, json.loads(result.stdout)

    return made
