"""The elastic half-space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from metafem._validate import FloatArray
from metafem.substrate.radial import Radial


@dataclass(frozen=True)
class HalfSpace(Radial):
    """An elastic half-space: ``G(r) = 1/(pi r)``.

    It is valid if the distances between asperities are small compared with the block. Boussinesq (1885);
    Johnson, Contact Mechanics, equation 3.22a, doi:10.1017/CBO9781139171731.

    Examples
    --------
    >>> HalfSpace().influence([1.0, 2.0]).round(6)
    array([0.31831 , 0.159155])
    """

    name: ClassVar[str] = "half-space"
    self_influence: ClassVar[float] = 0.0  # Hertz's law contains the response of the half-space
    self_curvature: ClassVar[float] = 0.0

    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return three arrays of zeros: a half-space has no regular part."""
        return np.zeros_like(distance), np.zeros_like(distance), np.zeros_like(distance)

    def transform(self, wavenumber: FloatArray) -> FloatArray:
        """Return zeros: a half-space has no regular part, and its mean displacement is left out."""
        return np.zeros_like(wavenumber)
