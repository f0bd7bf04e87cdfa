"""Checks of user input; each error names the argument, the value and what is allowed."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._given import formatted, label, named_by_file, plain, shown, unit_of
from metafem.errors import InvalidInput

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Products of up to five lengths, loads or moduli occur; each product must be a normal number in double
# precision.
SMALLEST, LARGEST = sys.float_info.min**0.2, sys.float_info.max**0.2

# If the ratio of two lengths is larger than this, the smaller one is lost when they are added.
PROPORTION = 1.0 / sys.float_info.epsilon

# Bounds of Poisson's ratio of a block: 0.5 is incompressible.
POISSON: Mapping[str, Any] = {"at_least": 0.0, "at_most": 0.5}


def number(
    name: str,
    value: Any,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
) -> float:
    """Return `value` as a finite float within the bounds, in the unit of the name."""
    try:
        result = float(_one(plain(name, value)))
    except InvalidInput:
        raise
    except (TypeError, ValueError, OverflowError, Warning):
        raise InvalidInput(f"{name} = {shown(value)} is not a number in double precision") from None
    if not math.isfinite(result):
        raise InvalidInput(f"{name} = {result} must be finite")
    given = f"{label(name)} = {formatted(name, result)}"
    if above is not None and not result > above:
        raise InvalidInput(f"{given} must be greater than {formatted(name, above)}")
    if at_least is not None and result < at_least:
        raise InvalidInput(f"{given} must be at least {formatted(name, at_least)}")
    if at_most is not None and result > at_most:
        raise InvalidInput(f"{given} must be at most {formatted(name, at_most)}")
    if result and not SMALLEST <= abs(result) <= LARGEST and unit_of(name) != "1":
        raise _beyond(name, given)
    return result


def member(owner: Any, name: str, *, optional: bool = False, **bounds: float) -> None:
    """Replace a member of a frozen dataclass by a checked number; an optional one may be None."""
    value = getattr(owner, name)
    if value is not None or not optional:
        object.__setattr__(owner, name, number(name, value, **bounds))


def _one(value: Any) -> Any:
    if np.ndim(value):
        raise TypeError
    return value


def _beyond(name: str, given: str) -> InvalidInput:
    return InvalidInput(
        f"{given} is outside the range in which products fit double precision; it must be 0, or "
        f"{SMALLEST:.0e} to {LARGEST:.0e} {unit_of(name)} in magnitude"
    )


def integer(name: str, value: Any, *, at_least: int) -> int:
    """Return `value` as an int of at least `at_least`."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.timedelta64))
    if not whole or value < at_least:
        raise InvalidInput(f"{name} = {shown(value)} must be a whole number of at least {at_least}")
    return int(value)


def array(name: str, value: Any, *, shape: tuple[int | None, ...], positive: bool = False) -> FloatArray:
    """Return `value` as a new, read-only, finite float array; None in `shape` is any length > 0."""
    try:
        result = np.array(plain(name, value), dtype=np.float64, order="C")
    except InvalidInput:
        raise
    except (TypeError, ValueError, OverflowError, Warning):
        raise InvalidInput(f"{name} is not an array of numbers: {shown(value, 80)}") from None
    required = (
        "(" + ", ".join("n" if length is None else str(length) for length in shape) + ",)"[len(shape) > 1 :]
    )
    if result.ndim != len(shape) or any(
        length not in (None, have) for length, have in zip(shape, result.shape, strict=True)
    ):
        if result.ndim == len(shape) == 1 and named_by_file():
            many = f"{result.size} number{'s' * (result.size != 1)}"
            raise InvalidInput(f"{name} has {many}; it must have {shape[0]}")
        raise InvalidInput(f"{name} has shape {result.shape}; it must have shape {required}")
    if result.size == 0:
        raise InvalidInput(f"{name} is empty; it must have shape {required} with n > 0")
    bad = np.argwhere(~np.isfinite(result))
    if bad.size:
        first = tuple(bad[0].tolist())
        where = first[0] if len(first) == 1 else first
        raise InvalidInput(f"{name} holds {result[first]} at entry {where}; all must be finite")
    if unit_of(name) != "1":
        # a coordinate or a height may be arbitrarily small: nothing is divided by it
        beyond = np.argwhere((np.abs(result) > LARGEST) | (positive & (result > 0.0) & (result < SMALLEST)))
        if beyond.size:
            first = tuple(beyond[0].tolist())
            raise _beyond(name, f"{label(f'{name}{list(first)}')} = {formatted(name, result[first])}")
    if positive and result.min() <= 0.0:
        i = int(result.argmin())
        raise InvalidInput(f"{label(f'{name}[{i}]')} = {formatted(name, result[i])} must be greater than 0")
    result.flags.writeable = False
    return result


