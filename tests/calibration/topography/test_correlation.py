"""Correlations of residuals, and covariances of fits to correlated values."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from metafem.calibration.topography.correlation import correlation, lagged, summed


def test_sums_over_lags_are_those_of_double_loops():
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(2, 4, 5))
    kernel = rng.normal(size=(5, 5))
    kernel += kernel[::-1, ::-1]
    expected = np.zeros((2, 2))
    places = list(np.ndindex(4, 5))
    for i in places:
        for j in places:
            lag = np.subtract(i, j) + 2
            if lag.min() >= 0 and lag.max() <= 4:
                expected += kernel[tuple(lag)] * np.outer(columns[:, *i], columns[:, *j])
    np.testing.assert_allclose(summed(columns, kernel), expected, atol=1e-12)
    assert lagged(columns[0], columns[0], 2)[2, 2] == pytest.approx((columns[0] ** 2).sum())


@pytest.mark.parametrize("width", [0.3, 1.0, 2.0])
def test_the_correlation_of_fitted_residuals_gives_the_variance_of_the_fit(width):
    """The mean of a correlated field over a disc, from the residuals about the means of many discs."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[-16:17, -16:17]
    disc = (x**2 + y**2 <= 15**2).astype(float)
    fields = [gaussian_filter(rng.normal(size=(49, 49)), width)[8:41, 8:41] for _ in range(300)]
    means = np.array([(field * disc).sum() / disc.sum() for field in fields])
    rest = [(field - mean) * disc for field, mean in zip(fields, means, strict=True)]
    found = correlation(rest, [disc] * len(rest), 1)
    variance = np.mean([(each**2).sum() for each in rest]) / disc.sum()
    expected = variance * summed(disc[None], found)[0, 0] / disc.sum() ** 2
    # the variance of 300 means has a relative standard error of sqrt(2 / 300), 8 %
    assert expected == pytest.approx(means.var(), rel=0.2)


def test_exact_values_have_no_correlation():
    assert correlation([np.zeros((8, 8))], [np.ones((8, 8))], 1).sum() == 1.0
