"""``[target]`` of each kind, as pydantic models."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from metafem import _validate as check
from metafem.errors import InvalidInput
from metafem.files.loads import LOAD, GivenLoad, given_load, rescaled_range
from metafem.files.specification.fields import (
    Area,
    Choices,
    Force,
    Number,
    Quantity,
    Section,
    one_of_two,
    says,
)
from metafem.inversion import (
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)
from metafem.inversion.targets.wording import RESCALED, Wording
from metafem.surface import Friction, Material

LOADS, FRICTIONS = ["0.144 mm^2", "0.336 mm^2"], ["0.84 mm^2", "1.68 mm^2"]
RANGE = ["0.1 mm^2", "0.4 mm^2"]

# Meaning of a range of loads for linear and bilinear laws.
LINE = "P/E* or P, smallest and largest: the target is the line through the origin"
LINES = "P/E* or P, smallest and largest: the target is two lines, the first through the origin"


def _crossover(given: Any) -> list[GivenLoad]:
    """Read a load, or a pair of them."""
    if given == []:
        raise InvalidInput("must be a load or a pair of loads", value="[]", example=f'"{LOAD}"')
    return [given_load(load) for load in given] if isinstance(given, list) else [given_load(given)]


Load = Annotated[Any, Quantity(given_load, ("mm^2", "N"))]

# Validated as a whole, so that an error names the entry instead of each alternative.
Crossover = Annotated[Any, Quantity(_crossover, ("mm^2", "N"), pairs=True)]


# Targets from points, and the keys of the points.
Kind = type[OperatingPoints] | type[SampledLaw]
CURVE_KEYS = ("rescaled_load", "load", "rescaled_friction", "friction_force")


class CurveSection(Section):
    """Points of a law: rescaled values, or forces."""

    # keys that must be stated together
    pairs: ClassVar[tuple[tuple[str, ...], ...]] = (
        ("rescaled_load", "rescaled_friction"),
        ("load", "friction_force"),
    )
    choices: ClassVar[Choices] = (("rescaled_load", "rescaled_friction"), ("load", "friction_force"))

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
        given = tuple(key for key in CURVE_KEYS if getattr(self, key) is not None)
        if given not in self.pairs:
            raise InvalidInput(f"needs {', or '.join(map(' and '.join, self.pairs))}")
        return self

    def law(self, kind: Kind, material: Material, friction: Friction | None, **more: Any) -> Target:
        """Return the target of a class of points."""
        if self.load is None:
            return kind(self.rescaled_load or [], self.rescaled_friction or [], **more)
        if self.friction_force is None:  # areas measured at loads in newtons
            modulus = material.composite_modulus
            load = np.array(self.load) / modulus
            return kind(load, self.rescaled_friction or [], **more, wording=Wording(modulus))
        if friction is None:
            raise InvalidInput("needs [friction] with shear_strength", key="friction_force")
        return kind.from_forces(self.load, self.friction_force, material, friction, **more)


class PointsSection(CurveSection):
    """Points through which the law must pass."""

    kind: Literal["operating-points"]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return self.law(OperatingPoints, material, friction)


class SampledSection(CurveSection):
    """A law of any shape, met in the least-squares sense.

    A `file` is replaced by its content before the section is read.
    """

    kind: Literal["sampled"]
    pairs = (*CurveSection.pairs, ("load", "rescaled_friction"))
    choices = (*CurveSection.choices, ("file",))
    weight: Annotated[
        list[Number] | None, says("of each sample; default: 1/relative_error², or equal", [1.0, 2.0])
    ] = None
    relative_error: Annotated[
        list[Number] | None,
        says("standard deviation of each friction; the misfit may be 1 % plus their rms", [0.01, 0.02]),
    ] = None
    file: Annotated[
        str | None,
        says(
            "or: a table as `metafem compare` reads it, such as load_N,friction_force_N with "
            "friction_force_sd_N",
            "wanted.csv",
        ),
    ] = None

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        more = {"weight": self.weight, "relative_error": self.relative_error}
        return self.law(SampledLaw, material, friction, **more)


class PowerSection(Section):
    """Friction proportional to a power of the load."""

    kind: Literal["power"]
    exponent: Annotated[Number, says("of F/(sigma B) = C (P/E*)^exponent", 1.2)]
    load_range: Annotated[list[Load], says("P/E* or P, from and to", RANGE)]
    prefactor: Annotated[Number | None, says("C, for areas in mm^2; default: chosen by the design", 7.0)] = (
        None
    )

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        told_in = Wording(material.composite_modulus if self.load_range[0].unit == "N" else None)
        return PowerLaw(
            self.exponent, rescaled_range(self.load_range, material) or [], self.prefactor, told_in
        )


class StraightSection(Section):
    """Slopes or friction coefficients, over rescaled loads or loads in newtons."""

    def told_in(self, material: Material, loads: list[GivenLoad]) -> Wording:
        """Return the units of slopes over these loads, for messages."""
        return Wording(material.composite_modulus) if any(load.unit == "N" for load in loads) else RESCALED

    def pair(self, material: Material, friction: Friction | None, key: str) -> tuple[Material, Friction]:
        """Return the material pair that friction coefficients need."""
        if friction is None:
            raise InvalidInput("needs [friction] with shear_strength", key=key)
        return material, friction


class MultilinearSection(StraightSection):
    """Straight branches, slopes rising or falling, with a free intercept."""

    kind: Literal["multilinear"]
    choices = (("slopes",), ("friction_coefficients",))
    slopes: Annotated[
        list[Number] | None, says("either: of F/(sigma B) over P/E*, one for each branch", [9.5, 8.0, 7.0])
    ] = None
    friction_coefficients: Annotated[
        list[Number] | None, says("or: dF/dP, one for each branch; needs [friction]", [2.1, 1.8, 1.6])
    ] = None
    crossover_loads: Annotated[
        list[Crossover],
        says(
            "P/E* or P of each: one load, or a pair; between them the law is free",
            ["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]],
        ),
    ]
    load_range: Annotated[list[Load], says("P/E* or P, from and to", ["0.03 mm^2", "0.26 mm^2"])]

    @model_validator(mode="after")
    def _one_of_two(self) -> MultilinearSection:
        one_of_two(self, "slopes", "friction_coefficients")
        return self

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        crossovers: list[Any] = []
        for i, given in enumerate(self.crossover_loads):
            loads = [load.rescaled(material) for load in given]
            if len(loads) > 1:
                check.interval(f"crossover_loads[{i}]", [load.value for load in given])
            crossovers.append(loads if len(loads) > 1 else loads[0])
        ends = rescaled_range(self.load_range, material) or []
        if self.friction_coefficients is None:
            given = [*self.load_range, *(load for pair in self.crossover_loads for load in pair)]
            return MultilinearLaw(self.slopes or [], crossovers, ends, self.told_in(material, given))
        wording = Wording.of(*self.pair(material, friction, "friction_coefficients"))
        slopes = wording.given_slopes(self.friction_coefficients, None)
        return MultilinearLaw(slopes, crossovers, ends, wording)


class LinearSection(StraightSection):
    """A straight law: a slope or a friction coefficient."""

    kind: Literal["linear"]
    choices = (("slope",), ("friction_coefficient",))
    slope: Annotated[Number | None, says("either: of F/(sigma B) over P/E*", 6.87)] = None
    friction_coefficient: Annotated[Number | None, says("or: dF/dP; needs [friction]", 1.5)] = None
    load_range: Annotated[list[Load] | None, says(LINE, ["0.05 mm^2", "0.2 mm^2"])] = None

    @model_validator(mode="after")
    def _one_of_two(self) -> LinearSection:
        one_of_two(self, "slope", "friction_coefficient")
        return self

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        ends = rescaled_range(self.load_range, material)
        if self.friction_coefficient is None:
            return LinearLaw(self.slope or 0.0, ends, self.told_in(material, self.load_range or []))
        law = LinearLaw.from_friction_coefficient(
            self.friction_coefficient, *self.pair(material, friction, "friction_coefficient")
        )
        return LinearLaw(law.slope, ends, law.wording)


class BilinearSection(StraightSection):
    """Two straight branches that meet at a crossover load."""

    kind: Literal["bilinear"]
    choices = (("slopes",), ("friction_coefficients",))
    slopes: Annotated[
        list[Number] | None, says("either: of F/(sigma B) over P/E*, below and above", [7.15, 12.52])
    ] = None
    friction_coefficients: Annotated[
        list[Number] | None, says("or: dF/dP, below and above; needs [friction]", [1.6, 2.7])
    ] = None
    crossover_load: Annotated[Load, says("P/E* or P where they meet", "0.0380 mm^2")]
    load_range: Annotated[list[Load] | None, says(LINES, ["0.02 mm^2", "0.1 mm^2"])] = None

    @model_validator(mode="after")
    def _one_of_two(self) -> BilinearSection:
        one_of_two(self, "slopes", "friction_coefficients")
        return self

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        ends, crossover = rescaled_range(self.load_range, material), self.crossover_load.rescaled(material)
        if self.friction_coefficients is None:
            told_in = self.told_in(material, [self.crossover_load, *(self.load_range or [])])
            return BilinearLaw(self.slopes or [], crossover, ends, told_in)
        wording = Wording.of(*self.pair(material, friction, "friction_coefficients"))
        return BilinearLaw(wording.given_slopes(self.friction_coefficients, 2), crossover, ends, wording)
