"""Annotations of every kind, those that newer Pythons write as aliases too."""

import sys
from collections.abc import Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

from metafem.files.result.hints import fits, in_words, with_whole_keys


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


def test_keys_are_whole_numbers_where_the_annotation_has_them():
    hint = Mapping[int, float | None]
    assert with_whole_keys({"9": 0.15, "3": None}, hint) == {9: 0.15, 3: None}
    assert fits(with_whole_keys({"9": 0.15, "3": None}, hint), hint)
    assert not fits(with_whole_keys({"nine": 0.15}, hint), hint)
    assert with_whole_keys({"9": 0.15}, Mapping[str, float]) == {"9": 0.15}
    assert with_whole_keys((1, 2), tuple[int, ...]) == (1, 2)
