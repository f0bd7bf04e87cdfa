"""``[target]`` of each kind, as pydantic models."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, model_validator

from metafem.errors import InvalidInput
from metafem.files.section import Area, Force, Number, Section, Whether, says
from metafem.files.units import converted
from metafem.inversion import (
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)
from metafem.surface import Friction, Material

LOADS, FRICTIONS = ["0.144 mm^2", "0.336 mm^2"], ["0.84 mm^2", "1.68 mm^2"]
RANGE = ["0.1 mm^2", "0.4 mm^2"]


def _crossover(given: Any) -> float | list[float]:
    """Read a load, or a pair of them."""
    if isinstance(given, list):
        return [converted(load, "mm^2") for load in given]
    return converted(given, "mm^2")


# Read as a whole, so that an error tells of the entry and not of each way to read it.
Crossover = Annotated[float | list[float], BeforeValidator(_crossover)]


class CurveSection(Section):
    """Points of a law: rescaled values, or forces."""

    rescaled_load: Annotated[list[Area] | None, says("either: P/E*, increasing", LOADS)] = None
    rescaled_friction: Annotated[
        list[Area] | None, says("with it: F/(sigma B) at these loads", FRICTIONS)
    ] = None
    load: Annotated[list[Force] | None, says("or: P, increasing", ["0.2 N", "0.4 N"])] = None
    friction_force: Annotated[
        list[Force] | None, says("with it: F at these loads; needs [friction]", ["0.26 N", "0.53 N"])
    ] = None

    @model_validator(mode="after")
    def _one_pair(self) -> CurveSection:
        rescaled = (self.rescaled_load is not None, self.rescaled_friction is not None)
        forces = (self.load is not None, self.friction_force is not None)
        if sorted((rescaled, forces)) != [(False, False), (True, True)]:
            raise InvalidInput(
                "needs rescaled_load and rescaled_friction [mm^2], or load and friction_force [N]"
            )
        return self

    def points(self, material: Material, friction: Friction | None) -> OperatingPoints:
        """Return the points, rescaled."""
        if self.load is None:
            return OperatingPoints(self.rescaled_load or [], self.rescaled_friction or [])
        if friction is None:
            raise InvalidInput("load and friction_force need [friction] with shear_strength and area_ratio")
        return OperatingPoints.from_forces(self.load, self.friction_force or [], material, friction)


class PointsSection(CurveSection):
    """Points through which the law must pass."""

    kind: Literal["operating-points"]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return self.points(material, friction)


class SampledSection(CurveSection):
    """A law of any shape, met in the least-squares sense.

    A `file` has been replaced by what it holds before the section is read.
    """

    kind: Literal["sampled"]
    weight: Annotated[list[Number] | None, says("of each sample; equal unless given", [1.0, 2.0])] = None
    file: Annotated[
        str | None,
        says(
            "or: a table load_N,friction_force_N or the like; its weights are a column weight", "wanted.csv"
        ),
    ] = None

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        points = self.points(material, friction)
        return SampledLaw(points.rescaled_load, points.rescaled_friction, self.weight)


class PowerSection(Section):
    """Friction proportional to a power of the load."""

    kind: Literal["power"]
    exponent: Annotated[Number, says("of F/(sigma B) = C (P/E*)^exponent", 1.2)]
    load_range: Annotated[list[Area], says("P/E* from and to", RANGE)]
    prefactor: Annotated[Number | None, says("C, for areas in mm^2; free unless given", 7.0)] = None

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return PowerLaw(self.exponent, self.load_range, self.prefactor)


class MultilinearSection(Section):
    """Straight branches, slopes rising or falling, with a free intercept."""

    kind: Literal["multilinear"]
    slopes: Annotated[list[Number], says("of F/(sigma B) over P/E*, one a branch", [9.5, 8.0, 7.0])]
    crossover_loads: Annotated[
        list[Crossover],
        says(
            "P/E* of each: one load, or a pair with a free law between",
            ["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]],
        ),
    ]
    load_range: Annotated[list[Area], says("P/E* from and to", ["0.03 mm^2", "0.26 mm^2"])]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return MultilinearLaw(self.slopes, self.crossover_loads, self.load_range)


class LinearSection(Section):
    """A straight law: a slope or a friction coefficient."""

    kind: Literal["linear"]
    slope: Annotated[Number | None, says("either: of F/(sigma B) over P/E*", 6.87)] = None
    friction_coefficient: Annotated[Number | None, says("or: mu; needs [friction]", 1.5)] = None
    through_origin: Annotated[Whether, says("no intercept, over the widest range of loads", True)] = False

    @model_validator(mode="after")
    def _one_of_two(self) -> LinearSection:
        if (self.slope is None) == (self.friction_coefficient is None):
            raise InvalidInput("needs slope or friction_coefficient, one of the two")
        return self

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        if self.friction_coefficient is None:
            return LinearLaw(self.slope or 0.0, self.through_origin)
        if friction is None:
            raise InvalidInput("friction_coefficient needs [friction] with shear_strength and area_ratio")
        return LinearLaw.from_friction_coefficient(
            self.friction_coefficient, material, friction, self.through_origin
        )


class BilinearSection(Section):
    """Two straight branches that meet at a crossover load."""

    kind: Literal["bilinear"]
    slopes: Annotated[list[Number], says("of F/(sigma B) over P/E*, below and above", [7.15, 12.52])]
    crossover_load: Annotated[Area, says("P/E* where they meet", "0.0380 mm^2")]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return BilinearLaw(self.slopes, self.crossover_load)
