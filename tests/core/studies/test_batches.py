"""Runs of batches: the same numbers from any number of workers and from a folder of finished batches."""

import numpy as np
import pytest

import metafem as mf
from metafem.progress import listening
from metafem.studies import Execution
from metafem.studies.sampling.batches import opened
from tests.conftest import MATERIAL, RADIUS

SURFACE = mf.Surface.square_lattice(
    np.linspace(0.1, 0.2, 16), (4, 4), radius=RADIUS, material=MATERIAL, block=mf.Block(20.0, 20.0, 7.2)
)
SQUARES = [0, 1, 4, 9, 16, 25]


def study(execution=None, draws=200):
    return mf.studies.manufacturing(SURFACE, [0.001, 0.003], draws=draws, execution=execution)


def squares(batch):
    return {"value": np.array([batch**2])}


def computed(execution, task=squares):
    with opened(execution, "test", "0" * 32) as compute:
        return [result["value"].item() for result in compute(task, range(6))]


def test_two_processes_give_the_numbers_of_one():
    assert computed(Execution(workers=2)) == computed(None) == SQUARES


def test_a_stopped_run_goes_on_where_it_was(tmp_path):
    calls, messages = [], []

    def stopped(batch):
        calls.append(batch)
        if calls == [0, 1, 2]:
            raise KeyboardInterrupt
        return squares(batch)

    execution = Execution(folder=tmp_path / "run")
    with listening(lambda step, done: None, messages.append), pytest.raises(KeyboardInterrupt):
        computed(execution, stopped)
    assert str(tmp_path) in messages[0]
    assert computed(execution, stopped) == SQUARES
    (tmp_path / "run" / "batch-00000001.npz").write_bytes(b"damaged")
    assert computed(execution, stopped) == SQUARES
    assert computed(execution, stopped) == SQUARES
    assert calls == [0, 1, 2, 2, 3, 4, 5, 1]


def test_progress_has_a_rate_and_the_time_left():
    steps = []
    with listening(lambda step, done: steps.append(step)):
        computed(None)
    assert steps[0] == "batch 1 of 6"
    assert steps[3].startswith("batch 4 of 6, ")
    assert steps[3].endswith(" per second, 0 s left")
