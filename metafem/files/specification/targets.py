"""The section ``[target]``: a pydantic model for each kind of target law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema

from metafem import _validate as check
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification.fields import (
    Area,
    Choices,
    Force,
    Number,
    Section,
    key,
    optional,
    text_schema,
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


# A load and the unit in which it was written: mm^2 for P/E*, or N.
Given = tuple[float, str]


def given_load(given: Any) -> Given:
    """Return the load that a text states, and its unit, mm^2 or N; errors do not name a key."""
    try:
        return converted(given, "mm^2", LOAD), "mm^2"
    except InvalidInput as reason:
        try:
            return converted(given, "N", LOAD), "N"
        except InvalidInput:
            raise reason from None


def rescaled_range(given: Sequence[Given], material: Material) -> tuple[float, float]:
    """Return a range of rescaled loads [mm^2]; errors state the loads in the units that were written."""
    mixed = len({unit for _, unit in given}) > 1
    refuse_if(mixed, "mixes mm^2 and N; give both loads in one unit", key="load_range")
    check.interval("load_range", [load for load, _ in given])
    low, high = _rescaled([*given], material)
    return low, high


def _rescaled(given: Any, material: Material) -> Any:
    """Return a load, or the loads of nested lists, as rescaled loads [mm^2]."""
    if isinstance(given, list):
        return [_rescaled(each, material) for each in given]
    load, unit = given
    return load / material.composite_modulus if unit == "N" else load


def _in_newtons(given: Any) -> bool:
    """Return whether a load, or one of nested lists, was written in N."""
    return any(map(_in_newtons, given)) if isinstance(given, list) else given[1] == "N"


def _crossover(given: Any) -> Given | list[Given]:
    """Return the load, or the pair of loads, that a value states."""
    words = "must be a load or a pair of loads"
    refuse_if(given == [], words, value="[]", example=f'"{LOAD}"')
    return [given_load(load) for load in given] if isinstance(given, list) else given_load(given)


TEXT = text_schema("mm^2", "N")
PAIR = {"type": "array", "items": TEXT, "minItems": 2, "maxItems": 2}
Load = Annotated[Any, BeforeValidator(given_load), WithJsonSchema(TEXT)]
# one validator for a load or a pair: pydantic would report one error for each member of a union
Crossover = Annotated[Any, BeforeValidator(_crossover), WithJsonSchema({"anyOf": [TEXT, PAIR]})]

LOADS, FRICTIONS = ["0.144 mm^2", "0.336 mm^2"], ["0.84 mm^2", "1.68 mm^2"]
FORCES = {"load": ["0.2 N", "0.4 N"], "friction": ["0.26 N", "0.53 N"], "highest": ["0.32 N", "0.62 N"]}
RANGE, BOTH = ["0.05 mm^2", "0.2 mm^2"], ["0.02 mm^2", "0.1 mm^2"]
CROSSOVERS = ["0.07 mm^2", ["0.15 mm^2", "0.18 mm^2"]]
TWO = Field(min_length=2, max_length=2)
Range = Annotated[list[Load], TWO]
Pair = Annotated[list[Number], TWO]

# Keys of targets of slopes or an exponent that are loads.
LOADS_OF_LINES = ("load_range", "crossover_load", "crossover_loads")

# Arguments of `Band.from_forces` by their keys.
ARGUMENTS = {"lowest_force": "lowest", "highest_force": "highest"}


class CurveSection(Section):
    """A target that is given by points, as rescaled loads and rescaled friction or as forces."""

    law: ClassVar[Any]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target that the keys describe."""
        given: dict[str, Any] = self.given()
        found: Target
        if force := next((name for name in given if name.endswith("_force")), ""):
            given = {ARGUMENTS.get(name, name): value for name, value in given.items()}
            found = self.law.from_forces(**given, material=material, friction=_stated(friction, force))
            return found
        if "load" in given:  # areas measured at loads in N
            modulus = material.composite_modulus
            given["rescaled_load"] = np.array(given.pop("load")) / modulus
            given["wording"] = Wording(modulus)
        found = self.law(**given)
        return found


class PointsSection(CurveSection):
    """Points through which the law must pass."""

    kind: Literal["operating-points"]
    law: ClassVar[Any] = OperatingPoints
    choices: ClassVar[Choices] = (("rescaled_load", "rescaled_friction"), ("load", "friction_force"))
    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    rescaled_friction: list[Area] | None = optional("with it: F/(sigma B) at these loads", FRICTIONS)
    load: list[Force] | None = optional("or: P, increasing", FORCES["load"])
    friction_force: list[Force] | None = optional("with it: F at these; needs [friction]", FORCES["friction"])


