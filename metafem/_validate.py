"""Checks of user input; each error states the argument, its value and the allowed values."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Mapping
from contextlib import suppress
from types import UnionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._given import shown, unit_of, with_unit
from metafem.errors import InvalidInput, refuse_if

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Bounds of lengths, loads and moduli. The package multiplies up to five of them, and each product must be a
# normal number in double precision.
SMALLEST, LARGEST = sys.float_info.min**0.2, sys.float_info.max**0.2

# Bounds of lengths that must be positive, and largest magnitude of all lengths [mm]: far below an atom, and
# far above any part, so that lengths may also be given in units a million times larger or smaller.
SHORTEST, LONGEST = 1e-12, 1e8

# Bounds of Poisson's ratio; a material with 0.5 is incompressible.
POISSON: Mapping[str, Any] = {"at_least": 0.0, "at_most": 0.5}

# numpy's letters for the kinds of arrays that are refused: booleans, complex numbers, dates, durations,
# bytes, texts and structures.
FOREIGN = "bcMmSUV"


def number(
    name: str,
    value: Any,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
) -> float:
    """Return `value` as a finite float within the bounds, in the unit of the argument `name`."""
    try:
        result = float(_one(plain(name, value)))
    except InvalidInput:
        raise
    except (TypeError, ValueError, OverflowError, Warning):
        raise InvalidInput("is not a number in double precision", key=name, value=shown(value)) from None
    refuse_if(not math.isfinite(result), "must be finite", key=name, value=str(result))
    limits: Any = (
        (above is not None and not result > above, "greater than", above),
        (at_least is not None and result < at_least, "at least", at_least),
        (at_most is not None and result > at_most, "at most", at_most),
    )
    for wrong, must, bound in limits:
        if wrong:
            raise InvalidInput(f"must be {must} {with_unit(name, bound)}", key=name, value=result)
    least, most = bounds(name, above == 0.0)
    if result and not least <= abs(result) <= most:
        raise _beyond(name, result, least, most)
    return result


def bounds(name: str, positive: bool) -> tuple[float, float]:
    """Return the bounds of the magnitude of an argument that is not 0."""
    match unit_of(name):
        case "1":
            return 0.0, math.inf
        case "mm":
            return SHORTEST if positive else 0.0, LONGEST
    return SMALLEST, LARGEST


def member(owner: Any, name: str, *, optional: bool = False, **bounds: float) -> None:
    """Replace a member of a frozen dataclass with a checked number; an optional member may be None."""
    value = getattr(owner, name)
    if value is not None or not optional:
        object.__setattr__(owner, name, number(name, value, **bounds))


def _one(value: Any) -> Any:
    if np.ndim(value):
        raise TypeError
    return value


def _beyond(name: str, value: float, least: float, most: float) -> InvalidInput:
    limits = f"at most {most:.0e}" if least == 0.0 else f"0, or {least:.0e} to {most:.0e}"
    words = f"is outside the range of double precision; it must be {limits} {unit_of(name)} in magnitude"
    return InvalidInput(words, key=name, value=value)


def integer(name: str, value: Any, *, at_least: int) -> int:
    """Return `value` as an int, which must be at least `at_least`."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.timedelta64))
    if not whole or value < at_least:
        raise InvalidInput(f"must be a whole number of at least {at_least}", key=name, value=shown(value))
    return int(value)


def array(name: str, value: Any, *, shape: tuple[int | None, ...], positive: bool = False) -> FloatArray:
    """Return `value` as a new, read-only, finite float array; None in `shape` means any length > 0."""
    try:
        result = np.array(plain(name, value), dtype=np.float64, order="C")
    except InvalidInput:
        raise
    except (TypeError, ValueError, OverflowError, Warning):
        raise InvalidInput(f"is not an array of numbers: {shown(value, 80)}", key=name) from None
    _refuse_shape(name, result.shape, shape)
    bad = np.argwhere(~np.isfinite(result))
    if bad.size:
        first = tuple(bad[0].tolist())
        raise InvalidInput(f"= {result[first]} must be finite", key=f"{name}{list(first)}")
    least, most = bounds(name, positive)
    # nothing is divided by entries that may be 0
    beyond = np.argwhere((np.abs(result) > most) | (positive & (result > 0.0) & (result < least)))
    if beyond.size:
        first = tuple(beyond[0].tolist())
        raise _beyond(f"{name}{list(first)}", result[first], least, most)
    if positive and result.min() <= 0.0:
        i = int(result.argmin())
        raise InvalidInput("must be greater than 0", key=f"{name}[{i}]", value=result[i])
    result.flags.writeable = False
    return result


def _refuse_shape(name: str, found: tuple[int, ...], shape: tuple[int | None, ...]) -> None:
    alike = len(found) == len(shape)
    if alike and all(length in (None, have) for length, have in zip(shape, found, strict=True)):
        if 0 in found:
            raise InvalidInput("is empty", key=name)
    elif alike and len(shape) == 1:
        many = f"{found[0]} number{'s' * (found[0] != 1)}"
        raise InvalidInput(f"has {many}; it must have {shape[0]}", key=name)
    else:
        required = ", ".join("n" if length is None else str(length) for length in shape)
        required += "," * (len(shape) == 1)
        raise InvalidInput(f"has shape {found}; it must have shape ({required})", key=name)


