"""How large the errors of a part, of its alignment and of its calibration are expected to be."""

from __future__ import annotations

import math
from dataclasses import dataclass

from metafem import _validate as check
from metafem._calls import checked_class
from metafem.surface import STEEPEST

# Largest relative standard deviation: a third, so that a factor is positive within three of them.
WIDEST = 1.0 / 3.0


@checked_class
@dataclass(frozen=True)
class Priors:
    """Standard deviations of the errors that may explain a measured law; all are independent and Gaussian.

    With 0 an error is left out. The defaults of E*, sigma B, the tilt and the height scale are those for
    which `explain` is validated; the errors of the heights and radii are those of the parts of Aymard et al.,
    Science 383, 200 (2024), doi:10.1126/science.adk4234, which states no error of the positions.

    Parameters
    ----------
    angle_sd : float
        Of the tilt about either axis [rad], from 0 to pi/4; default: 0.05 degrees.
    height_scale_sd : float
        Relative, of a common factor of all heights [-]; default: 0.02.
    composite_modulus_sd : float
        Relative, of E* [-]; default: 0.05.
    friction_sd : float
        Relative, of sigma B, the friction force per initial contact area [-]; default: 0.05.
    height_sd : float
        Of each height by itself [mm]; default: 0.9 um.
    radius_sd : float
        Of each radius [mm]; default: 5 um.
    position_sd : float
        Of x and of y of each site [mm]; default: 0.
    adhesion_root_sd : float
        Relative, of the root of the adhesion energy of adhesive contacts [-]; default: 0.2, about that of
        three tests of a calibration.

    Raises
    ------
    InvalidInput
        If a value is negative, or a relative one above 1/3.

    Examples
    --------
    >>> Priors(height_sd=0.0, radius_sd=0.0).composite_modulus_sd
    0.05
    """

    angle_sd: float = math.radians(0.05)
    height_scale_sd: float = 0.02
    composite_modulus_sd: float = 0.05
    friction_sd: float = 0.05
    height_sd: float = 0.9e-3
    radius_sd: float = 5e-3
    position_sd: float = 0.0
    adhesion_root_sd: float = 0.2

    def __post_init__(self) -> None:
        check.member(self, "angle_sd", at_least=0.0, at_most=STEEPEST)
        for name in ("height_scale_sd", "composite_modulus_sd", "friction_sd", "adhesion_root_sd"):
            check.member(self, name, at_least=0.0, at_most=WIDEST)
        for name in ("height_sd", "radius_sd", "position_sd"):
            check.member(self, name, at_least=0.0)
