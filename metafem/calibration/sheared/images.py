"""Points of a shear test from the contacts in images."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.contact_table import ContactTable, listed
from metafem.notes import Note, information


@dataclass(frozen=True, eq=False)
class ShearedPoints:
    """Total areas [mm^2] and friction forces [N] (k,), nan where not measured, and the image of each."""

    area_before: FloatArray
    area_sheared: FloatArray
    friction_force: FloatArray
    image: NDArray[np.intp]


def sheared_points(table: ContactTable) -> tuple[ShearedPoints, tuple[Note, ...]]:
    """Return the points of the images, and notes on what they lack.

    An image of which all contacts were measured before and after is one point. Else it is up to two: the
    areas of the contacts that both images show, for B, and the sheared area of all contacts with the friction
    force, for sigma, if all were measured. Two points of an image share the errors of sheared areas, which
    only changes the covariance of B and sigma.

    A contact that is below the smallest area in one of the images would bias the ratio of the sums. In the
    sum for sigma its sheared area is the smaller one of the smallest area and of what the ratio of the other
    contacts says.
    """
    before, after, force = table.area, table.sheared_area, table.friction_force
    both = np.isfinite(before) & np.isfinite(after)
    seen = both & (before > 0.0) & (after > 0.0)
    one = both & ((before > 0.0) != (after > 0.0))
    first, second = (np.where(seen, area, 0.0).sum(axis=1) for area in (before, after))
    ratio = np.divide(second, first, np.zeros(first.shape), where=first > 0.0)[:, None]
    fell = one & (before > 0.0)
    filled = np.where(fell, np.minimum(ratio * np.where(fell, before, 0.0), table.sheared_area_error), after)
    total = filled.sum(axis=1)  # nan where a contact was not measured
    total = np.where(total > 0.0, total, np.nan)
    of_ratio = first > 0.0
    of_strength = np.isfinite(total) & np.isfinite(force)
    single = of_ratio & of_strength & both.all(axis=1) & ~one.any(axis=1)
    rows = []
    for i in np.flatnonzero(of_ratio | of_strength).tolist():
        if single[i]:
            rows.append((first[i], second[i], force[i], i))
            continue
        if of_ratio[i]:
            rows.append((first[i], second[i], np.nan, i))
        if of_strength[i]:
            rows.append((np.nan, total[i], force[i], i))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 4).T
    points = ShearedPoints(columns[0], columns[1], columns[2], columns[3].astype(np.intp))
    notes = []
    mixed = np.flatnonzero(one.any(axis=1) & of_ratio)
    if mixed.size:
        notes.append(
            information(
                f"{listed([table.image[i] for i in mixed.tolist()])}: contacts are below the smallest area "
                "that is found in one of the images before and after shear; B is fitted to those that both "
                "show"
            )
        )
    unused = np.flatnonzero(np.isfinite(force) & np.isfinite(after).any(axis=1) & ~of_strength)
    if unused.size:
        images = listed([table.image[i] for i in unused.tolist()])
        missing = [table.name_of(j) for j in np.flatnonzero(~np.isfinite(after[unused]).all(axis=0)).tolist()]
        notes.append(
            information(
                f"sigma is fitted without {images}: the sheared area of {listed(missing) or 'all contacts'} "
                "could not be measured, and the friction force is that of all contacts"
            )
        )
    return points, tuple(notes)