class SampledSection(PointsSection):
    """A law of any shape, met in the least-squares sense.

    Before the section is read, the columns of the table replace the key `file`; areas may stand at loads.
    """

    kind: Literal["sampled"]  # type: ignore[assignment]
    law = SampledLaw
    choices = (*PointsSection.choices, ("file",), ("load", "rescaled_friction"))
    weight: list[Number] | None = optional("of each sample; default: 1/relative_error², or equal", [1.0, 2.0])
    relative_error: list[Number] | None = optional("standard deviation of each friction", [0.01, 0.02])
    file: str | None = optional("or: a table, such as load_N,friction_force_N with its errors", "wanted.csv")


class BandSection(CurveSection):
    """Any law between two curves; the design has the largest margin to both."""

    kind: Literal["band"]
    law = Band
    choices = (("rescaled_load", "lowest", "highest"), ("load", "lowest_force", "highest_force"))
    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    lowest: list[Area] | None = optional("with it: smallest F/(sigma B) at these loads", FRICTIONS)
    highest: list[Area] | None = optional("with it: largest F/(sigma B)", ["1.04 mm^2", "1.98 mm^2"])
    load: list[Force] | None = optional("or: P, increasing", FORCES["load"])
    lowest_force: list[Force] | None = optional("with it: smallest F; needs [friction]", FORCES["friction"])
    highest_force: list[Force] | None = optional("with it: largest F", FORCES["highest"])


class LineSection(Section):
    """A target of slopes or an exponent over loads, which are rescaled or in N."""

    law: ClassVar[Any]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target; texts state it in N if a load is in N, or if it has friction coefficients."""
        given = self.given()
        loads = {name: given[name] for name in LOADS_OF_LINES if name in given}
        wording = Wording(material.composite_modulus) if _in_newtons([*loads.values()]) else RESCALED
        if coefficients := next((name for name in given if name.startswith("friction_")), ""):
            wording = Wording.of(material, _stated(friction, coefficients))
            value = given.pop(coefficients)
            if coefficients.endswith("s"):
                given["slopes"] = wording.given_slopes(value, None)
            else:
                value = check.number(coefficients, value, above=0.0)
                (given["slope"],) = wording.given_slopes([value], None)
        if "load_range" in loads:
            given["load_range"] = rescaled_range(loads.pop("load_range"), material)
        given |= {name: _rescaled(value, material) for name, value in loads.items()}
        found: Target = self.law(**given, wording=wording)
        return found


class LinearSection(LineSection):
    """A straight line with a slope or a friction coefficient."""

    kind: Literal["linear"]
    law = LinearLaw
    choices = (("slope",), ("friction_coefficient",))
    slope: Number | None = optional("either: of F/(sigma B) over P/E*", 6.87)
    friction_coefficient: Number | None = optional("or: dF/dP; needs [friction]", 1.5)
    load_range: Range | None = optional("P/E* or P, from and to: a line through the origin", RANGE)


class BilinearSection(LineSection):
    """Two straight branches that meet at a crossover load."""

    kind: Literal["bilinear"]
    law = BilinearLaw
    choices = (("slopes",), ("friction_coefficients",))
    slopes: Pair | None = optional("either: of F/(sigma B) over P/E*, below and above", [7.15, 12.52])
    friction_coefficients: Pair | None = optional("or: dF/dP, below and above; needs [friction]", [1.6, 2.7])
    crossover_load: Load = key("P/E* or P where they meet", "0.0380 mm^2")
    load_range: Range | None = optional("P/E* or P, from and to: the first line through the origin", BOTH)


class MultilinearSection(LineSection):
    """Straight branches with increasing or decreasing slopes and a free intercept."""

    kind: Literal["multilinear"]
    law = MultilinearLaw
    choices = (("slopes",), ("friction_coefficients",))
    slopes: list[Number] | None = optional("either: of F/(sigma B) over P/E*, of each", [9.5, 8.0, 7.0])
    friction_coefficients: list[Number] | None = optional("or: dF/dP; needs [friction]", [2.1, 1.8, 1.6])
    crossover_loads: list[Crossover] = key("P/E* or P: one load each, or a pair, free between", CROSSOVERS)
    load_range: Range = key("P/E* or P, from and to", ["0.03 mm^2", "0.26 mm^2"])


class PowerSection(LineSection):
    """Friction proportional to a power of the load."""

    kind: Literal["power"]
    law = PowerLaw
    exponent: Number = key("of F/(sigma B) = C (P/E*)^exponent", 1.2)
    load_range: Range = key("P/E* or P, from and to", ["0.1 mm^2", "0.4 mm^2"])
    prefactor: Number | None = optional("C, for areas in mm^2; default: chosen by the design", 7.0)


def _stated(friction: Friction | None, key: str) -> Friction:
    """Return the Friction that a key needs; raise InvalidInput if the specification has none."""
    if friction is None:
        raise InvalidInput("needs [friction] with shear_strength", key=key)
    return friction


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
