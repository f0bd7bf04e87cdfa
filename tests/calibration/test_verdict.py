"""Chi-square and runs of residuals against their distributions."""

from itertools import combinations, groupby

import numpy as np
import pytest

from metafem.calibration.verdict import judged


@pytest.mark.parametrize(("count", "positive"), [(6, 3), (9, 4), (10, 2)])
def test_the_probability_of_runs_is_that_of_all_orders_of_the_signs(count, positive):
    runs = []
    for chosen in combinations(range(count), positive):
        signs = np.isin(np.arange(count), chosen)
        runs.append(len(list(groupby(signs))))
    for most in sorted(set(runs)):
        residual = np.where(_with_runs(count, positive, most), 1.0, -1.0)
        expected = np.mean(np.array(runs) <= most)
        assert judged(residual, 0).runs_probability == pytest.approx(expected, rel=1e-12)


def _with_runs(count, positive, runs):
    for chosen in combinations(range(count), positive):
        signs = np.isin(np.arange(count), chosen)
        if len(list(groupby(signs))) == runs:
            return signs
    raise AssertionError


def test_correct_laws_are_rejected_as_often_as_stated():
    rng = np.random.default_rng(1)
    verdicts = [judged(rng.standard_normal(30), 0) for _ in range(2000)]
    probabilities = np.array([verdict.probability for verdict in verdicts])
    # the binomial standard deviation of a share of 2000
    assert abs((probabilities < 0.2).mean() - 0.2) < 4.0 * np.sqrt(0.2 * 0.8 / 2000)
    assert np.mean([not verdict.fits for verdict in verdicts]) < 0.03  # two tests at 1 %


def test_residuals_of_one_sign_are_no_fit():
    assert not judged(np.full(12, 0.9), 1).fits
    assert "does not fit" in str(judged(np.full(12, 0.9), 1))


def test_one_degree_and_one_run_are_singular():
    assert "with 1 degree of freedom" in str(judged(np.array([0.4, 0.2]), 1))
    assert "1 run of residuals" in str(judged(np.array([0.4, 0.2]), 1))
