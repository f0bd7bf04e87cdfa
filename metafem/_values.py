"""Base class of frozen dataclasses with arrays (bitwise equality, hash, short repr), and number texts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Micrometres per millimetre.
MICROMETRES = 1e3

# Largest number of entries that a repr prints; for longer arrays it prints their number and range.
MOST_PRINTED = 6


class Value:
    """Base class of dataclasses declared ``frozen=True, eq=False, repr=False``.

    Two values are equal if they have the same type and all their compared members are equal. Arrays are equal
    if their types, shapes and bits are equal; the order of mappings does not matter. Equal values have the
    same hash.
    """

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._members() == other._members()

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((type(self), self._members()))

    def __repr__(self) -> str:
        shown = [field.name for field in fields(self) if field.repr]  # type: ignore[arg-type]
        members = (f"{name}={_short(getattr(self, name))}" for name in shown)
        return f"{type(self).__name__}({', '.join(members)})"

    def __getstate__(self) -> dict[str, Any]:
        for field in fields(self):  # type: ignore[arg-type]
            getattr(self, field.name)  # a delayed value is computed: its function cannot always be pickled
        return {name: value for name, value in self.__dict__.items() if name != "_hash"}  # differs elsewhere

    def _members(self) -> tuple[Any, ...]:
        compared = [field.name for field in fields(self) if field.compare]  # type: ignore[arg-type]
        return tuple(_comparable(getattr(self, name)) for name in compared)


def span(values: NDArray[Any], unit: str) -> str:
    """Return text with the range of an array and its unit, or one value if all entries are equal."""
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def three_digits(value: float) -> str:
    """Return a number as text with three significant digits; large numbers have no exponent.

    Examples
    --------
    >>> three_digits(0.97123), three_digits(1514.6), three_digits(2e-7)
    ('0.971', '1,510', '2e-07')
    """
    return f"{float(f'{value:.3g}'):,.9g}"


def percent(fraction: float, form: str = ".2g") -> str:
    """Return a fraction as text in percent; large values are integers without an exponent.

    Examples
    --------
    >>> percent(0.0123), percent(1.234), percent(12.0)
    ('1.2 %', '123 %', '1200 %')
    """
    text = f"{100.0 * fraction:{form}}"
    if "e+" in text:
        text = f"{100.0 * fraction:{'+' if form.startswith('+') else ''}.0f}"
    return f"{text} %"


def _comparable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Mapping):
        return frozenset((name, _comparable(member)) for name, member in value.items())
    if isinstance(value, (tuple, list)):
        return tuple(map(_comparable, value))
    if isinstance(value, float) and math.isnan(value):
        return repr(value)
    return value


def _short(value: Any) -> str:
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.size <= MOST_PRINTED:
        return repr(value.tolist())
    return f"<{' x '.join(map(str, value.shape))} numbers, {value.min():.4g} to {value.max():.4g}>"
