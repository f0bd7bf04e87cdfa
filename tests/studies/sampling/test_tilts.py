"""Mean and deviation over a uniform angle against closed forms."""

import numpy as np

from metafem.studies.sampling.tilts import within


def test_errors_fall_with_the_square_of_the_step():
    # mean and deviation of exp(x) over [-1, 1]
    mean = np.sinh(1.0)
    sd = np.sqrt(np.sinh(2.0) / 2.0 - mean**2)
    errors, estimated = [], []
    for steps in (7, 14, 28):
        angle = np.linspace(-1.0, 1.0, 2 * steps + 1)
        (value, value_error), (spread, spread_error) = within(angle, np.exp(angle))
        errors.append([value[-1] - mean, spread[-1] - sd])
        estimated.append([value_error[-1], spread_error[-1]])
    order = np.log2(np.abs(np.array(errors)[:-1] / np.array(errors)[1:]))
    np.testing.assert_allclose(order, 2.0, atol=0.1)
    # half as many angles: three times the error
    np.testing.assert_allclose(np.abs(np.array(estimated) / errors), 3.0, atol=0.6)


def test_a_linear_slope_has_the_deviation_of_a_uniform_angle():
    angle = np.array([-0.3, -0.1, 0.0, 0.1, 0.3])
    (mean, mean_error), (sd, sd_error) = within(angle, 5.0 + angle)
    np.testing.assert_allclose(mean, 5.0, rtol=1e-12)
    np.testing.assert_allclose(sd, np.array([0.1, 0.3]) / np.sqrt(3.0), rtol=1e-12)
    np.testing.assert_allclose([mean_error, sd_error], 0.0, atol=1e-12)
