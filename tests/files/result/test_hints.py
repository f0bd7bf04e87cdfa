"""Annotations of every kind, those that newer Pythons write as aliases too."""

import sys

import numpy as np
import pytest
from numpy.typing import NDArray

from metafem.files.result.hints import fits, in_words


def test_arrays_are_compared_with_their_type():
    assert fits(np.zeros(3), NDArray[np.float64])
    assert not fits(np.zeros(3, dtype=int), NDArray[np.float64])
    assert in_words(NDArray[np.float64]) == "finite numbers (float64)"


@pytest.mark.skipif(sys.version_info < (3, 12), reason="aliases came with Python 3.12")
def test_an_alias_is_replaced_by_its_value():
    names = {"np": np}
    exec("type Array[T] = np.ndarray[tuple[int, ...], np.dtype[T]]", names)
    assert fits(np.zeros(3), names["Array"][np.float64])
    assert in_words(names["Array"][np.float64]) == "finite numbers (float64)"
