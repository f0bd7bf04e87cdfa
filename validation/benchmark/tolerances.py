"""Tolerances that the studies of 20 designs state for 5 spans of errors each, against plain draws.

Over the five spans, which lie a factor of 100 to 4,500 apart, the stated tolerances may differ by 3 %, and
what plain draws show at them may differ from what is stated by as much.
"""

from __future__ import annotations

from collections import defaultdict

from validation.scenes.stated_tolerances import differences
from validation.timing import Row

# Designs and plain draws of each, for a quick look and in full; largest relative difference.
FEW, MANY = (2, 10_000), (20, 100_000)
ALLOWED = 0.03


def rows() -> list[Row]:
    """Compare the tolerances of two designs with 10,000 draws."""
    return _rows(*FEW)


def long_rows() -> list[Row]:
    """Compare the tolerances of 20 designs with 100,000 draws."""
    return _rows(*MANY)


def _rows(designs: int, draws: int) -> list[Row]:
    largest: dict[str, float] = defaultdict(float)
    for seed in range(designs):
        for study, spans, drawn in differences(seed, draws):
            for what, value in (("between spans", spans), (f"from {draws:,} plain draws", drawn)):
                key = f"{study}, {designs} designs: largest difference {what}"
                largest[key] = max(largest[key], abs(value))
    return [Row(what, ALLOWED, value) for what, value in largest.items()]
