"""Hertz's law of a sphere and a plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray


@dataclass(frozen=True)
class Hertz:
    """Frictionless, non-adhesive elastic contact of a paraboloid of radius R and a rigid plane.

    With the indentation d: ``a^2 = R d``, ``A = pi R d``, ``P/E* = 4/3 sqrt(R) d^(3/2)``.
    Valid for contact radii well below R; with a fitted modulus it holds within a few percent up to
    a/R = 0.5. Hertz, J. reine angew. Math. 92, 156 (1882), doi:10.1515/crll.1882.92.156.

    Examples
    --------
    >>> d, R = np.array([-0.01, 0.0, 0.04]), np.array([0.5, 0.5, 1.0])
    >>> Hertz().load(d, R).round(6)
    array([0.      , 0.      , 0.010667])
    """

    def load(self, indentation: FloatArray, radius: FloatArray) -> FloatArray:
        """Rescaled load P/E* = 4/3 sqrt(R) d^(3/2) [mm^2]."""
        d = np.maximum(indentation, 0.0)
        return np.asarray(4.0 / 3.0 * np.sqrt(radius * d) * d)

    def area(self, indentation: FloatArray, radius: FloatArray) -> FloatArray:
        """Contact area pi R d [mm^2]."""
        return np.asarray(math.pi * radius * np.maximum(indentation, 0.0))

    def stiffness(self, indentation: FloatArray, radius: FloatArray) -> FloatArray:
        """Derivative of P/E* by d: 2 sqrt(R d) [mm]."""
        return np.asarray(2.0 * np.sqrt(radius * np.maximum(indentation, 0.0)))
