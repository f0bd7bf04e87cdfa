"""What the studies share: seeds and generators of their parts, batches, and the slope of a law."""

import joblib
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import metafem as mf
from metafem.progress import listening
from metafem.studies.draws import computed, generator_of, seed_of
from metafem.studies.slope import slope, slope_loads
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


def test_a_part_depends_on_the_seed_and_its_number_alone():
    points = generator_of(7, 3).random(64)
    assert_array_equal(points, generator_of(7, 3).random(64))
    for other in (generator_of(7, 4), generator_of(8, 3)):
        assert not np.isin(points, other.random(64)).any()
    assert seed_of(5) == 5
    assert seed_of(np.random.default_rng(1)) == seed_of(np.random.default_rng(1))


def test_the_slope_is_that_of_a_fitted_line_up_to_the_lowest_summit(rough):
    load = slope_loads(rough, (0.02, 0.3), mf.Independent())
    area = mf.Independent().curve(rough, load).area
    assert slope(load, area) == pytest.approx(np.polyfit(load, area, 1)[0], rel=1e-12)
    assert load[[0, -1]].tolist() == [0.02, 0.3]
    low, *_, high = slope_loads(rough, None, mf.Independent())
    assert low == pytest.approx(0.25 * high)
    assert mf.Independent().curve(rough, np.array([high])).approach[0] == pytest.approx(np.ptp(rough.height))
