"""The section ``[target]``: a pydantic model for each kind of target law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema

import metafem as mf
from metafem import _validate as check
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification.sections import (
    TWO,
    Area,
    Choices,
    Force,
    FromTable,
    Positive,
    Section,
    key,
    optional,
    text_schema,
)
from metafem.files.units import converted
from metafem.inversion import Target
from metafem.inversion.wording import RESCALED, Wording

# Example in errors about a load, which may be a rescaled load or a force.
LOAD = '0.144 mm^2" or "0.2 N'

# Argument of a target for each key that is a force or a friction coefficient, and exponents of E* and of
# sigma B: the value of the key is the argument times their powers.
ARGUMENTS = {
    "load": ("rescaled_load", 1, 0),
    "friction_force": ("rescaled_friction", 0, 1),
    "lowest_force": ("lowest", 0, 1),
    "highest_force": ("highest", 0, 1),
    "friction_coefficient": ("slope", -1, 1),
    "friction_coefficients": ("slopes", -1, 1),
}

# A load and the unit in which it was written: mm^2 for P/E*, or N.
Given = tuple[float, str]


def given_load(given: Any) -> Given:
    """Return the load that a text states, and its unit, mm^2 or N; errors do not name a key."""
    unit = "N" if isinstance(given, str) and given.rstrip().endswith("N") else "mm^2"
    return converted(given, unit, LOAD), unit


def rescaled_range(given: Sequence[Given], material: mf.Material) -> tuple[float, float]:
    """Return a range of rescaled loads [mm^2]."""
    return check.interval("load_range", _rescaled([*given], material.composite_modulus))


def _rescaled(given: Any, modulus: float) -> Any:
    """Return a load, or the loads of nested lists, as rescaled loads [mm^2]; other values stay."""
    if isinstance(given, list):
        return [_rescaled(each, modulus) for each in given]
    if not isinstance(given, tuple):
        return given
    load, unit = given
    return load / modulus if unit == "N" else load


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
Range = Annotated[list[Load], TWO]
Pair = Annotated[list[Positive], TWO]


class TargetSection(Section):
    """A target, whose keys are rescaled values, or forces and friction coefficients."""

    law: ClassVar[Any]

    def target(self, material: mf.Material, friction: mf.Friction | None) -> Target:
        """Return the target; texts state it in N if a load is in N, or if it has friction forces."""
        given, modulus = self.given(), material.composite_modulus
        wording = Wording(modulus) if "load" in given or _in_newtons([*given.values()]) else RESCALED
        arguments, names = dict[str, Any](), dict[str, str]()
        for name, value in given.items():
            argument, moduli, stresses = ARGUMENTS.get(name, (name, 0, 0))
            size = float(modulus**moduli)
            if stresses:
                if friction is None:
                    raise InvalidInput("needs [friction] with shear_strength", key=name)
                wording, size = Wording.of(material, friction), size * friction.stress
            rescaled = (np.array(value) / size).tolist() if name in ARGUMENTS else _rescaled(value, modulus)
            arguments[argument], names[argument] = rescaled, name
        try:
            found: Target = self.law(**arguments, wording=wording)
        except InvalidInput as error:
            argument, bracket, entry = error.key.partition("[")
            raise error.at(f"{names.get(argument, argument)}{bracket}{entry}") from None
        return found


def _in_newtons(given: Any) -> bool:
    """Return whether a load, or one of nested lists, was written in N."""
    if isinstance(given, list):
        return any(map(_in_newtons, given))
    return isinstance(given, tuple) and given[1] == "N"


class PointsSection(TargetSection):
    """Points through which the law must pass."""

    kind: Literal["operating-points"]
    law: ClassVar[Any] = mf.OperatingPoints
    choices: ClassVar[Choices] = (("rescaled_load", "rescaled_friction"), ("load", "friction_force"))
    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    rescaled_friction: list[Area] | None = optional("with it: F/(sigma B) at these loads", FRICTIONS)
    load: list[Force] | None = optional("or: P, increasing", FORCES["load"])
    friction_force: list[Force] | None = optional("with it: F at these; needs [friction]", FORCES["friction"])


class SampledSection(FromTable, PointsSection):
    """A law of any shape, met in the least-squares sense.

    The columns of the table in `file` replace the key; areas may stand at loads.
    """

    kind: Literal["sampled"]  # type: ignore[assignment]
    law = mf.SampledLaw
    choices = (*PointsSection.choices, ("file",), ("load", "rescaled_friction"))
    weight: list[Positive] | None = optional(
        "of each sample; default: 1/relative_error², or equal", [1.0, 2.0]
    )
    relative_error: list[Positive] | None = optional("standard deviation of each friction", [0.01, 0.02])
    file: str | None = optional("or: a table, such as load_N,friction_force_N with its errors", "wanted.csv")


class BandSection(TargetSection):
    """Any law between two curves; the design has the largest margin to both."""

    kind: Literal["band"]
    law = mf.Band
    choices = (("rescaled_load", "lowest", "highest"), ("load", "lowest_force", "highest_force"))
    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    lowest: list[Area] | None = optional("with it: smallest F/(sigma B) at these loads", FRICTIONS)
    highest: list[Area] | None = optional("with it: largest F/(sigma B)", ["1.04 mm^2", "1.98 mm^2"])
    load: list[Force] | None = optional("or: P, increasing", FORCES["load"])
    lowest_force: list[Force] | None = optional("with it: smallest F; needs [friction]", FORCES["friction"])
    highest_force: list[Force] | None = optional("with it: largest F", FORCES["highest"])


class LinearSection(TargetSection):
    """A straight line with a slope or a friction coefficient."""

    kind: Literal["linear"]
    law = mf.LinearLaw
    choices = (("slope",), ("friction_coefficient",))
    slope: Positive | None = optional("either: of F/(sigma B) over P/E*", 6.87)
    friction_coefficient: Positive | None = optional("or: dF/dP; needs [friction]", 1.5)
    load_range: Range | None = optional("P/E* or P, from and to: a line through the origin", RANGE)


class BilinearSection(TargetSection):
    """Two straight branches that meet at a crossover load."""

    kind: Literal["bilinear"]
    law = mf.BilinearLaw
    choices = (("slopes",), ("friction_coefficients",))
    slopes: Pair | None = optional("either: of F/(sigma B) over P/E*, below and above", [7.15, 12.52])
    friction_coefficients: Pair | None = optional("or: dF/dP, below and above; needs [friction]", [1.6, 2.7])
    crossover_load: Load = key("P/E* or P where they meet", "0.0380 mm^2")
    load_range: Range | None = optional("P/E* or P, from and to: the first line through the origin", BOTH)


class MultilinearSection(TargetSection):
    """Straight branches with increasing or decreasing slopes and a free intercept."""

    kind: Literal["multilinear"]
    law = mf.MultilinearLaw
    choices = (("slopes",), ("friction_coefficients",))
    slopes: list[Positive] | None = optional("either: of F/(sigma B) over P/E*, of each", [9.5, 8.0, 7.0])
    friction_coefficients: list[Positive] | None = optional("or: dF/dP; needs [friction]", [2.1, 1.8, 1.6])
    crossover_loads: list[Crossover] = key("P/E* or P: one load each, or a pair, free between", CROSSOVERS)
    load_range: Range = key("P/E* or P, from and to", ["0.03 mm^2", "0.26 mm^2"])


class PowerSection(TargetSection):
    """mf.Friction proportional to a power of the load."""

    kind: Literal["power"]
    law = mf.PowerLaw
    exponent: Positive = key("of F/(sigma B) = C (P/E*)^exponent", 1.2)
    load_range: Range = key("P/E* or P, from and to", ["0.1 mm^2", "0.4 mm^2"])
    prefactor: Positive | None = optional("C, for areas in mm^2; default: chosen by the design", 7.0)


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