def proportion(name: str, value: float, other: str, reference: float) -> None:
    """Refuse two lengths whose ratio exceeds the resolution of double precision."""
    small, large = sorted((abs(value), abs(reference)))
    if large > PROPORTION * small:
        both = f"{label(name)} = {formatted(name, value)} and {label(other)} = {formatted(other, reference)}"
        raise InvalidInput(
            f"{both} differ by a factor of {large / small:.1g}; it must be at most {PROPORTION:.1g}, the "
            "resolution of double precision"
        )


def lists(name: str, value: Any, length: int | None) -> FloatArray:
    """Return one list of numbers or several as a new, read-only, finite array (m, length)."""
    try:
        table = np.atleast_2d(np.asarray(plain(name, value), dtype=np.float64))
    except InvalidInput:
        raise
    except (TypeError, ValueError, OverflowError, Warning):
        raise InvalidInput(f"{name} is not lists of numbers of one length: {shown(value, 80)}") from None
    return array(name, table, shape=(None, length))


def loads(name: str, value: Any) -> FloatArray:
    """Return loads, none of them negative, (k,)."""
    result = array(name, value, shape=(None,))
    if result.min() < 0.0:
        raise InvalidInput(f"{name} holds {formatted(name, result.min())}; loads cannot be negative")
    return result


def instance(name: str, value: Any, kind: type, required: str) -> None:
    """Refuse a value that is not an instance of `kind`, and a class in place of an instance."""
    if isinstance(value, type) or not isinstance(value, kind):
        raise InvalidInput(f"{name} = {shown(value)} must be {required}")


def scalar(value: Any) -> bool:
    """Whether a value is a single number or quantity, and not a list of them."""
    return not isinstance(value, range) and depth(value) == 0


def depth(value: Any) -> int:
    """Return the nesting depth of lists, or the number of axes of an array: 0 for a single value."""
    if isinstance(value, (list, tuple)):
        return 1 + (depth(value[0]) if value else 0)
    return int(getattr(value, "ndim", 0))


def increasing(name: str, value: FloatArray) -> FloatArray:
    """Return `value`, whose entries must be positive and strictly increasing."""
    if value[0] <= 0.0:
        raise InvalidInput(f"{label(f'{name}[0]')} = {formatted(name, value[0])} must be greater than 0")
    if value[0] < SMALLEST and unit_of(name) != "1":
        raise _beyond(name, f"{label(f'{name}[0]')} = {formatted(name, value[0])}")
    bad = np.flatnonzero(np.diff(value) <= 0.0)
    if bad.size:
        i = int(bad[0]) + 1
        raise InvalidInput(
            f"{label(f'{name}[{i}]')} = {formatted(name, value[i])} does not exceed "
            f"{label(f'{name}[{i - 1}]')} = {formatted(name, value[i - 1])}; the values must increase"
        )
    return value


def interval(name: str, value: Any) -> tuple[float, float]:
    """Return two positive numbers of which the second is the larger."""
    low, high = increasing(name, array(name, value, shape=(2,))).tolist()
    return low, high


def generator(rng: Any) -> np.random.Generator:
    """Return the random generator of a seed or of a generator."""
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise InvalidInput(f"rng = {shown(rng)} must be a non-negative seed or a numpy Generator") from None


def refuse_entries(name: str, values: FloatArray, wrong: Any, must: str) -> None:
    """Refuse values of which one is `wrong`, a mask of their shape; the error names the first such entry."""
    bad = np.argwhere(wrong)
    if bad.size:
        place = tuple(bad[0].tolist())
        entry = label(f"{name}[{', '.join(map(str, place))}]")
        raise InvalidInput(f"{entry} = {formatted(name, values[place])} {must}")
