"""Standard deviations of measured loads, contact areas and friction forces."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray


@dataclass(frozen=True)
class MeasurementErrors:
    """Standard deviations of measurement errors, which are independent of each other.

    The standard deviation is ``load`` for a load, ``boundary * 2 sqrt(pi A)`` (the perimeter times the error
    of the boundary) for a contact of area A, and ``friction_force + friction_relative F`` for a friction
    force F. The default values are the error bars of Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234, caption of Fig. 2.

    Parameters
    ----------
    load : float
        Standard deviation of a load [N], positive; default: 5 mN.
    boundary : float
        Standard deviation of the position of a contact's boundary [mm], positive; default: 1.4 um.
    friction_force : float
        Standard deviation of a friction force of zero [N], positive; default: 1 mN.
    friction_relative : float
        Relative part of the standard deviation of a friction force [-], not negative; default: 0.01.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> errors = MeasurementErrors()
    >>> errors.of_area(np.array([0.01, 0.04])).round(6), errors.of_friction_force(np.array([0.1])).round(6)
    (array([0.000496, 0.000993]), array([0.002]))
    """

    load: float = 5e-3
    boundary: float = 1.4e-3
    friction_force: float = 1e-3
    friction_relative: float = 0.01

    def __post_init__(self) -> None:
        for name in ("load", "boundary", "friction_force"):
            check.member(self, name, above=0.0)
        check.member(self, "friction_relative", at_least=0.0)

    def of_load(self, load: FloatArray) -> FloatArray:
        """Return the standard deviations of loads [N]."""
        return np.full(np.shape(load), self.load)

    def of_area(self, area: FloatArray) -> FloatArray:
        """Return the standard deviations of the areas of single contacts [mm^2]."""
        return 2.0 * self.boundary * np.sqrt(math.pi * np.maximum(area, 0.0))

    def of_friction_force(self, force: FloatArray) -> FloatArray:
        """Return the standard deviations of friction forces [N]."""
        return self.friction_force + self.friction_relative * np.abs(force)
