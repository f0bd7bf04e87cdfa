"""Comparison of values with type annotations, including members of tuples and mappings."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from types import UnionType
from typing import Any, Union, get_args, get_origin

import numpy as np


def fits(value: Any, hint: Any) -> bool:
    """Return whether a value is of the annotated type; numbers must be finite."""
    origin, parts = _parts_of(hint)
    if origin in (Union, UnionType):
        return any(fits(value, part) for part in parts)
    if origin is tuple:
        if not isinstance(value, tuple):
            return False
        kinds = (parts[0],) * len(value) if parts[1:] == (...,) else parts
        return len(value) == len(kinds) and all(map(fits, value, kinds))
    if origin is not None and issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(
            fits(key, parts[0]) and fits(member, parts[1]) for key, member in value.items()
        )
    if origin is np.ndarray:
        (dtype,) = get_args(parts[1])
        return isinstance(value, np.ndarray) and value.dtype == dtype and bool(np.isfinite(value).all())
    if hint in (float, int):
        number = isinstance(value, (int, float) if hint is float else int) and not isinstance(value, bool)
        return number and abs(value) <= (sys.float_info.max if hint is float else 2**63 - 1)
    return isinstance(value, hint)


def with_whole_keys(value: Any, hint: Any) -> Any:
    """Return a mapping with whole numbers as keys if the hint has them; keys of JSON are texts."""
    origin, parts = _parts_of(hint)
    whole = origin is not None and parts[:1] == (int,) and issubclass(origin, Mapping)
    if not whole or not isinstance(value, Mapping):
        return value
    return {int(key) if key.isascii() and key.isdigit() else key: member for key, member in value.items()}


def in_words(hint: Any) -> str:
    """Return a short name of an annotation for an error."""
    origin, parts = _parts_of(hint)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(in_words(part) for part in parts))
    if origin is np.ndarray:
        return f"finite numbers ({get_args(parts[1])[0].__name__})"
    if origin is tuple:
        return f"a list, each {in_words(parts[0])}" if ... in parts else f"a list of {len(parts)}"
    simple = {float: "a finite number", int: "a whole number", str: "a text", bool: "true or false"}
    simple |= {type(None): "null"}
    return simple.get(hint, f"a {getattr(origin or hint, '__name__', hint)}")


def _parts_of(hint: Any) -> tuple[Any, tuple[Any, ...]]:
    """Return the class and the parameters of an annotation; an alias such as NDArray is resolved."""
    origin, parts = get_origin(hint), get_args(hint)
    if hasattr(origin, "__value__"):
        hint = origin.__value__[parts]
        origin, parts = get_origin(hint), get_args(hint)
    return origin, parts
