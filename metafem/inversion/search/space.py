"""Unknowns of a search with their limits and random changes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.search.options import SearchOptions

# Heights within this fraction of the span of the lowest that is allowed are at the foot: rounding.
AT_FOOT = 1e-9


class Space(Protocol):
    """The unknowns of a search, a vector of lengths, with their limits and random changes."""

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest unknowns within the limits."""
        ...

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the indices of the tallest height and of those as low as allowed."""
        ...

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, options: SearchOptions) -> FloatArray:
        """Return unknowns changed at random."""
        ...


@dataclass(frozen=True)
class Heights:
    """Heights (n,) that differ by at most `span` [mm].

    A random change may add or remove a few asperities, up to `most` in all; with None their number is
    fixed.
    """

    span: float
    most: int | None = None

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the heights, raised where they are more than `span` below the tallest."""
        return np.asarray(np.maximum(unknowns, unknowns.max() - self.span))

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the indices of the tallest height and of those `span` below it."""
        return ends(unknowns, self.span)

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, options: SearchOptions) -> FloatArray:
        """Return heights moved at random by about their spacing, with a few added or removed."""
        return moved(unknowns, self.most, rng, options)[0]


def ends(height: FloatArray, span: float) -> tuple[int, IntArray]:
    """Return the indices of the tallest height and of those a span below it."""
    tallest = int(height.argmax())
    return tallest, np.flatnonzero(height <= height[tallest] - span * (1.0 - AT_FOOT))


def moved(
    height: FloatArray, most: int | None, rng: np.random.Generator, options: SearchOptions
) -> tuple[FloatArray, IntArray]:
    """Return heights moved at random by about their spacing, and the asperity that each derives from."""
    n = len(height)
    every = np.arange(n)
    spacing = float(np.ptp(height)) / n * rng.choice(options.change_sizes)
    result = height + spacing * rng.standard_normal(n) * (
        rng.random(n) < rng.choice(options.change_fractions)
    )
    if most is None:
        return result, every
    if n < most and rng.random() < options.adding:
        source = rng.integers(n, size=rng.integers(1, min(options.most_added, most - n) + 1))
        new = height[source] + spacing * rng.standard_normal(len(source))
        return np.append(result, new), np.append(every, source)
    if n > 2 and rng.random() < options.removing:
        removed = rng.integers(n)
        return np.delete(result, removed), np.delete(every, removed)
    return result, every
