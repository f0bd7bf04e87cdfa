"""Expected errors of a part, their form as standard normal numbers, and the part with these errors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.surface import STEEPEST, Surface

# Errors of the entire part and of the calibration; each error is one number.
COMMON = ("angle_x", "angle_y", "height_scale", "composite_modulus", "friction", "adhesion_root")

# Errors of single asperities; a height or radius error is one number for each asperity, a position error two.
SINGLE = ("height", "radius", "position")

# Groups of errors that tables and shares of the misfit combine into one cause.
GROUPS = {
    "tilt": ("angle_x", "angle_y"),
    "height_scale": ("height_scale",),
    "composite_modulus": ("composite_modulus",),
    "friction": ("friction",),
    "adhesion_root": ("adhesion_root",),
    "height": ("height",),
    "radius": ("radius",),
    "position": ("position",),
}

# Smallest true load over the standard deviation of the measured load; the models need positive loads.
LIGHTEST = 0.01

# Smallest ratio of a made to a designed radius, and smallest factor of E*, sigma B and sqrt(w).
LEAST = 0.1


# Largest relative standard deviation of a factor; it keeps the factor positive within three standard
# deviations.
WIDEST = 1.0 / 3.0


@dataclass(frozen=True)
class Priors:
    """Prior standard deviations of the errors of a part, which are independent and Gaussian.

    An error with standard deviation 0 is left out. `explain` is validated for the default values of E*, sigma
    B, the tilt and the height scale. The default errors of heights and radii describe the parts of Aymard et
    al., Science 383, 200 (2024), doi:10.1126/science.adk4234. That paper states no error of the positions.

    Parameters
    ----------
    angle_sd : float
        Standard deviation of the tilt about either axis [rad], from 0 to pi/4; default: 0.05 degrees.
    height_scale_sd : float
        Relative standard deviation of a common factor of all heights [-]; default: 0.02.
    composite_modulus_sd : float
        Relative standard deviation of E* [-]; default: 0.05.
    friction_sd : float
        Relative standard deviation of sigma B, the friction force per initial contact area [-]; default:
        0.05.
    height_sd : float
        Standard deviation of each height [mm]; default: 0.9 um.
    radius_sd : float
        Standard deviation of each radius [mm]; default: 5 um.
    position_sd : float
        Standard deviation of both coordinates of each site [mm]; default: 0.
    adhesion_root_sd : float
        Relative standard deviation of the square root of the adhesion energy of adhesive contacts [-];
        default: 0.2, about the error of a calibration with three tests.

    Raises
    ------
    InvalidInput
        If a value is negative, or if a relative standard deviation exceeds 1/3.

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


@dataclass(frozen=True, eq=False)
class Made:
    """A made part and the true loads of its measurement."""

    surface: Surface  # its heights include the tilt
    slope: FloatArray  # (2,), tangents of the tilt angles
    factor: Mapping[str, float]  # E*, sigma B and sqrt(w) over their nominal values
    load: FloatArray  # (k,) [N]


@dataclass(frozen=True, eq=False)
class Causes:
    """Position of each unknown in the standard normal vector z (p,), and its prior standard deviation.

    The last k entries of z are the errors of the measured loads, over their standard deviations.
    """

    surface: Surface
    load: FloatArray
    load_sd: FloatArray
    sd: dict[str, float]
    wide: dict[int, float]  # prior standard deviations of outlying heights [mm], by asperity
    where: dict[str, slice]

    @staticmethod
    def of(
        surface: Surface,
        load: FloatArray,
        load_sd: FloatArray,
        priors: Priors,
        friction: bool,
        adhesive: bool = False,
    ) -> Causes:
        """Return the unknowns whose prior standard deviation is not 0.

        `friction` states whether friction forces were measured, `adhesive` whether the contacts are adhesive.
        """
        unknown = {"friction": friction, "adhesion_root": adhesive}
        sd = {
            name: getattr(priors, "angle_sd" if name in GROUPS["tilt"] else f"{name}_sd")
            for name in (*COMMON, *SINGLE)
            if unknown.get(name, True)
        }
        sd = {name: value for name, value in sd.items() if value > 0.0}
        where, end = {}, 0
        for name in sd:
            size = 1 if name in COMMON else surface.count * (2 if name == "position" else 1)
            where[name], end = slice(end, end + size), end + size
        where["load"] = slice(end, end + len(load))
        return Causes(surface, load, load_sd, sd, {}, where)

    @property
    def size(self) -> int:
        """Number p of unknowns."""
        return int(self.where["load"].stop)

    @property
    def common(self) -> list[str]:
        """Names of the errors of the entire part."""
        return [name for name in COMMON if name in self.sd]

    @property
    def single(self) -> list[str]:
        """Names of the errors of single asperities."""
        return [name for name in SINGLE if name in self.sd]

    def value(self, name: str, z: FloatArray) -> FloatArray:
        """Return the error of this name in its unit; 0 if it is not an unknown."""
        if name == "load":
            return np.asarray(self.load_sd * z[self.where["load"]])
        if name not in self.sd:
            return np.zeros(1)
        return np.asarray(self.scale(name) * z[self.where[name]])

    def scale(self, name: str) -> FloatArray:
        """Return the prior standard deviations of the error of this name, in its unit."""
        where = self.where[name]
        result = np.full(where.stop - where.start, self.sd[name])
        if name == "height":
            for i, sd in self.wide.items():
                result[i] = sd
        return result

    def made(self, z: FloatArray) -> Made:
        """Return the part with the errors z, and the true loads."""
        design, nominal = self.surface, self.surface.material
        slope = np.tan([self.value(name, z)[0] for name in GROUPS["tilt"]])
        position = design.position
        if "position" in self.sd:
            position = position + self.value("position", z).reshape(-1, 2)
        summits = design.height * (1.0 + self.value("height_scale", z)[0]) + self.value("height", z)
        factor = {
            name: max(1.0 + float(self.value(name, z)[0]), LEAST)
            for name in ("composite_modulus", "friction", "adhesion_root")
        }
        modulus = factor["composite_modulus"] * nominal.composite_modulus
        part = design.replaced(
            position=position,
            height=summits + position @ slope,
            radius=np.maximum(design.radius + self.value("radius", z), LEAST * design.radius),
            material=replace(nominal, composite_modulus=modulus),
        )
        load = np.maximum(self.load + self.value("load", z), LIGHTEST * self.load_sd)
        return Made(part, slope, factor, load)
