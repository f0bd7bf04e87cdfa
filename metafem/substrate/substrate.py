"""What every elastic substrate offers."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from metafem._validate import FloatArray
from metafem.surface import Surface


@runtime_checkable
class Substrate(Protocol):
    """Green's function of the block: surface displacement per unit of rescaled load P/E*."""

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Displacement at each asperity per load on each other, (n, n) [1/mm].

        The diagonal holds the regular self terms: what the block adds to a half-space's own answer.
        """
        ...
