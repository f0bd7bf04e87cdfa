"""Compiled transforms against those of NumPy."""

import numpy as np

from metafem._kernels.sums import fourier
from metafem.models.interacting.sums.lattice_sums import roots_of_unity

LENGTHS = (2, 6, 12, 20, 30, 360)


def arrays(values, length, count):
    parts = np.zeros((4, length * count))
    for part, of in zip(parts, (values.real, values.imag), strict=False):
        part[: of.size] = of.ravel()
    return tuple(parts)


def test_padded_columns_are_transformed():
    for length in LENGTHS:
        count, rng = 7, np.random.default_rng(0)
        values = rng.random((length // 2, count)) + 1j * rng.random((length // 2, count))
        found = fourier.padded(length, count, roots_of_unity(length), *arrays(values, length, count))
        expected = np.fft.fft(values, length, axis=0)
        assert np.abs((found[0] + 1j * found[1]).reshape(length, count) - expected).max() < 1e-12


def test_the_first_half_is_transformed():
    for length in LENGTHS:
        count, rng = 3, np.random.default_rng(1)
        values = rng.random((length, count)) + 1j * rng.random((length, count))
        found = fourier.halved(length, count, roots_of_unity(length), *arrays(values, length, count))
        half = (found[0] + 1j * found[1])[: length // 2 * count].reshape(-1, count)
        assert np.abs(half - np.fft.fft(values, axis=0)[: length // 2]).max() < 1e-12
