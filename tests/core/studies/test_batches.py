"""Batches: the same numbers from any number of workers."""

import joblib
import numpy as np

import metafem as mf
from metafem.progress import listening
from metafem.studies.draws import computed
from tests.conftest import MATERIAL, RADIUS

SURFACE = mf.Surface.square_lattice(
    np.linspace(0.1, 0.2, 16), (4, 4), radius=RADIUS, material=MATERIAL, block=mf.Block(20.0, 20.0, 7.2)
)


def study():
    return mf.studies.manufacturing(SURFACE, [0.001, 0.003], draws=600)


def test_two_processes_give_the_numbers_of_one():
    with joblib.parallel_config(n_jobs=2):
        found = study()
    assert found.identical(study())


def test_each_batch_is_a_step_and_computed_when_it_is_asked_for():
    steps, calls = [], []
    with listening(lambda step, done: steps.append(step)):
        results = computed(lambda number: calls.append(number) or number**2, range(6))
        assert (next(results), len(calls) < 6) == (0, True)
        assert list(results) == [1, 4, 9, 16, 25]
    assert steps[:2] == ["batch 1 of 6", "batch 2 of 6"]
