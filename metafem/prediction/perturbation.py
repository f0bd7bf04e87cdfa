"""Manufacturing and alignment errors of a surface, and random samples of such surfaces."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem.caps import Caps, Power
from metafem.caps.shapes import STEEPEST as STEEPEST_POWER
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.surface import STEEPEST, Surface

# Smallest allowed ratio of a radius, or another positive value, to its standard deviation. The smallest
# random number in (0, 1) is 2^-54, where the inverse normal distribution is -8.2, so that all perturbed radii
# are positive.
WIDEST_RADIUS = 10.0


class Perturbed(NamedTuple):
    """Random samples of a surface: heights, and also radii and positions unless these are constant (None).

    Attributes
    ----------
    height : ndarray, (m, n)
        Heights [mm].
    radius : ndarray, (m, n), or None
        Radii [mm].
    position : ndarray, (m, n, 2), or None
        Positions [mm].
    """

    height: FloatArray
    radius: FloatArray | None
    position: FloatArray | None


@dataclass(frozen=True)
class Tolerances:
    """Independent random errors of a manufactured surface and of its alignment.

    The heights, the radii and both coordinates of each site have Gaussian errors. The tilt angles along x and
    y are uniformly distributed in ``[-angle, angle]``. They tilt the surface about the origin, which changes
    the heights by ``x tan(angle_x) + y tan(angle_y)``. Source of the errors: Aymard et al., Science 383, 200
    (2024), doi:10.1126/science.adk4234, supplementary text, Figs. S2 and S3.

    Parameters
    ----------
    height_sd : float
        Standard deviation of the heights [mm], not negative; default: 0.
    angle : float
        Largest tilt angle along x and y [rad], from 0 to pi/4; default: 0.
    radius_sd : float
        Standard deviation of the radii [mm], not negative, at most a tenth of the smallest radius of the
        surface; default: 0.
    position_sd : float
        Standard deviation of the x and y coordinates of each site [mm], not negative; default: 0.
    exponent_sd : float
        Standard deviation of the exponent of each cap `metafem.Power` [-], not negative, at most a tenth of
        the difference of the exponents from 1 and from 32; default: 0. `metafem.studies.manufacturing`
        supports it. Each draw needs tables of its own for each asperity, about half a millisecond.
    coefficient_sd : float
        Standard deviation of the coefficient of each cap `metafem.Power` [-], not negative, at most a tenth
        of the smallest coefficient; default: 0. `metafem.studies.manufacturing` supports it.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0, 0], [1.5, 0]], [0.1, 0.12], 0.526, mf.Material(1.36))
    >>> tolerances = Tolerances(height_sd=0.003, angle=0.001)
    >>> tolerances.dimensions(surface)
    4
    >>> tolerances.perturbed(surface, np.array([[0.5, 0.5, 1.0, 0.5]])).height.round(4)
    array([[0.1   , 0.1215]])
    """

    height_sd: float = 0.0
    angle: float = 0.0
    radius_sd: float = 0.0
    position_sd: float = 0.0
    exponent_sd: float = 0.0
    coefficient_sd: float = 0.0

    def __post_init__(self) -> None:
        check.member(self, "angle", at_least=0.0, at_most=STEEPEST)
        for name in ("height_sd", "radius_sd", "position_sd", "exponent_sd", "coefficient_sd"):
            check.member(self, name, at_least=0.0)

    def scaled(self, factor: float) -> Tolerances:
        """Return the tolerances with all values multiplied by a non-negative factor."""
        return replace(self, **{name: factor * value for name, value in vars(self).items()})

    def dimensions(self, surface: Surface) -> int:
        """Return the number of independent random numbers for one sample of a surface.

        There is one number for each height, two for the tilt, one for each radius, two for each position, and
        one for each exponent and each coefficient.
        An error whose standard deviation or angle is 0 needs none.
        """
        return sum(self._counts(surface))

    def _counts(self, surface: Surface) -> list[int]:
        """Return how many random numbers the errors need, in the order of the members."""
        n = surface.count
        sizes = {"height_sd": n, "angle": 2, "radius_sd": n, "position_sd": 2 * n}
        sizes |= {"exponent_sd": n, "coefficient_sd": n}
        return [size if getattr(self, name) > 0.0 else 0 for name, size in sizes.items()]

    def perturbed(self, surface: Surface, unit: FloatArray) -> Perturbed:
        """Return samples of the surface from points that are uniformly distributed in the unit cube.

        Parameters
        ----------
        surface : Surface
            The nominal surface.
        unit : ndarray, (m, dimensions)
            Random or Sobol points; the coordinates, in (0, 1), have the order heights, tilts, radii,
            positions, exponents, coefficients.

        Returns
        -------
        Perturbed
        """
        refuse_if(
            unit.ndim != 2 or unit.shape[1] != self.dimensions(surface),
            f"unit has shape {unit.shape}; it must be (m, {self.dimensions(surface)})",
        )
        smallest = float(surface.radius.min())
        words, wide = "must be at most a tenth of the smallest radius, {.number}", self.radius_sd
        refuse_if(
            WIDEST_RADIUS * wide > smallest, words, Given("radius", smallest), key="radius_sd", value=wide
        )
        heights, tilts, radii, places, *_ = self._parts(surface, unit)
        height = np.broadcast_to(surface.height, (len(unit), surface.count))
        radius = position = None
        if self.height_sd > 0.0:
            height = height + self.height_sd * ndtri(heights)
        if self.radius_sd > 0.0:
            radius = surface.radius + self.radius_sd * ndtri(radii)
        if self.position_sd > 0.0:
            moved = self.position_sd * ndtri(places)
            position = surface.position + moved.reshape(-1, surface.count, 2)
        if self.angle > 0.0:
            surface.refuse_tilt()
            slope = np.tan(self.angle * (2.0 * tilts - 1.0))
            x, y = np.moveaxis(surface.position if position is None else position, -1, 0)
            height = height + slope[:, :1] * x + slope[:, 1:] * y
        return Perturbed(height, radius, position)

    def areas(self, model: Model, surface: Surface, load: FloatArray, unit: FloatArray) -> FloatArray:
        """Return A0 [mm^2] of samples at increasing rescaled loads (k,), (m, k); nan if not converged.

        unit: as for `perturbed`. Samples with errors of the exponents are solved one by one. A coefficient
        c has the effect of a radius: the cap ``c R (rho/R)^n`` is that of ``R (c/c_0)^(-1/(n - 1))`` with
        the coefficient c_0.
        """
        height, radius, position = self.perturbed(surface, unit)
        if not (self.exponent_sd or self.coefficient_sd):
            return model.areas(surface, load, height, radius, position)
        exponent, coefficient = self._shapes(surface, unit)
        if not self.exponent_sd:
            factor = (coefficient / self._nominal(surface)[1]) ** (-1.0 / (exponent - 1.0))
            radius = factor * (surface.radius if radius is None else radius)
            return model.areas(surface, load, height, radius, position)
        rows = []
        for i, shape in enumerate(zip(exponent.tolist(), coefficient.tolist(), strict=True)):
            part = surface.replaced(cap=Caps.of(map(Power, *shape)))
            others = (None if each is None else each[i : i + 1] for each in (radius, position))
            rows.append(model.areas(part, load, height[i : i + 1], *others))
        return np.concatenate(rows)

    def _parts(self, surface: Surface, unit: FloatArray) -> list[FloatArray]:
        """Return the random numbers of each error, in the order of the members."""
        return np.split(unit, np.cumsum(self._counts(surface))[:-1], axis=1)

    def _nominal(self, surface: Surface) -> tuple[FloatArray, FloatArray]:
        """Return exponents and coefficients of the caps, (n,) each; refuse caps that are no powers."""
        caps = [surface.cap.one(i) for i in range(surface.count)]
        powers = [cap for cap in caps if isinstance(cap, Power)]
        name = "exponent_sd" if self.exponent_sd else "coefficient_sd"
        words = f"needs caps metafem.Power(...), and not {surface.cap!r}"
        refuse_if(len(powers) < len(caps), words, key=name, value=getattr(self, name))
        return np.array([cap.exponent for cap in powers]), np.array([cap.coefficient for cap in powers])

    def _shapes(self, surface: Surface, unit: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the exponents and the coefficients of the samples, (m, n) each."""
        exponent, coefficient = self._nominal(surface)
        room = float(np.minimum(exponent - 1.0, STEEPEST_POWER - exponent).min())
        for name, most, of in (
            ("exponent_sd", room, "difference of an exponent from 1 and 32"),
            ("coefficient_sd", float(coefficient.min()), "coefficient"),
        ):
            limit, sd = f"must be at most a tenth of the smallest {of}, {most:g}", getattr(self, name)
            refuse_if(WIDEST_RADIUS * sd > most, limit, key=name, value=sd)
        *_, exponents, coefficients = self._parts(surface, unit)
        shape = len(unit), surface.count
        if self.exponent_sd > 0.0:
            exponent = exponent + self.exponent_sd * ndtri(exponents)
        if self.coefficient_sd > 0.0:
            coefficient = coefficient + self.coefficient_sd * ndtri(coefficients)
        return np.broadcast_to(exponent, shape), np.broadcast_to(coefficient, shape)

    def linear_covariance(self, surface: Surface, gradient: FloatArray) -> FloatArray:
        """Return the covariance (k, k) of linear functions of the heights, due to errors of heights and tilt.

        The covariance is ``g C g'`` with the gradients g and the covariance C of the heights. C has
        height_sd^2 on its diagonal; the tilt adds ``t x_i.x_j``, where ``t = tan(angle)/angle - 1`` is the
        variance of the tangent of a tilt angle. The mean change of every linear function is zero.

        Parameters
        ----------
        surface : Surface
            The nominal surface.
        gradient : ndarray, (k, n)
            Derivatives of k functions with respect to the heights, such as those of A0 at k loads [mm].

        Returns
        -------
        ndarray, (k, k)
        """
        if self.angle > 0.0:
            surface.refuse_tilt()
        tilt = math.tan(self.angle) / self.angle - 1.0 if self.angle > 0.0 else 0.0
        moment = gradient @ surface.position
        alone = self.height_sd**2 + 2.0 * tilt * self.position_sd**2
        return np.asarray(alone * (gradient @ gradient.T) + tilt * (moment @ moment.T))
