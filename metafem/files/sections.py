"""Sections of a specification as pydantic models: known keys, their units, their types."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator, model_validator

from metafem.errors import InvalidInput
from metafem.files.model_names import MODELS, suggestion
from metafem.files.units import converted
from metafem.inversion import (
    BilinearLaw,
    Limits,
    LinearLaw,
    MultilinearLaw,
    OperatingPoints,
    PowerLaw,
    SampledLaw,
    Target,
)
from metafem.models import Model
from metafem.surface import Block, Friction, Material, Surface


def _in(unit: str, example: str | None = None) -> BeforeValidator:
    return BeforeValidator(lambda given: converted(given, unit, example))


Length = Annotated[float, _in("mm")]
Area = Annotated[float, _in("mm^2")]
Force = Annotated[float, _in("N")]
Stress = Annotated[float, _in("MPa")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]


class Section(BaseModel):
    """A section in which every key is known."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class CurveSection(Section):
    """Points of a law: rescaled values, or forces."""

    rescaled_load: list[Area] | None = None
    rescaled_friction: list[Area] | None = None
    load: list[Force] | None = None
    friction_force: list[Force] | None = None

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
    """``[target]`` of kind operating-points."""

    kind: Literal["operating-points"]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return self.points(material, friction)


class SampledSection(CurveSection):
    """``[target]`` of kind sampled; `file` has been replaced by what it holds."""

    kind: Literal["sampled"]
    weight: list[Number] | None = None

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        points = self.points(material, friction)
        return SampledLaw(points.rescaled_load, points.rescaled_friction, self.weight)


class PowerSection(Section):
    """``[target]`` of kind power."""

    kind: Literal["power"]
    exponent: Number
    load_range: list[Area]
    prefactor: Number | None = None

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return PowerLaw(self.exponent, self.load_range, self.prefactor)


class MultilinearSection(Section):
    """``[target]`` of kind multilinear."""

    kind: Literal["multilinear"]
    slopes: list[Number]
    crossover_loads: list[Area | list[Area]]
    load_range: list[Area]

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return MultilinearLaw(self.slopes, self.crossover_loads, self.load_range)


class LinearSection(Section):
    """``[target]`` of kind linear: a slope or a friction coefficient."""

    kind: Literal["linear"]
    slope: Number | None = None
    friction_coefficient: Number | None = None

    @model_validator(mode="after")
    def _one_of_two(self) -> LinearSection:
        if (self.slope is None) == (self.friction_coefficient is None):
            raise InvalidInput("needs slope or friction_coefficient, one of the two")
        return self

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        if self.friction_coefficient is None:
            return LinearLaw(self.slope or 0.0)
        if friction is None:
            raise InvalidInput("friction_coefficient needs [friction] with shear_strength and area_ratio")
        return LinearLaw.from_friction_coefficient(self.friction_coefficient, material, friction)


class BilinearSection(Section):
    """``[target]`` of kind bilinear."""

    kind: Literal["bilinear"]
    slopes: list[Number]
    crossover_load: Area

    def target(self, material: Material, friction: Friction | None) -> Target:
        """Return the target of these keys."""
        return BilinearLaw(self.slopes, self.crossover_load)


class MaterialSection(Section):
    """``[material]``."""

    composite_modulus: Stress
    poisson_ratio: Number = 0.5


class FrictionSection(Section):
    """``[friction]``."""

    shear_strength: Stress
    area_ratio: Number = 1.0


class LatticeSection(Section):
    """``[lattice]``."""

    shape: tuple[Annotated[int, Field(strict=True)], Annotated[int, Field(strict=True)]]
    pitch: Annotated[float, _in("mm", "1.5 mm")]
    radius: Annotated[float, _in("mm", "526 um")]


class BlockSection(Section):
    """``[block]``."""

    width: Annotated[float, _in("mm", "20 mm")]
    length: Annotated[float, _in("mm", "20 mm")]
    thickness: Annotated[float, _in("mm", "7.2 mm")]


class LimitsSection(Section):
    """``[limits]``."""

    max_height: Length
    min_height: Length = 0.0
    offset: Length = 0.0
    height_step: Length | None = None
    height_sd: Length | None = None


class LayoutSection(Section):
    """``[layout]``."""

    seed: Annotated[int, Field(strict=True, ge=0)] = 0


class ModelSection(Section):
    """``[model]``."""

    kind: str = "independent"

    @field_validator("kind")
    @classmethod
    def _known(cls, kind: str) -> str:
        if kind not in MODELS:
            raise InvalidInput(f'= "{kind:.60}" is unknown{suggestion(kind, MODELS)}')
        return kind

    def model(self) -> Model:
        """Return the model of this kind."""
        return MODELS[self.kind]()


class PartSection(Section):
    """``[part]``."""

    alignment_height: Annotated[float, _in("mm", "400 um"), Field(gt=0.0)] | None = None


class ChecksSection(Section):
    """``[checks]``."""

    hardness: Annotated[float, _in("MPa", "10 MPa"), Field(gt=0.0)] | None = None


class Sections(Section):
    """The whole file."""

    target: Annotated[
        PointsSection | LinearSection | BilinearSection | SampledSection | PowerSection | MultilinearSection,
        Field(discriminator="kind"),
    ]
    material: MaterialSection
    friction: FrictionSection | None = None
    lattice: LatticeSection
    block: BlockSection | None = None
    limits: LimitsSection
    layout: LayoutSection = LayoutSection()
    model: ModelSection = ModelSection()
    part: PartSection = PartSection()
    checks: ChecksSection = ChecksSection()

    def build(self) -> tuple[Target | None, Surface | None, Limits | None, list[str]]:
        """Return target, template and limits, or None and what is wrong with each, one per problem."""
        problems: list[str] = []

        def made(section: str, kind: Any, values: dict[str, Any]) -> Any:
            try:
                return kind(**values)
            except InvalidInput as error:
                problems.append(f"{section}.{error}")
                return None

        material = made("material", Material, self.material.model_dump())
        friction = self.friction and made("friction", Friction, self.friction.model_dump())
        block = self.block and made("block", Block, self.block.model_dump())
        limits = made("limits", Limits, self.limits.model_dump())
        # Stand-ins let the other sections be judged when one of these is wrong.
        top = limits.offset + limits.max_height if limits else 1.0
        stuff = material or Material(1.0)
        lattice = {"height": top, "material": stuff, "friction": friction, "block": block}
        template = made("lattice", Surface.square_lattice, {**self.lattice.model_dump(), **lattice})
        pair = friction or (Friction(1.0) if self.friction else None)
        target = made("target", self.target.target, {"material": stuff, "friction": pair})
        return target, template, limits, problems
