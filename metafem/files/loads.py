"""Loads as a user writes them: rescaled in mm^2, or in newtons."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from metafem import _validate as check
from metafem.errors import InvalidInput
from metafem.files.units import converted
from metafem.surface import Material

# Example in errors about loads that may be rescaled or in newtons.
LOAD = '0.144 mm^2" or "0.2 N'


class GivenLoad(NamedTuple):
    """A load as it was written, in mm^2 or N."""

    value: float
    unit: str

    def rescaled(self, material: Material) -> float:
        """Return P/E* [mm^2]."""
        return self.value / material.composite_modulus if self.unit == "N" else self.value


def given_load(given: Any) -> GivenLoad:
    """Read a load in newtons or a rescaled one; errors have no key."""
    try:
        return GivenLoad(converted(given, "mm^2", LOAD), "mm^2")
    except InvalidInput as reason:
        try:
            return GivenLoad(converted(given, "N", LOAD), "N")
        except InvalidInput:
            raise reason from None


def rescaled_range(given: Sequence[GivenLoad] | None, material: Material) -> list[float] | None:
    """Return a range of rescaled loads; it is checked in the written units, for the errors."""
    if given is None:
        return None
    if len({load.unit for load in given}) > 1:
        raise InvalidInput("mixes mm^2 and N; give both loads in one unit", key="load_range")
    check.interval("load_range", [load.value for load in given])
    return [load.rescaled(material) for load in given]


def load_range(key: str, given: Sequence[str], material: Material) -> list[float] | None:
    """Return a range of rescaled loads [mm^2] from two texts, None if there are none."""
    try:
        return rescaled_range([given_load(text) for text in given] or None, material)
    except InvalidInput as error:
        raise (error if error.key else error.at(key)) from None
