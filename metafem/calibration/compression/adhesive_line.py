"""The straight line with which Aymard et al. (2024) determine E* and the adhesion energy."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.covariance import propagated


@dataclass(frozen=True, eq=False, repr=False)
class AdhesiveLine(Value):
    """Line through ``x = pi^(1/4) p/(sqrt(6) a0^(3/4))`` and ``y = a0^(3/4)/(sqrt(6) pi^(5/4) R)``.

    p and a0 are the load and the area of a single contact of radius R. The line is fitted by least squares.
    For a paraboloid, the law of Johnson, Kendall and Roberts is a straight line with the slope ``3/(4 E*)``
    and the intercept ``sqrt(3 w/(4 E*))``. The least-squares fit neglects the errors of x, which grow as the
    contacts shrink. Therefore the fitted slope is too small and E* is too large. Aymard et al., Science 383,
    200 (2024), doi:10.1126/science.adk4234, supplementary text "Calibration of individual microcontacts".

    Attributes
    ----------
    x, y : ndarray, (k,)
        Coordinates of the measured points [MPa sqrt(mm)], [sqrt(mm)].
    slope, intercept : float
        Slope [1/MPa] and intercept [sqrt(mm)] of the line.
    composite_modulus, adhesion_root : float
        E* [MPa], and sqrt(w) [sqrt(N/mm)] with the sign of the intercept.
    root_covariance : ndarray, (2, 2)
        Covariance of E* and sqrt(w), from the scatter about the line.

    Examples
    --------
    >>> a = np.linspace(0.08, 0.4, 20)
    >>> load = 4 / 3 * 1.36 * a**3 / 0.526 - np.sqrt(8 * np.pi * 9e-6 * 1.36 * a**3)
    >>> line = adhesive_line(load, np.pi * a**2, 0.526)
    >>> round(line.composite_modulus, 6), round(line.adhesion_energy, 9)
    (1.36, 9e-06)
    """

    x: FloatArray
    y: FloatArray
    slope: float
    intercept: float
    composite_modulus: float
    adhesion_root: float
    root_covariance: FloatArray

    @property
    def adhesion_energy(self) -> float:
        """Adhesion energy w [N/mm]; 0 if the intercept is negative."""
        return max(self.adhesion_root, 0.0) ** 2


def adhesive_line(load: FloatArray, area: FloatArray, radius: float) -> AdhesiveLine:
    """Return the line through loads p [N] and areas a0 [mm^2], (k,), of single contacts of one radius [mm].

    If the arrays have more axes, (..., k), the function fits one line along each last axis.
    """
    power = area**0.75
    x = math.pi**0.25 * load / (math.sqrt(6.0) * power)
    y = power / (math.sqrt(6.0) * math.pi**1.25 * radius)
    centre, count = x.mean(axis=-1), x.shape[-1]
    apart = x - centre[..., None]
    spread = (apart**2).sum(axis=-1)
    slope = (apart * y).sum(axis=-1) / spread
    intercept = y.mean(axis=-1) - slope * centre
    left = ((y - intercept[..., None] - slope[..., None] * x) ** 2).sum(axis=-1) / (count - 2)
    both = -centre / spread
    entries = np.stack([1.0 / spread, both, both, 1.0 / count + centre**2 / spread], axis=-1)
    covariance = left[..., None, None] * entries.reshape(*slope.shape, 2, 2)
    with np.errstate(invalid="ignore"):
        modulus = 0.75 / slope
        root = intercept / np.sqrt(slope)  # sqrt(4 E*/3) = 1/sqrt(slope)
        rows = (-modulus / slope, 0.0), (-0.5 * root / slope, 1.0 / np.sqrt(slope))
    covariance, found = propagated(covariance, *rows), (slope, intercept, modulus, root)
    slope, intercept, modulus, root = (each.item() if load.ndim == 1 else each for each in found)
    return AdhesiveLine(x, y, slope, intercept, modulus, root, covariance)
