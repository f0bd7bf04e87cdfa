"""Measured area ratio and shear strength of a material pair."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from metafem import drawing
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.bounded_interval import interval_of
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.calibration.verdict import Heterogeneity, SingleTest, Verdict
from metafem.drawing import calibration
from metafem.errors import refuse_if
from metafem.material import Friction
from metafem.notes import Note

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class ShearCalibration(Value):
    """Area ratio B and shear strength sigma from sheared contacts, with their errors.

    Attributes
    ----------
    area_ratio, shear_strength : float
        B [-] and sigma [MPa].
    covariance : ndarray, (2, 2)
        Covariance of B and sigma, in this order. Both depend on the sheared area, so they are correlated.
    area_before, area_sheared, friction_force : ndarray, (k,)
        Measured points [mm^2], [mm^2] and [N]; nan where one was not measured.
    area_fitted : ndarray, (k,)
        Fitted area before shear [mm^2].
    area_residual, friction_residual : ndarray, (k,)
        Distances of the points from the lines ``Af = B A0`` and ``F = sigma Af`` over their standard
        deviations [-]; nan where the point is not on this line.
    area_verdict, friction_verdict : Verdict
        Whether each line fits.
    errors : MeasurementErrors
        The standard deviations of the points.
    tests : tuple of SingleTest
        B and sigma of each test, if there are several; nan if the test does not determine one.
    heterogeneity : Heterogeneity or None
        Whether the tests agree; None for a single test.
    bootstrap : ndarray, (n, 2), or None
        B and sigma of resampled points.
    notes : tuple of Note
    friction : metafem.Friction
    area_ratio_interval, shear_strength_interval : (float, float)
        68 % intervals; they begin at 0 or above.

    Examples
    --------
    >>> from metafem.calibration import shear
    >>> before = np.array([0.1, 0.2, 0.3])
    >>> found = shear(before, 0.85 * before, 0.3145 * before)
    >>> round(found.area_ratio, 6), round(found.friction.shear_strength, 6)
    (0.85, 0.37)
    """

    area_ratio: float
    shear_strength: float
    covariance: FloatArray
    area_before: FloatArray
    area_sheared: FloatArray
    friction_force: FloatArray
    area_fitted: FloatArray
    area_residual: FloatArray
    friction_residual: FloatArray
    area_verdict: Verdict
    friction_verdict: Verdict
    errors: MeasurementErrors
    tests: tuple[SingleTest, ...] = ()
    heterogeneity: Heterogeneity | None = None
    bootstrap: FloatArray | None = None
    notes: tuple[Note, ...] = field(default=())

    def __repr__(self) -> str:
        ratio, strength = np.sqrt(np.diagonal(self.covariance))
        return (
            f"<ShearCalibration: B = {self.area_ratio:.4g} ± {ratio:.2g}, "
            f"sigma = {self.shear_strength:.4g} ± {strength:.2g} MPa, {len(self.area_before)} points>"
        )

    @property
    def friction(self) -> Friction:
        """Friction with the fitted values."""
        return Friction(self.shear_strength, self.area_ratio)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the rows of `parameter_covariance`, for `metafem.studies.uncertainty`."""
        return ("area_ratio", "shear_strength")

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of B [-] and sigma [MPa]."""
        return self.covariance

    @property
    def area_ratio_interval(self) -> tuple[float, float]:
        """68 % interval of B [-]."""
        return interval_of(self.area_ratio, self.covariance[0, 0])

    @property
    def shear_strength_interval(self) -> tuple[float, float]:
        """68 % interval of sigma [MPa]."""
        return interval_of(self.shear_strength, self.covariance[1, 1])

    def plot(self, ax: Axes | None = None, line: Literal["area", "friction"] = "friction") -> Axes:
        """Draw the points of one line with their error bars, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.
        line : {"area", "friction"}
            Sheared area over area before shear, or friction force over sheared area; default: "friction".

        Examples
        --------
        >>> from metafem.calibration import shear
        >>> before = np.array([0.1, 0.2, 0.3])
        >>> shear(before, 0.85 * before, 0.3145 * before).plot().get_xlabel()
        'sheared area  Af [mm²]'
        """
        refuse_if(line not in ("area", "friction"), f'line = {shown(line)} must be "area" or "friction"')
        ax, errors, sheared = drawing.axes(ax), self.errors, self.area_ratio * self.area_fitted
        before_sd, sheared_sd = errors.of_area(self.area_fitted), errors.of_area(sheared)
        if line == "area":
            points = self.area_before, self.area_sheared, before_sd, sheared_sd
            calibration.proportional(ax, *points, self.area_ratio)
            ax.set(xlabel="area before shear  A0 [mm²]", ylabel="sheared area  Af [mm²]")
        else:
            force_sd = errors.of_friction_force(self.shear_strength * sheared)
            points = self.area_sheared, self.friction_force, sheared_sd, force_sd
            calibration.proportional(ax, *points, self.shear_strength)
            ax.set(xlabel="sheared area  Af [mm²]", ylabel="friction force  F [N]")
        return ax
