"""What was measured, as numbers with independent errors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray, IntArray
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.errors import InvalidInput
from metafem.surface import Surface


@dataclass(frozen=True, eq=False)
class Observations:
    """The areas of the contacts in a measured law, and whether they were measured individually."""

    measured: MeasuredLaw
    by_contact: bool
    row: IntArray  # (m,), load of each area of a contact
    site: IntArray  # (m,), its asperity
    area: FloatArray  # (m,), [mm^2]
    boundary: FloatArray  # (m,), error of the boundary of each contact [mm]
    open_row: IntArray  # (c,), largest load at which a contact was found open, and its asperity
    open_site: IntArray
    # (c,), largest overlooked area of such a contact [mm^2]; 0: from the error of its boundary
    overlooked: FloatArray

    @staticmethod
    def of(measured: MeasuredLaw, surface: Surface) -> Observations:
        """Return the observations of a law; the total area is the sum of the areas of the contacts."""
        found, found_sd = measured.asperity_area, measured.asperity_area_sd
        if found is None or found_sd is None:
            none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
            return Observations(measured, False, none, none, nothing, nothing, none, none, nothing)
        numbers = np.arange(found.shape[1]) if measured.site is None else measured.site
        if numbers.max() >= surface.count:
            raise InvalidInput(
                f"site = {shown(measured.site)} names asperity {numbers.max()}; the design has "
                f"{surface.count}, numbered from 0"
            )
        uncertain = "must be greater than 0, since the contact is closed"
        check.refuse_entries("asperity_area_sd", found_sd, (found > 0.0) & (found_sd <= 0.0), uncertain)
        row, column = np.nonzero(found > 0.0)
        area = found[row, column]
        boundary = found_sd[row, column] / (2.0 * np.sqrt(math.pi * area))
        # only the largest load with an open contact counts: the contact is also open at smaller loads
        last = len(found) - 1 - np.argmax(found[::-1] <= 0.0, axis=0)
        opened = np.flatnonzero((found <= 0.0).any(axis=0))
        overlooked = found_sd[last[opened], opened]
        return Observations(
            measured, True, row, numbers[column], area, boundary, last[opened], numbers[opened], overlooked
        )

    @property
    def totals(self) -> tuple[FloatArray, FloatArray] | None:
        """Total areas and their standard deviations (k,) [mm^2], if they were measured."""
        law = self.measured
        if self.by_contact or law.area is None or law.area_sd is None:
            return None
        return law.area, law.area_sd

    @property
    def forces(self) -> tuple[FloatArray, FloatArray] | None:
        """Friction forces and their standard deviations (k,) [N], if they were measured."""
        law = self.measured
        if law.friction_force is None or law.friction_force_sd is None:
            return None
        return law.friction_force, law.friction_force_sd
