"""Expected errors of a part, the same errors as standard normal numbers, and the part that they make."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.surface import STEEPEST, Surface

# Errors of the whole part and of the calibration, one number each.
COMMON = ("angle_x", "angle_y", "height_scale", "composite_modulus", "friction", "adhesion_root")

# Errors of single asperities, one number or two of each asperity.
SINGLE = ("height", "radius", "position")

# Causes that are combined in tables and in the shares of the misfit.
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

# Smallest true load over the standard deviation of a measured one: a contact needs a positive load.
LIGHTEST = 0.01

# Smallest radius of a made summit over the designed one, and smallest factor of E*, sigma B and sqrt(w).
LEAST = 0.1


# Largest relative standard deviation: a third, so that a factor is positive within three of them.
WIDEST = 1.0 / 3.0


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
        Of a common factor of all heights, relative [-]; default: 0.02.
    composite_modulus_sd : float
        Of E*, relative [-]; default: 0.05.
    friction_sd : float
        Of sigma B, the friction force per initial contact area, relative [-]; default: 0.05.
    height_sd : float
        Of each single height [mm]; default: 0.9 um.
    radius_sd : float
        Of each radius [mm]; default: 5 um.
    position_sd : float
        Of x and of y of each site [mm]; default: 0.
    adhesion_root_sd : float
        Of the root of the adhesion energy of adhesive contacts, relative [-]; default: 0.2, about the error
        of a calibration with three tests.

    Raises
    ------
    InvalidInput
        If a value is negative, or if a relative one exceeds 1/3.

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
    """A made part, and the true loads of its measurement."""

    surface: Surface  # its heights contain the tilt
    slope: FloatArray  # (2,), tangents of the tilts
    factor: Mapping[str, float]  # of E*, sigma B and the root of the adhesion energy, over the nominal ones
    load: FloatArray  # (k,), [N]


@dataclass(frozen=True, eq=False)
class Causes:
    """Place of each unknown among the standard normal numbers z (p,), and its prior standard deviation.

    The last k numbers are the errors of the measured loads, over their standard deviations.
    """

    surface: Surface
    load: FloatArray
    load_sd: FloatArray
    sd: dict[str, float]
    wide: dict[int, float]  # standard deviations of the heights of outliers [mm], by asperity
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
        """Return the unknowns with a prior that is not 0.

        friction: whether friction forces were measured; adhesive: whether the contacts are adhesive.
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
        """Number of unknowns, p."""
        return int(self.where["load"].stop)

    @property
    def common(self) -> list[str]:
        """Names of the errors of the whole part."""
        return [name for name in COMMON if name in self.sd]

    @property
    def single(self) -> list[str]:
        """Names of the errors of single asperities."""
        return [name for name in SINGLE if name in self.sd]

    def value(self, name: str, z: FloatArray) -> FloatArray:
        """Return an error in its unit."""
        if name == "load":
            return np.asarray(self.load_sd * z[self.where["load"]])
        if name not in self.sd:
            return np.zeros(1)
        return np.asarray(self.scale(name) * z[self.where[name]])

    def scale(self, name: str) -> FloatArray:
        """Return the standard deviation of each number of one kind, in its unit."""
        where = self.where[name]
        result = np.full(where.stop - where.start, self.sd[name])
        if name == "height":
            for i, sd in self.wide.items():
                result[i] = sd
        return result

    def made(self, z: FloatArray) -> Made:
        """Return the part with these errors, and the true loads."""
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
