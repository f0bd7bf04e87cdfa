"""What was measured, as numbers with independent errors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem._given import shown
from metafem._validate import FloatArray, IntArray
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.measurement_errors import MeasurementErrors
from metafem.errors import InvalidInput
from metafem.surface import Surface


@dataclass(frozen=True, eq=False)
class Observations:
    """Measured friction forces, areas, and areas of contacts at k loads; None or empty if not measured."""

    load: FloatArray  # (k,), measured [N]
    load_sd: FloatArray
    force: FloatArray | None  # (k,), [N]
    force_sd: FloatArray | None
    total: FloatArray | None  # (k,), [mm^2]
    total_sd: FloatArray | None
    row: IntArray  # (m,), load of each area of a contact
    site: IntArray  # (m,), its asperity
    area: FloatArray  # (m,), [mm^2]
    boundary: FloatArray  # (m,), error of the boundary of each contact [mm]
    open_row: IntArray  # (c,), largest load at which a contact was found open, and its asperity
    open_site: IntArray
    overlooked: (
        FloatArray  # (c,), largest area of such a contact that is overlooked [mm^2], 0: its boundary's
    )
    errors: MeasurementErrors

    @staticmethod
    def of(measured: MeasuredLaw, surface: Surface) -> Observations:
        """Return the observations of a law; the total area is not one beside the areas of the contacts."""
        none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
        row, site, area, boundary, open_row, open_site = none, none, nothing, nothing, none, none
        overlooked = nothing
        total, total_sd = measured.area, measured.area_sd
        if measured.asperity_area is not None and measured.asperity_area_sd is not None:
            total = total_sd = None
            numbers = np.arange(measured.asperity_area.shape[1]) if measured.site is None else measured.site
            if numbers.max() >= surface.count:
                raise InvalidInput(
                    f"site = {shown(measured.site)} names asperity {numbers.max()}; the design has "
                    f"{surface.count}, numbered from 0"
                )
            found, found_sd = measured.asperity_area, measured.asperity_area_sd
            row, column = np.nonzero(found > 0.0)
            area, site = found[row, column], numbers[column]
            boundary = found_sd[row, column] / (2.0 * np.sqrt(math.pi * area))
            if boundary.size and boundary.min() <= 0.0:
                i = int(boundary.argmin())
                raise InvalidInput(
                    f"asperity_area_sd[{row[i]}, {column[i]}] = {found_sd[row[i], column[i]]:g} must be "
                    "greater than 0, since the contact is closed"
                )
            # open under the largest load at which it is: that it was open under lighter ones says no more
            last = len(found) - 1 - np.argmax(found[::-1] <= 0.0, axis=0)
            column = np.flatnonzero((found <= 0.0).any(axis=0))
            open_row, open_site = last[column], numbers[column]
            overlooked = found_sd[open_row, column]
        return Observations(
            measured.load, measured.load_sd, measured.friction_force, measured.friction_force_sd, total,
            total_sd, row, site, area, boundary, open_row, open_site, overlooked, measured.errors,
        )  # fmt: skip

    @property
    def count(self) -> int:
        """Number of measured values, without open contacts: loads, friction forces and areas."""
        kinds = sum(values is not None for values in (self.force, self.total))
        return len(self.load) * (1 + kinds) + len(self.area)
