"""Steps of long computations, as they are reported."""

import pytest

from metafem.progress import doing, each, listening, message


def reported(run):
    steps = []
    with listening(lambda step, done: steps.append((step, done))):
        run()
    return steps


def test_nested_steps_are_reported_with_the_fraction_of_the_outermost():
    def run():
        with doing("solving"):
            for _ in each("mesh", "ab"):
                for _ in each("load case", "abcd"):
                    pass

    steps = reported(run)
    assert steps[0] == ("solving", None)
    assert ("solving, mesh 1 of 2, load case 4 of 4", 0.0) in steps
    assert ("solving, mesh 2 of 2, load case 3 of 4", 0.5) in steps
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
