"""Points of compression and shear tests from one table or several."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.notes import Note, information


@dataclass(frozen=True, eq=False)
class Compression:
    """Loads (k,) [N], areas (k,) or (k, n) [mm^2], labels of the tests, and the place of each point.

    `contacts` is the number of contacts, if a table has single ones.
    """

    load: FloatArray
    area: FloatArray
    test: tuple[str, ...]
    place: tuple[str, ...]
    contacts: int | None = None


@dataclass(frozen=True, eq=False)
class Shear:
    """Areas before shear and sheared [mm^2] and friction forces [N], (k,); nan where not measured."""

    area_before: FloatArray
    area_sheared: FloatArray
    friction_force: FloatArray
    test: tuple[str, ...]
    place: tuple[str, ...]


def pooled_compression(parts: list[Compression]) -> tuple[Compression | None, list[Note]]:
    """Return all points, as totals if a table has no single contacts."""
    if not parts:
        return None, []
    areas, notes = [part.area for part in parts], []
    numbers = {
        area.shape[1]: part.place[0] for area, part in zip(areas, parts, strict=True) if area.ndim == 2
    }
    if len(numbers) > 1:
        told = " and ".join(f"{number} ({place})" for number, place in numbers.items())
        raise InvalidInput(
            f"the tables hold the areas of {told} contacts; tests that are pooled have the same contacts, so "
            "calibrate them one by one"
        )
    if numbers and any(area.ndim == 1 for area in areas):
        notes.append(
            information(
                "some tables hold the areas of single contacts and others their total; the totals are used"
            )
        )
        areas = [area if area.ndim == 1 else area.sum(axis=1) for area in areas]
    pooled = Compression(
        np.concatenate([part.load for part in parts]),
        np.concatenate(areas),
        tuple(label for part in parts for label in part.test),
        tuple(place for part in parts for place in part.place),
        next(iter(numbers), None),
    )
    return pooled, notes


def pooled_shear(parts: list[Shear]) -> Shear | None:
    """Return all points."""
    if not parts:
        return None
    return Shear(
        np.concatenate([part.area_before for part in parts]),
        np.concatenate([part.area_sheared for part in parts]),
        np.concatenate([part.friction_force for part in parts]),
        tuple(label for part in parts for label in part.test),
        tuple(place for part in parts for place in part.place),
    )
