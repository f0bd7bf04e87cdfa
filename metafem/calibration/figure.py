"""A figure of calibrations: each line with its points, error bars and residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.calibration.compression.result import ContactCalibration
from metafem.calibration.sheared.result import ShearCalibration
from metafem.drawing.calibration import residuals, with_residuals

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def calibration_figure(contact: ContactCalibration | None, shear: ShearCalibration | None) -> Figure:
    """Return the figure of a compression calibration, of a shear calibration, or of both."""
    figure, axes = with_residuals((contact is not None) + 2 * (shear is not None))
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
    for law, below in axes:
        below.set_xlabel(law.get_xlabel())
        law.set_xlabel("")
    return figure
