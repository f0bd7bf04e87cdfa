"""Tables of a made surface and of corrected heights, which are read like ``heights.csv``."""

from __future__ import annotations

import numpy as np

from metafem._validate import IntArray
from metafem.calibration import MadeSurface
from metafem.files.result.tables import csv
from metafem.surface import Surface

# The first line of a table of heights, and of one with standard deviations.
HEIGHTS = ("site", "x_mm", "y_mm", "height_mm", "radius_mm")
MADE = (*HEIGHTS, "sd_position_mm", "sd_height_mm", "sd_radius_mm")


def made_table(made: MadeSurface, sites: IntArray) -> str:
    """Return made positions, heights and radii with their standard deviations; `sites` are the design's."""
    errors = np.column_stack([made.position_sd, made.height_sd, made.radius_sd]).tolist()
    rows = ((*row, *sd) for row, sd in zip(_rows(made.surface, sites[made.site]), errors, strict=True))
    return csv(MADE, rows)


def corrected_table(surface: Surface, sites: IntArray) -> str:
    """Return corrected heights as in ``heights.csv``."""
    return csv(HEIGHTS, _rows(surface, sites))


def _rows(surface: Surface, sites: IntArray) -> list[tuple[float, ...]]:
    columns = np.column_stack([surface.position, surface.height, surface.radius]).tolist()
    return [(site, *row) for site, row in zip(sites.tolist(), columns, strict=True)]
