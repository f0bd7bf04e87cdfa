"""Shear strength of a surface in full contact, as it was measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from metafem import drawing
from metafem._calls import checked_call
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.bounded_interval import bounded_interval
from metafem.calibration.verdict import Verdict
from metafem.material import Friction

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, eq=False, repr=False)
class StrengthFit(Value):
    """Shear strength of a surface in full contact, with its errors.

    Attributes
    ----------
    shear_strength : float
        sigma [MPa].
    parameters : tuple of str
        Names of the rows of `covariance`: the given parameters, and ``shear_strength`` last.
    covariance : ndarray, (p, p)
        Their covariance, in mm, MPa and 1.
    measured_sd : float
        Standard deviation of sigma from the errors of loads and friction forces alone [MPa].
    load, friction_force : ndarray, (k,)
        Measured points that were used [N].
    area : ndarray, (k,)
        Predicted contact area before shear [mm^2].
    area_sd, friction_force_sd : ndarray, (k,)
        Standard deviations of the area by the errors of the loads, and of the friction forces.
    residual : ndarray, (k,)
        Residuals over their standard deviations [-].
    verdict : Verdict
        Whether the friction forces are in proportion to the predicted areas.
    area_ratio : float
        The area ratio B that was used [-].
    friction : metafem.Friction
    shear_strength_interval : (float, float)
        68 % interval [MPa].

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(
    ...     0.1, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.4, 0.85)
    ... )
    >>> law = mf.friction_law(surface, load=[0.5, 1.0, 1.5])
    >>> measured = mf.calibration.MeasuredLaw(
    ...     law.load, friction_force=law.friction_force, material=surface.material, friction=surface.friction
    ... )
    >>> mf.calibration.shear_strength(measured, surface, 0.5)
    <StrengthFit: sigma = 0.4 ± 0.0026 MPa, 3 points>
    """

    shear_strength: float
    parameters: tuple[str, ...]
    covariance: FloatArray
    measured_sd: float
    load: FloatArray
    friction_force: FloatArray
    area: FloatArray
    area_sd: FloatArray
    friction_force_sd: FloatArray
    residual: FloatArray
    verdict: Verdict
    area_ratio: float

    def __repr__(self) -> str:
        deviation = float(np.sqrt(self.covariance[-1, -1]))
        return (
            f"<StrengthFit: sigma = {self.shear_strength:.4g} ± {deviation:.2g} MPa, {len(self.load)} points>"
        )

    @property
    def parameter_covariance(self) -> FloatArray:
        """Covariance of the parameters, for `metafem.calibration.joint_covariance`."""
        return self.covariance

    @property
    def friction(self) -> Friction:
        """Friction with the fitted strength and the area ratio that was used."""
        return Friction(self.shear_strength, self.area_ratio)

    @property
    def shear_strength_interval(self) -> tuple[float, float]:
        """68 % interval of sigma [MPa]."""
        low, high = bounded_interval(self.shear_strength, np.sqrt(self.covariance[-1, -1]))
        return float(low), float(high)

    @checked_call
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw friction forces over predicted areas with error bars and the line, and return the axes.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Axes to draw on; default: those of a new figure of ``matplotlib.pyplot``.
        """
        from metafem.drawing import calibration

        ax = drawing.axes(ax)
        calibration.measured(ax, self.area, self.friction_force, self.area_sd, self.friction_force_sd)
        ends = np.array([0.0, 1.05 * float(self.area.max())])
        calibration.fitted(ax, ends, self.shear_strength * self.area_ratio * ends)
        ax.set_xlabel("predicted area  A0 [mm²]")
        ax.set_ylabel("friction force  F [N]")
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        return ax
