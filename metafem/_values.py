"""What frozen dataclasses that hold arrays share: equality to the bit, a hash and a short repr."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Entries that a repr prints one by one; of more, it says how many there are and their range.
MOST_PRINTED = 6


class Value:
    """Base of dataclasses declared ``frozen=True, eq=False, repr=False``.

    Two values are equal if they are of one type and all compared members are equal: arrays in type, shape
    and every bit, members of a mapping whatever their order. Equal values have one hash.
    """

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return self._members() == other._members()

    def __hash__(self) -> int:
        return hash((type(self), self._members()))

    def __repr__(self) -> str:
        shown = [field.name for field in fields(self) if field.repr]  # type: ignore[arg-type]
        members = (f"{name}={_short(getattr(self, name))}" for name in shown)
        return f"{type(self).__name__}({', '.join(members)})"

    def _members(self) -> tuple[Any, ...]:
        compared = [field.name for field in fields(self) if field.compare]  # type: ignore[arg-type]
        return tuple(_comparable(getattr(self, name)) for name in compared)


def span(values: NDArray[Any], unit: str) -> str:
    """Return the one value of an array or its range, with a unit.

    Examples
    --------
    >>> span(np.array([0.12, 0.084]), "mm"), span(np.array([0.5, 0.5]), "mm")
    ('0.084 to 0.12 mm', '0.5 mm')
    """
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def _comparable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, Mapping):
        return frozenset((name, _comparable(member)) for name, member in value.items())
    if isinstance(value, (tuple, list)):
        return tuple(map(_comparable, value))
    return value


def _short(value: Any) -> str:
    if not isinstance(value, np.ndarray):
        return repr(value)
    if value.size <= MOST_PRINTED:
        return repr(value.tolist())
    return f"<{' x '.join(map(str, value.shape))} numbers, {value.min():.4g} to {value.max():.4g}>"
