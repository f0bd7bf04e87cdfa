"""The section ``[target]``: a pydantic model for each kind of target law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, WithJsonSchema

import metafem as mf
from metafem import _validate as check
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification.sections import (
    TWO,
    Area,
    Choices,
    Force,
    Positive,
    Section,
    key,
    one_of,
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


def in_newtons(given: Any) -> bool:
    """Return whether a value, or one of nested lists, is a text in N."""
    if isinstance(given, list):
        return any(map(in_newtons, given))
    return isinstance(given, str) and given.rstrip().endswith("N")


def rescaled(given: Any, modulus: float) -> Any:
    """Return a load in mm^2 or N, or the loads of nested lists, as rescaled loads [mm^2]; numbers stay."""
    if isinstance(given, list):
        return [rescaled(each, modulus) for each in given]
    if not isinstance(given, str):
        return given
    return converted(given, "N", LOAD) / modulus if in_newtons(given) else converted(given, "mm^2", LOAD)


def rescaled_range(given: Sequence[str], material: mf.Material) -> tuple[float, float]:
    """Return a range of rescaled loads [mm^2] from the texts of two loads."""
    return check.interval("load_range", rescaled([*given], material.composite_modulus))


def _load(given: Any) -> Any:
    """Return a load, or a pair of loads, as it is written; it becomes a number with the material."""
    refuse_if(given == [], "must be a load or a pair of loads", value="[]", example=f'"{LOAD}"')
    for each in given if isinstance(given, list) else [given]:
        converted(each, "N" if in_newtons(each) else "mm^2", LOAD)
    return given


TEXT = text_schema("mm^2", "N")
PAIR = {"type": "array", "items": TEXT, "minItems": 2, "maxItems": 2}
Load = Annotated[Any, BeforeValidator(_load), WithJsonSchema(TEXT)]
# one validator for a load or a pair: pydantic would report one error for each member of a union
Crossover = Annotated[Any, BeforeValidator(_load), WithJsonSchema({"anyOf": [TEXT, PAIR]})]

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
        wording = Wording(modulus) if "load" in given or in_newtons([*given.values()]) else RESCALED
        arguments, names = dict[str, Any](), dict[str, str]()
        for name, value in given.items():
            argument, moduli, stresses = ARGUMENTS.get(name, (name, 0, 0))
            size = float(modulus**moduli)
            if stresses:
                if friction is None:
                    raise InvalidInput("needs [friction] with shear_strength", key=name)
                wording, size = Wording.of(material, friction), size * friction.stress
            known = name in ARGUMENTS
            arguments[argument] = (np.array(value) / size).tolist() if known else rescaled(value, modulus)
            names[argument] = name
        try:
            found: Target = self.law(**arguments, wording=wording)
        except InvalidInput as error:
            argument, bracket, entry = error.key.partition("[")
            raise error.at(f"{names.get(argument, argument)}{bracket}{entry}") from None
        return found


class PointsSection(TargetSection):
    """Points through which the law must pass."""

    kind: Literal["operating-points"]
    law: ClassVar[Any] = mf.OperatingPoints
    choices: ClassVar[Choices] = (("rescaled_load", "rescaled_friction"), ("load", "friction_force"))
    rescaled_load: list[Area] | None = optional("either: P/E*, increasing", LOADS)
    rescaled_friction: list[Area] | None = optional("with it: F/(sigma B) at these loads", FRICTIONS)
    load: list[Force] | None = optional("or: P, increasing", FORCES["load"])
    friction_force: list[Force] | None = optional("with it: F at these; needs [friction]", FORCES["friction"])


class SampledSection(PointsSection):
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
    """Friction proportional to a power of the load."""

    kind: Literal["power"]
    law = mf.PowerLaw
    exponent: Positive = key("of F/(sigma B) = C (P/E*)^exponent", 1.2)
    load_range: Range = key("P/E* or P, from and to", ["0.1 mm^2", "0.4 mm^2"])
    prefactor: Positive | None = optional("C, for areas in mm^2; default: chosen by the design", 7.0)


AnyTarget: Any = one_of(
    *(PointsSection, LinearSection, BilinearSection, SampledSection, PowerSection, MultilinearSection),
    BandSection,
)