def lists(name: str, value: Any, length: int | None) -> FloatArray:
    """Return one list of numbers, or several, as a new, read-only, finite array (m, length)."""
    while depth(value) < 2:
        value = [value]
    return array(name, value, shape=(None, length))


def loads(name: str, value: Any, *, negative: bool = False) -> FloatArray:
    """Return `value` as an array of loads (k,); negative ones are refused unless `negative`."""
    result = array(name, value, shape=(None,))
    below = result.min() < 0.0 and not negative
    refuse_if(below, f"holds {with_unit(name, result.min())}; loads cannot be negative", key=name)
    tiny = np.flatnonzero((result != 0.0) & (np.abs(result) < SMALLEST))
    if tiny.size:
        raise _beyond(f"{name}[{tiny[0]}]", result[tiny[0]], SMALLEST, LARGEST)
    return result


def instance(name: str, value: Any, kind: type | UnionType, required: str, *, optional: bool = False) -> None:
    """Refuse a value that is a class or not an instance of `kind`; an optional value may be None."""
    # a protocol is asked last, because it looks for each of its members
    known = kind in type(value).__mro__ or (optional and value is None)
    wrong = not known and (isinstance(value, type) or not isinstance(value, kind))
    refuse_if(wrong, f"must be {required}", key=name, value=shown(value) if wrong else None)


def scalar(value: Any) -> bool:
    """Return whether a value is a single number or quantity, not a list of them."""
    return not isinstance(value, range) and depth(value) == 0


def depth(value: Any) -> int:
    """Return the nesting depth of a list, or the number of axes of an array; 0 for a single value."""
    if isinstance(value, (list, tuple)):
        return 1 + (depth(value[0]) if value else 0)
    return int(getattr(value, "ndim", 0))


def increasing(name: str, value: FloatArray, *, first: int = 0) -> FloatArray:
    """Return `value` if its entries are positive and strictly increasing; errors index from `first`."""
    refuse_if(value[0] <= 0.0, "must be greater than 0", key=f"{name}[{first}]", value=value[0])
    least, most = bounds(name, positive=True)
    if value[0] < least:
        raise _beyond(f"{name}[{first}]", value[0], least, most)
    bad = np.flatnonzero(np.diff(value) <= 0.0)
    if bad.size:
        i = int(bad[0])
        words = "does not exceed the one before it; the values must increase"
        raise InvalidInput(words, key=f"{name}[{i + first + 1}]", value=value[i + 1])
    return value


def interval(name: str, value: Any) -> tuple[float, float]:
    """Return two positive numbers, of which the second must be the larger."""
    low, high = increasing(name, array(name, value, shape=(2,))).tolist()
    return low, high


def generator(rng: Any) -> np.random.Generator:
    """Return a random generator from a seed, or the generator itself."""
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        words = "must be a non-negative seed or a numpy Generator"
        raise InvalidInput(words, key="rng", value=shown(rng)) from None


def plain(name: str, value: Any) -> Any:
    """Return a value as plain numbers, in an array unless it is a single number of Python.

    Values with another unit than that of the argument `name`, and masked entries, are refused. Other values
    that are not numbers raise a TypeError or ValueError that states their type.
    """
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    unit, expected = getattr(value, "units", None) or getattr(value, "unit", None), unit_of(name)
    if unit is not None and str(unit) != expected:
        allowed = "numbers without unit" if expected == "1" else f"plain numbers in {expected}"
        raise InvalidInput(f"is given in {shown(str(unit))}; it must be {allowed}", key=name)
    refuse_if(np.ma.is_masked(value), "has masked entries; leave them out", key=name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # libraries of quantities warn when units are lost
        array = np.asarray(value)
        if array.dtype.kind in FOREIGN or value is None:
            raise TypeError(f"{name} is {shown(value)}")
        return array.astype(np.float64) if array.dtype.kind == "O" else array


def array_with_gaps(name: str, value: Any, *, shape: tuple[int | None, ...]) -> FloatArray:
    """Return `value` as `array` does, but allow nan for entries that were not measured."""
    missing: Any = False
    with suppress(TypeError, ValueError):  # `array` reports the problem
        entries = np.array(plain(name, value), dtype=np.float64)
        missing = np.isnan(entries)
        value = np.where(missing, 0.0, entries)
    return np.where(missing, np.nan, array(name, value, shape=shape))


def refuse_entries(name: str, values: FloatArray, wrong: Any, must: str) -> None:
    """Raise InvalidInput for the first entry of `values` at which the mask `wrong` is true."""
    if np.any(wrong):
        place = tuple(np.argwhere(wrong)[0].tolist())
        entry = f"{name}[{', '.join(map(str, place))}]"
        raise InvalidInput(must, key=entry, value=float(values[place]))
