"""A figure of calibrations: each line with its points, error bars and residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.sheared.result import ShearCalibration
from metafem.calibration.sheared.strength_fit import StrengthFit
from metafem.drawing.calibration import residuals, with_residuals

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def calibration_figure(
    contact: ContactCalibration | None, shear: ShearCalibration | None, strength: StrengthFit | None = None
) -> Figure:
    """Return the figure of the calibrations that are given."""
    columns = (contact is not None) + 2 * (shear is not None) + (strength is not None)
    figure, axes = with_residuals(columns)
    places = iter(axes)
    if contact is not None:
        law, below = next(places)
        contact.plot(law)
        residuals(below, contact.load, contact.residual)
        law.set_title(f"E* = {contact.composite_modulus:.4g} MPa")
    if shear is not None:
        law, below = next(places)
        shear.plot(law, "area")
        residuals(below, shear.area_before, shear.area_residual)
        law.set_title(f"B = {shear.area_ratio:.4g}")
        law, below = next(places)
        shear.plot(law, "friction")
        residuals(below, shear.area_sheared, shear.friction_residual)
        law.set_title(f"σ = {shear.shear_strength:.4g} MPa")
    if strength is not None:
        law, below = next(places)
        strength.plot(law)
        residuals(below, strength.area, strength.residual)
        law.set_title(f"full contact: σ = {strength.shear_strength:.4g} MPa")
    for law, below in axes:
        below.set_xlabel(law.get_xlabel())
        law.set_xlabel("")
    return figure
