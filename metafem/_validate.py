"""Checks of what a user passes in; each names the argument, the value and what would be right."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem.errors import InvalidInput

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def number(
    name: str,
    value: Any,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
) -> float:
    """Return `value` as a finite float within the bounds."""
    try:
        if isinstance(value, (str, bytes, bool)):
            raise TypeError
        result = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name} = {value!r:.60} is not a number of double precision") from None
    if not math.isfinite(result):
        raise InvalidInput(f"{name} = {result} must be finite")
    if above is not None and not result > above:
        raise InvalidInput(f"{name} = {result:g} must be greater than {above:g}")
    if at_least is not None and result < at_least:
        raise InvalidInput(f"{name} = {result:g} must be at least {at_least:g}")
    if at_most is not None and result > at_most:
        raise InvalidInput(f"{name} = {result:g} must be at most {at_most:g}")
    return result


def integer(name: str, value: Any, *, at_least: int) -> int:
    """Return `value` as an int that is not below `at_least`."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < at_least:
        raise InvalidInput(f"{name} = {value!r} must be a whole number of at least {at_least}")
    return int(value)


def array(name: str, value: Any, *, shape: tuple[int | None, ...]) -> FloatArray:
    """Return `value` as a new, read-only, finite float array; None in `shape` is any length > 0."""
    try:
        result = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name} is not an array of numbers: {value!r:.80}") from None
    wanted = "(" + ", ".join("n" if length is None else str(length) for length in shape) + ")"
    if result.ndim != len(shape) or any(
        length not in (None, have) for length, have in zip(shape, result.shape, strict=True)
    ):
        raise InvalidInput(f"{name} has shape {result.shape}; it must have shape {wanted}")
    if result.size == 0:
        raise InvalidInput(f"{name} is empty; it must have shape {wanted} with n > 0")
    bad = np.flatnonzero(~np.isfinite(result))
    if bad.size:
        raise InvalidInput(f"{name} holds {result.flat[bad[0]]} at entry {bad[0]}; all must be finite")
    result.flags.writeable = False
    return result


def lists(name: str, value: Any, length: int | None) -> FloatArray:
    """Return one list of numbers or several as a new, read-only, finite array (m, length)."""
    try:
        table = np.atleast_2d(np.asarray(value, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name} is not lists of numbers of one length: {value!r:.80}") from None
    return array(name, table, shape=(None, length))


def loads(name: str, value: Any) -> FloatArray:
    """Return loads, none of them negative, (k,)."""
    result = array(name, value, shape=(None,))
    if result.min() < 0.0:
        raise InvalidInput(f"{name} holds {result.min():g}; loads cannot be negative")
    return result


def instance(name: str, value: Any, kind: type, wanted: str) -> None:
    """Refuse a value that is not of a kind, or is a class where an object is due."""
    if isinstance(value, type) or not isinstance(value, kind):
        raise InvalidInput(f"{name} = {value!r:.60} must be {wanted}")


def scalar(value: Any) -> bool:
    """Whether a value is one number rather than a list of them."""
    return np.isscalar(value) or (isinstance(value, np.ndarray) and value.ndim == 0)


def increasing(name: str, value: FloatArray) -> FloatArray:
    """Return `value`, all of it positive and strictly increasing."""
    if value[0] <= 0.0:
        raise InvalidInput(f"{name}[0] = {value[0]:g} must be greater than 0")
    bad = np.flatnonzero(np.diff(value) <= 0.0)
    if bad.size:
        i = int(bad[0]) + 1
        raise InvalidInput(
            f"{name}[{i}] = {value[i]:g} does not exceed {name}[{i - 1}] = {value[i - 1]:g}; "
            "the values must increase"
        )
    return value


def generator(rng: Any) -> np.random.Generator:
    """Return the random generator of a seed or of a generator."""
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise InvalidInput(f"rng = {rng!r} must be a non-negative seed or a numpy Generator") from None
