"""Steps of long computations, as they are reported."""

import numpy as np
import pytest

import metafem as mf
from metafem.progress import doing, each, listening, message


def heard(run):
    told = []
    with listening(lambda step, done: told.append((step, done))):
        run()
    return told


def test_nested_steps_are_told_with_the_share_that_is_done():
    def run():
        with doing("solving"):
            for _ in each("mesh", "ab"):
                for _ in each("load case", "abcd"):
                    pass

    told = heard(run)
    assert told[0] == ("solving", None)
    assert ("solving, mesh 1 of 2, load case 4 of 4", 3 / 8) in told
    assert ("solving, mesh 2 of 2, load case 3 of 4", 6 / 8) in told
    assert told[-1] == ("solving", None)


def test_of_a_loop_that_may_end_early_no_share_is_known():
    assert heard(lambda: list(each("start", [1, 2], at_most=True))) == [
        ("start 1 of at most 2", None),
        ("start 2 of at most 2", None),
    ]


def test_steps_end_with_an_error_and_with_a_break():
    told = []
    with listening(lambda step, done: told.append(step)):
        with pytest.raises(ZeroDivisionError), doing("dividing"):
            _ = 1 / 0
        for _ in each("start", range(3)):
            break
        with doing("writing"):
            pass
    assert told == ["dividing", "start 1 of 3", "writing"]


def test_nobody_need_listen():
    assert list(each("start", [1, 2])) == [1, 2]
    with doing("solving"):
        message("kept")


def test_a_design_tells_of_its_searches_and_of_resolved_loads(template):
    target = mf.PowerLaw(1.2, (0.1, 0.2))
    told = " ".join(step for step, _ in heard(lambda: mf.design(target, template, mf.Interacting())))
    assert "inverting the law, start 1 of at most" in told
    assert "refining the heights under the model, start 1 of at most" in told
    assert "computing the law of the heights" in told
    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    model = mf.BoundaryElements(cell=0.01)
    told = heard(lambda: mf.friction_law(surface, model, load=[0.01, 0.02]))
    assert ("resolved contacts: load 2 of 2", 0.5) in told


def test_a_block_is_said_to_be_solved_and_where_it_is_kept(tmp_path, monkeypatch):
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
