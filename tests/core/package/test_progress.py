"""Steps of long computations, as they are reported."""

import numpy as np
import pytest

import metafem as mf
from metafem.progress import doing, each, listening, message


def reported(run):
    steps = []
    with listening(lambda step, done: steps.append((step, done))):
        run()
    return steps


def test_nested_steps_are_reported_with_the_fraction_done():
    def run():
        with doing("solving"):
            for _ in each("mesh", "ab"):
                for _ in each("load case", "abcd"):
                    pass

    steps = reported(run)
    assert steps[0] == ("solving", None)
    assert ("solving, mesh 1 of 2, load case 4 of 4", 3 / 8) in steps
    assert ("solving, mesh 2 of 2, load case 3 of 4", 6 / 8) in steps
    assert steps[-1] == ("solving", None)


def test_loops_that_may_end_early_and_steps_without_a_listener():
    assert reported(lambda: list(each("start", [1, 2], at_most=True))) == [
        ("start 1 of at most 2", None),
        ("start 2 of at most 2", None),
    ]
    assert list(each("start", [1, 2])) == [1, 2]
    with doing("solving"):
        message("kept")


def test_steps_end_with_an_error_and_with_a_break():
    steps = []
    with listening(lambda step, done: steps.append(step)):
        with pytest.raises(ZeroDivisionError), doing("dividing"):
            _ = 1 / 0
        for _ in each("start", range(3)):
            break
        with doing("writing"):
            pass
    assert steps == ["dividing", "start 1 of 3", "writing"]


def test_a_listener_that_stops_the_work_is_called_once():
    steps = []

    def stop(step, done):
        steps.append(step)
        if len(steps) > 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), listening(stop):
        [load for _ in each("try", "ab") for load in each("load", "ab")]
    assert steps == ["try 1 of 2", "try 1 of 2, load 1 of 2"]


def test_the_solution_of_a_block_and_its_file_are_reported(tmp_path, monkeypatch):
    monkeypatch.setattr("metafem.fe.block3d.cache.cache_folder", lambda: tmp_path)
    block = mf.Block(2.0, 2.0, 1.0)
    surface = mf.Surface([[0.1, 0.013]], [0.1], 0.5, mf.Material(1.0), block=block)
    steps, facts = [], []
    with listening(lambda step, done: steps.append((step, done)), facts.append):
        found = mf.fe.Block3D(cell=1.0, edge_cell=0.5).influence_matrix(surface)
    assert np.isfinite(found).all()
    assert any(step.startswith("solving the true block, once for these sites, mesh 2") for step, _ in steps)
    assert max(done or 0.0 for _, done in steps) > 0.5
    (text,) = facts
    assert str(tmp_path) in text
