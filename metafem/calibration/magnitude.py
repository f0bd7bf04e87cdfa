"""Detection of values in a wrong unit, and hints at the correct unit."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.notes import Note

# Pairs of units that are easily confused in tables, the smaller unit first.
CONFUSED = {"force": ("mN", "N"), "area": ("um2", "mm2")}

# Ratio of a value to the expected value beyond which the unit is assumed to be wrong: the square root of
# 1000, the smallest factor between two units.
OFF = math.sqrt(1e3)


def unit_hint(name: str, ratio: float) -> str:
    """Return a hint at the correct unit of a column whose values are `ratio` times the expected values.

    Examples
    --------
    >>> unit_hint("load", 1000.0)
    'check the unit of load: load_mN would fit where a table says load_N'
    """
    small, large = CONFUSED["area" if "area" in name else "force"]
    right, wrong = (small, large) if ratio > 1.0 else (large, small)
    return f"check the unit of {name}: {name}_{right} would fit where a table says {name}_{wrong}"


def is_off(ratio: float) -> bool:
    """Return whether a ratio to the expected value indicates a wrong unit."""
    return not 1.0 / OFF < ratio < OFF


def beyond(name: str, ratio: float) -> str:
    """Return a unit hint as the end of a sentence, or "" if the ratio does not indicate a wrong unit."""
    return f"; {unit_hint(name, ratio)}" if is_off(ratio) else ""


def within_errors(name: str, values: FloatArray, sd: FloatArray) -> tuple[Note, ...]:
    """Return a note if no value (k,) exceeds its standard deviation, else no note."""
    known = np.isfinite(values) & np.isfinite(sd)
    if not known.any() or (np.abs(values[known]) > sd[known]).any():
        return ()
    return (
        Note(
            f"no value of {name} exceeds its standard deviation: the largest is "
            f"{float(np.abs(values[known] / sd[known]).max()):.2g} of it, and a law cannot be "
            f"fitted to them; {unit_hint(name, 0.0)}, or state the errors of the measurement"
        ),
    )
