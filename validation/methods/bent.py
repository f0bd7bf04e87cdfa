"""Elastic contacts of caps with an extra curvature, which the field of the neighbours adds."""

import math
from typing import Any, NamedTuple

import numpy as np


class Bent(NamedTuple):
    """A law whose caps have the profile f + k rho²/2: D, P and M of a paraboloid are added to theirs."""

    law: Any  # without adhesion
    curvature: np.ndarray | float  # k [1/mm]

    def load(self, a: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Return P/E* [mm²]."""
        return self.law.load(a, radius) + 4.0 / 3.0 * self.curvature * a**3

    def indentation(self, a: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Return d [mm]."""
        return self.law.indentation(a, radius) + self.curvature * a**2

    def second_moment(self, a: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Return the second moment of the pressure over E* [mm⁴]."""
        return self.law.second_moment(a, radius) + 8.0 / 15.0 * self.curvature * a**5

    def profile_slope(self, a: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Return dd/da [-], for a > 0."""
        return self.law.profile_slope(a, radius) + 2.0 * self.curvature * a

    def area_slope(self, a: np.ndarray, radius: np.ndarray) -> np.ndarray:
        """Return dA/dd [mm], for a > 0."""
        return 2.0 * math.pi * a / self.profile_slope(a, radius)
