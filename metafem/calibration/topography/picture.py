"""Figure of a made surface: its height errors, its map and its law beside the designed one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.calibration.topography.correction import Correction
from metafem.calibration.topography.made_surface import MadeSurface
from metafem.calibration.topography.residual import Residuals
from metafem.drawing import new_figure, topography
from metafem.prediction import FrictionLaw

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def made_figure(
    made: MadeSurface, correction: Correction | None, rest: Residuals, designed: FrictionLaw, law: FrictionLaw
) -> Figure:
    """Return the height errors at the sites and over the heights, the residual map and the two laws."""
    figure = new_figure(10.0, 8.4)
    (sites, residual), (heights, laws) = figure.subplots(2, 2)
    design = made.design
    topography.height_errors(
        sites, design.position[made.site], made.height_error, design.position[made.missing]
    )
    topography.residual_map(residual, rest.values, rest.width, rest.height)
    fit = None if correction is None else correction.systematic[made.site]
    topography.errors_over_height(heights, design.height[made.site], made.height_error, made.height_sd, fit)
    topography.made_law(laws, designed.rescaled_load, designed.area, law.area)
    return figure
