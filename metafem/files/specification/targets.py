"""The section ``[target]``: a pydantic model for each kind of target law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from metafem import _validate as check
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification.fields import (
    Area,
    Choices,
    Force,
    Number,
    Quantity,
    Section,
    key,
    optional,
)
from metafem.files.units import converted
from metafem.inversion import (
    Band,
    BilinearLaw,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)
from metafem.inversion.wording import RESCALED, Wording
from metafem.surface import Friction, Material

# Example in errors about a load, which may be a rescaled load or a force.
LOAD = '0.144 mm^2" or "0.2 N'


class GivenLoad(NamedTuple):
    """A load in the unit in which it was written: mm^2 for P/E*, or N."""

    value: float
    unit: str

    def rescaled(self, material: Material) -> float:
        """Return P/E* [mm^2]."""
        return self.value / material.composite_modulus if self.unit == "N" else self.value


def given_load(given: Any) -> GivenLoad:
    """Return the load that a text states, in mm^2 or N; errors do not name a key."""
    try:
        return GivenLoad(converted(given, "mm^2", LOAD), "mm^2")
    except InvalidInput as reason:
        try:
            return GivenLoad(converted(given, "N", LOAD), "N")
        except InvalidInput:
            raise reason from None


def rescaled_range(given: Sequence[GivenLoad], material: Material) -> tuple[float, float]:
    """Return a range of rescaled loads [mm^2]; errors state the loads in the units that were written."""
    mixed = len({load.unit for load in given}) > 1
    refuse_if(mixed, "mixes mm^2 and N; give both loads in one unit", key="load_range")
    check.interval("load_range", [load.value for load in given])
    low, high = (load.rescaled(material) for load in given)
    return low, high


LOADS, FRICTIONS = ["0.144 mm^2", "0.336 mm^2"], ["0.84 mm^2", "1.68 mm^2"]
RANGE = ["0.1 mm^2", "0.4 mm^2"]

# Meaning of the key load_range of linear and bilinear laws.
LINE = "P/E* or P, smallest and largest: the target is the line through the origin"
LINES = "P/E* or P, smallest and largest: the target is two lines, the first through the origin"


def _crossover(given: Any) -> list[GivenLoad]:
    """Return the load, or the pair of loads, that a value states."""
    if given == []:
        raise InvalidInput("must be a load or a pair of loads", value="[]", example=f'"{LOAD}"')
    return [given_load(load) for load in given] if isinstance(given, list) else [given_load(given)]


Load = Annotated[Any, Quantity(given_load, ("mm^2", "N"))]

# A single validator for one load or a pair: pydantic would report one error for each member of a union.
Crossover = Annotated[Any, Quantity(_crossover, ("mm^2", "N"), pairs=True)]


# Targets that are defined by points.
Kind = type[OperatingPoints] | type[SampledLaw]


class CurveSection(Section):
    """Points of a law, as rescaled loads and rescaled friction or as forces."""

    choices: ClassVar[Choices] = (("rescaled_load", "rescaled_friction"), ("load", "friction_force"))

    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    rescaled_friction: list[Area] | None = optional("with it: F/(sigma B) at these loads", FRICTIONS)
    load: list[Force] | None = optional("or: P, increasing", ["0.2 N", "0.4 N"])
    friction_force: list[Force] | None = optional(
        "with it: F at these loads; needs [friction]", ["0.26 N", "0.53 N"]
    )

    def law(self, kind: Kind, material: Material, friction: Friction | None, **more: Any) -> Target:
        """Return the target of class `kind` through the points."""
        if self.load is None:
            return kind(self.rescaled_load or [], self.rescaled_friction or [], **more)
        if self.friction_force is None:  # a table of areas measured at loads in N
            modulus = material.composite_modulus
            load = np.array(self.load) / modulus
            return kind(load, self.rescaled_friction or [], **more, wording=Wording(modulus))
        pair = material, _stated(friction, "friction_force")
        return kind.from_forces(self.load, self.friction_force, *pair, **more)


class PointsSection(CurveSection):
    """Points through which the law must pass."""

    kind: Literal["operating-points"]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        return self.law(OperatingPoints, material, friction)


class SampledSection(CurveSection):
    """A law of any shape, met in the least-squares sense.

    Before the section is read, the columns of the table replace the key `file`.
    """

    kind: Literal["sampled"]
    choices = (*CurveSection.choices, ("file",))
    also = (("load", "rescaled_friction"),)
    weight: list[Number] | None = optional("of each sample; default: 1/relative_error², or equal", [1.0, 2.0])
    relative_error: list[Number] | None = optional(
        "standard deviation of each friction; the misfit may be 1 % plus their rms", [0.01, 0.02]
    )
    file: str | None = optional(
        "or: a table as `metafem compare` reads it, such as load_N,friction_force_N with friction_force_sd_N",
        "wanted.csv",
    )

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        more = {"weight": self.weight, "relative_error": self.relative_error}
        return self.law(SampledLaw, material, friction, **more)


class BandSection(Section):
    """Any law between two curves; the design has the largest margin to both."""

    kind: Literal["band"]
    choices: ClassVar[Choices] = (
        ("rescaled_load", "lowest", "highest"),
        ("load", "lowest_force", "highest_force"),
    )
    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    lowest: list[Area] | None = optional("with it: smallest F/(sigma B) at these loads", FRICTIONS)
    highest: list[Area] | None = optional("with it: largest F/(sigma B)", ["1.04 mm^2", "1.98 mm^2"])
    load: list[Force] | None = optional("or: P, increasing", ["0.2 N", "0.4 N"])
    lowest_force: list[Force] | None = optional(
        "with it: smallest F at these loads; needs [friction]", ["0.26 N", "0.53 N"]
    )
    highest_force: list[Force] | None = optional("with it: largest F", ["0.32 N", "0.62 N"])

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        if self.load is None:
            return Band(self.rescaled_load or [], self.lowest or [], self.highest or [])
        pair = material, _stated(friction, "lowest_force")
        return Band.from_forces(self.load, self.lowest_force or [], self.highest_force or [], *pair)


class PowerSection(Section):
    """Friction proportional to a power of the load."""

    kind: Literal["power"]
    exponent: Number = key("of F/(sigma B) = C (P/E*)^exponent", 1.2)
    load_range: list[Load] = key("P/E* or P, from and to", RANGE)
    prefactor: Number | None = optional("C, for areas in mm^2; default: chosen by the design", 7.0)

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        ends = rescaled_range(self.load_range, material)
        return PowerLaw(self.exponent, ends, self.prefactor, wording=_in_newtons(material, *self.load_range))


class MultilinearSection(Section):
    """Straight branches with increasing or decreasing slopes and a free intercept."""

    kind: Literal["multilinear"]
    choices = (("slopes",), ("friction_coefficients",))
    slopes: list[Number] | None = optional(
        "either: of F/(sigma B) over P/E*, one for each branch", [9.5, 8.0, 7.0]
    )
    friction_coefficients: list[Number] | None = optional(
        "or: dF/dP, one for each branch; needs [friction]", [2.1, 1.8, 1.6]
    )
    crossover_loads: list[Crossover] = key(
        "P/E* or P of each: one load, or a pair; between them the law is free",
        ["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]],
    )
    load_range: list[Load] = key("P/E* or P, from and to", ["0.03 mm^2", "0.26 mm^2"])

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        crossovers: list[Any] = []
        for i, given in enumerate(self.crossover_loads):
            loads = [load.rescaled(material) for load in given]
            if len(loads) > 1:
                check.interval(f"crossover_loads[{i}]", [load.value for load in given])
            crossovers.append(loads if len(loads) > 1 else loads[0])
        every = [*self.load_range, *(load for pair in self.crossover_loads for load in pair)]
        wording = _wording(self, material, friction, *every)
        ends = rescaled_range(self.load_range, material)
        return MultilinearLaw(_slopes(self, wording, None), crossovers, ends, wording=wording)


class LinearSection(Section):
    """A straight line with a slope or a friction coefficient."""

    kind: Literal["linear"]
    choices = (("slope",), ("friction_coefficient",))
    slope: Number | None = optional("either: of F/(sigma B) over P/E*", 6.87)
    friction_coefficient: Number | None = optional("or: dF/dP; needs [friction]", 1.5)
    load_range: list[Load] | None = optional(LINE, ["0.05 mm^2", "0.2 mm^2"])

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        ends = rescaled_range(self.load_range, material) if self.load_range is not None else None
        wording = _wording(self, material, friction, *(self.load_range or ()))
        if self.friction_coefficient is None:
            return LinearLaw(self.slope or 0.0, ends, wording=wording)
        mu = check.number("friction_coefficient", self.friction_coefficient, above=0.0)
        return LinearLaw(wording.given_slopes([mu], 1)[0], ends, wording=wording)


class BilinearSection(Section):
    """Two straight branches that meet at a crossover load."""

    kind: Literal["bilinear"]
    choices = (("slopes",), ("friction_coefficients",))
    slopes: list[Number] | None = optional("either: of F/(sigma B) over P/E*, below and above", [7.15, 12.52])
    friction_coefficients: list[Number] | None = optional(
        "or: dF/dP, below and above; needs [friction]", [1.6, 2.7]
    )
    crossover_load: Load = key("P/E* or P where they meet", "0.0380 mm^2")
    load_range: list[Load] | None = optional(LINES, ["0.02 mm^2", "0.1 mm^2"])

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        wording = _wording(self, material, friction, self.crossover_load, *(self.load_range or ()))
        ends = rescaled_range(self.load_range, material) if self.load_range is not None else None
        crossover = self.crossover_load.rescaled(material)
        return BilinearLaw(_slopes(self, wording, 2), crossover, ends, wording=wording)


def _wording(section: Section, material: Material, friction: Friction | None, *loads: GivenLoad) -> Wording:
    """Return the units in which texts state the slopes and loads of a section's target."""
    name = section.choices[1][0]
    if getattr(section, name) is not None:
        return Wording.of(material, _stated(friction, name))
    return _in_newtons(material, *loads)


def _slopes(section: MultilinearSection | BilinearSection, wording: Wording, count: int | None) -> Any:
    """Return the rescaled slopes of the branches."""
    if section.friction_coefficients is None:
        return section.slopes or []
    return wording.given_slopes(section.friction_coefficients, count)


def _stated(friction: Friction | None, key: str) -> Friction:
    """Return the Friction that a key needs; raise InvalidInput if the specification has none."""
    if friction is None:
        raise InvalidInput("needs [friction] with shear_strength", key=key)
    return friction


def _in_newtons(material: Material, *loads: GivenLoad) -> Wording:
    """Return the units in which texts state a law with rescaled friction: N for loads if one is in N."""
    return Wording(material.composite_modulus) if any(load.unit == "N" for load in loads) else RESCALED


AnyTarget = Annotated[
    PointsSection
    | LinearSection
    | BilinearSection
    | SampledSection
    | PowerSection
    | MultilinearSection
    | BandSection,
    Field(discriminator="kind"),
]
