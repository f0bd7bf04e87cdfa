"""Manufacturing and alignment errors of a surface, and random samples of such surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.models import Independent, Model
from metafem.models.error import without_jumps
from metafem.models.model import contact_of
from metafem.surface import STEEPEST, Surface

# Smallest allowed ratio of a radius to its standard deviation, so that all perturbed radii are positive: a
# normal number below -10 has the probability 1e-23.
WIDEST_RADIUS = 10.0

# Number m of draws for the scatter, whose relative standard error is 1/sqrt(2 (m - 1)): 4 %. Above this
# number of heights in all there are fewer draws; 30 loads then take between 0.1 and 3 s. The largest number
# of asperities has 33 draws, and an error of 13 %.
DRAWS, HEIGHTS, MOST = 256, 1_000_000, 30_000


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

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0, 0], [1.5, 0]], [0.1, 0.12], 0.526, mf.Material(1.36))
    >>> height, radius, position = Tolerances(height_sd=0.003).perturbed(surface, 2, np.random.default_rng(0))
    >>> height.round(4), radius, position
    (array([[0.1004, 0.1196],
           [0.1019, 0.1203]]), None, None)
    """

    height_sd: float = 0.0
    angle: float = 0.0
    radius_sd: float = 0.0
    position_sd: float = 0.0

    def __post_init__(self) -> None:
        check.member(self, "angle", at_least=0.0, at_most=STEEPEST)
        for name in ("height_sd", "radius_sd", "position_sd"):
            check.member(self, name, at_least=0.0)

    def perturbed(
        self, surface: Surface, count: int, random: np.random.Generator
    ) -> tuple[FloatArray, FloatArray | None, FloatArray | None]:
        """Return random samples of a surface.

        The same generator gives the same normal numbers to heights of any standard deviation.

        Returns
        -------
        ndarray, (count, n)
            Heights [mm].
        ndarray, (count, n), or None
            Radii [mm]; None if they have no errors.
        ndarray, (count, n, 2), or None
            Positions [mm]; None if they have no errors.
        """
        most, shape = float(surface.radius.min()) / WIDEST_RADIUS, (count, surface.count)
        words = f"must be at most a tenth of the smallest radius, {most:g} mm"
        refuse_if(self.radius_sd > most, words, key="radius_sd", value=self.radius_sd)
        height = surface.height + self.height_sd * random.standard_normal(shape)
        radius = position = None
        if self.radius_sd > 0.0:
            radius = surface.radius + self.radius_sd * random.standard_normal(shape)
        if self.position_sd > 0.0:
            position = surface.position + self.position_sd * random.standard_normal((*shape, 2))
        if self.angle > 0.0:
            surface.refuse_tilt()
            slope = np.tan(random.uniform(-self.angle, self.angle, (count, 2, 1)))
            x, y = np.moveaxis(surface.position if position is None else position, -1, 0)
            height = height + slope[:, 0] * x + slope[:, 1] * y
        return height, radius, position


def scatter(
    surface: Surface, model: Model, load: FloatArray, height_sd: float
) -> tuple[FloatArray, FloatArray]:
    """Return mean and SD of A0 with errors of the heights over A0 without, at positive loads (k,) [mm^2].

    Both are (k,) [-], from draws of independent asperities with the contact law of the model, without
    adhesion where `without_jumps` says so. Raise InvalidInput for more than `MOST` asperities.
    """
    refuse_if(surface.count > MOST, f"the scatter is not estimated for more than {MOST:,} asperities")
    used = without_jumps(surface, Independent(contact_of(model)))
    draws = min(DRAWS, HEIGHTS // surface.count)
    height = Tolerances(height_sd).perturbed(surface, draws, np.random.default_rng(0))[0]
    ratio = used.areas(surface, load, height) / used.curve(surface, load).checked().area
    return np.nanmean(ratio, axis=0), np.nanstd(ratio, axis=0, ddof=1)
