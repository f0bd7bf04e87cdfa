"""Measured quantities of which some may be missing."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import formatted, label, plain, shown
from metafem._validate import FloatArray
from metafem.errors import InvalidInput


def measured_or_nan(name: str, value: ArrayLike) -> FloatArray:
    """Return forces (k,), or positive areas (k,) added over contacts (k, n); nan where not measured."""
    try:
        entries = np.array(plain(name, value), dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} is not an array of numbers: {shown(value, 80)}") from None
    force = name == "friction_force"
    if entries.ndim not in ((1,) if force else (1, 2)) or not entries.size:
        shape = "(k,)" if force else "(k,) or (k, n)"
        raise InvalidInput(f"{name} has shape {entries.shape}; it must have shape {shape}")
    if np.isinf(entries).any():
        held = entries[np.isinf(entries)][0]
        raise InvalidInput(f"{name} holds {held}; write nan where it was not measured")
    known = entries[np.isfinite(entries)]
    if known.size:
        check.array(name, known, shape=(None,))
    if not force and known.size and known.min() <= 0.0:
        index = ", ".join(str(i) for i in np.argwhere(entries <= 0.0)[0])
        least = formatted(name, float(entries[entries <= 0.0][0]))
        raise InvalidInput(
            f"{label(f'{name}[{index}]')} = {least} must be greater than 0; leave out points without contact"
        )
    total: FloatArray = entries if entries.ndim == 1 else entries.sum(axis=1)
    return total
