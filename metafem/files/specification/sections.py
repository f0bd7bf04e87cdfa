"""Sections of a specification as pydantic models: known keys, their units, their types, their meaning."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

from pydantic import Field, field_validator, model_validator

from metafem import _validate as check
from metafem._given import error_section, formatted, printable
from metafem.errors import InvalidInput
from metafem.files.part.plan import PartOptions, planned
from metafem.files.specification.cost import refuse_too_many
from metafem.files.specification.fields import Angle, Length, Number, Section, Stress, Whether, measured, says
from metafem.files.specification.models import MODELS, suggestion
from metafem.files.specification.targets import (
    BilinearSection,
    LinearSection,
    MultilinearSection,
    PointsSection,
    PowerSection,
    SampledSection,
)
from metafem.inversion import Layout, Limits, RadiusRange
from metafem.models import Model
from metafem.prediction import Tolerances
from metafem.surface import Block, Friction, Material, Surface

Integer = Annotated[int, Field(strict=True)]
Radius = Annotated[Length, Field(gt=0.0)]


class MaterialSection(Section):
    """``[material]``."""

    composite_modulus: Annotated[Stress | None, says("either: E* = E/(1 - nu^2)", "1.36 MPa")] = None
    young_modulus: Annotated[Stress | None, says("or: E, Young's modulus", "1.02 MPa")] = None
    poisson_ratio: Annotated[Number, says("nu, from 0 to 0.5", 0.5)] = 0.5

    @model_validator(mode="after")
    def _one_of_two(self) -> MaterialSection:
        if (self.composite_modulus is None) == (self.young_modulus is None):
            raise InvalidInput("needs either composite_modulus or young_modulus")
        return self

    def material(self) -> Material:
        """Return the material."""
        if self.young_modulus is not None:
            return Material.from_young(self.young_modulus, self.poisson_ratio)
        assert self.composite_modulus is not None
        return Material(self.composite_modulus, self.poisson_ratio)


class FrictionSection(Section):
    """``[friction]``."""

    shear_strength: Annotated[Stress, says("sigma: friction force per real contact area", "0.358 MPa")]
    area_ratio: Annotated[Number, says("B: sheared over initial real contact area", 0.85)] = 1.0


class LatticeSection(Section):
    """``[lattice]``."""

    shape: Annotated[tuple[Integer, Integer], says("rows, columns", [8, 8])]
    pitch: Annotated[float, measured("mm", "1.5 mm"), says("distance between neighbours", "1.5 mm")]
    radius: Annotated[
        Annotated[float, measured("mm", "526 um")] | None,
        says("either: radius of curvature of the summits; or: a section [radii]", "526 um"),
    ] = None


class RadiiSection(Section):
    """``[radii]``."""

    tools: Annotated[
        Annotated[list[Radius], Field(min_length=1)] | None,
        says("either: radii of the available tools", ["300 um", "526 um"]),
    ] = None
    range: Annotated[
        tuple[Radius, Radius] | None, says("or: smallest and largest radius", ["200 um", "800 um"])
    ] = None
    mixed: Annotated[Whether, says("a radius for each asperity instead of one for all", True)] = False

    @field_validator("range")
    @classmethod
    def _increasing(cls, given: tuple[float, float] | None) -> tuple[float, float] | None:
        if given is not None and not given[0] < given[1]:
            low, high = (formatted("radii.range", radius) for radius in given)
            raise InvalidInput(f"= [{low}, {high}] must increase")
        return given

    @model_validator(mode="after")
    def _one_of_two(self) -> RadiiSection:
        if (self.tools is None) == (self.range is None):
            raise InvalidInput("needs either tools or range")
        return self

    def radii(self) -> RadiusRange | tuple[float, ...]:
        """Return the range, or the tools."""
        return tuple(self.tools or ()) if self.range is None else RadiusRange(*self.range)


class BlockSection(Section):
    """``[block]``."""

    width: Annotated[float, measured("mm", "20 mm"), says("along x", "20 mm")]
    length: Annotated[float, measured("mm", "20 mm"), says("along y", "20 mm")]
    thickness: Annotated[float, measured("mm", "7.2 mm"), says("down to the rigid plate", "7.2 mm")]


class LimitsSection(Section):
    """``[limits]``."""

    max_height: Annotated[Length, says("of the summits, above the offset", "120 um")]
    min_height: Annotated[Length, says("of the summits, above the offset", "10 um")] = 0.0
    offset: Annotated[Length, says("added to all heights", "84 um")] = 0.0
    height_step: Annotated[
        Length | None,
        says(
            "distance between levels, the middles of steps from the lowest height; default: any height",
            "6 um",
        ),
    ] = None
    height_sd: Annotated[Length | None, says("standard deviation of the manufactured heights", "0.9 um")] = (
        None
    )


class LayoutSection(Section):
    """``[layout]``."""

    seed: Annotated[
        int, Field(strict=True, ge=0), says("of the random assignment of heights to sites", 0)
    ] = 0
    follow_law: Annotated[
        Whether | None, says("reduce the effect of interaction; default: true with tilt, else false", True)
    ] = None
    tilt: Annotated[Angle | None, says("reduce the effect of a tilt of this angle", "0.1 deg")] = None
    tilt_weight: Annotated[
        Number | None, says("weight of the tilt relative to interaction; default: 1", 2.0)
    ] = None

    def layout(self) -> Layout | None:
        """Return the objectives of the assignment of heights to sites."""
        if self.tilt is None and self.tilt_weight is not None:
            raise InvalidInput('tilt_weight needs tilt; write for example tilt = "0.1 deg"')
        if self.tilt is None and not self.follow_law:
            return None
        return Layout(
            self.follow_law is not False, self.tilt, 1.0 if self.tilt_weight is None else self.tilt_weight
        )


class RobustSection(Section):
    """``[robust]``."""

    height_sd: Annotated[Length, says("standard deviation of the heights", "3 um")] = 0.0
    angle: Annotated[Angle, says("largest tilt about either axis", "0.05 deg")] = 0.0
    radius_sd: Annotated[Length, says("standard deviation of the radii", "2 um")] = 0.0
    position_sd: Annotated[Length, says("standard deviation of x and y of each site", "5 um")] = 0.0

    @model_validator(mode="after")
    def _some(self) -> RobustSection:
        if not any(self.model_dump().values()):
            raise InvalidInput(f"needs an error above 0 of {', '.join(RobustSection.model_fields)}")
        return self

    def tolerances(self) -> Tolerances:
        """Return the errors of the made surface."""
        return Tolerances(**self.model_dump())


class ModelSection(Section):
    """``[model]``."""

    kind: Annotated[str, says(f"one of: {', '.join(MODELS)}", "layer")] = "independent"

    @field_validator("kind")
    @classmethod
    def _known(cls, kind: str) -> str:
        if kind not in MODELS:
            raise InvalidInput(f'= "{printable(kind, 60)}" is unknown{suggestion(kind, MODELS)}')
        return kind

    def model(self) -> Model:
        """Return the model of this kind."""
        return MODELS[self.kind]()


class PartSection(Section):
    """``[part]``."""

    alignment_height: Annotated[
        Annotated[float, measured("mm", "400 um"), Field(gt=0.0)] | None,
        says("of four alignment asperities outside the corners; cut them off after use", "400 um"),
    ] = None
    chord_error: Annotated[
        Annotated[float, measured("mm", "1 um"), Field(gt=0.0)] | None,
        says(
            "largest distance of the mesh from the spheres; default: 4e-4 R, at most 2 million triangles",
            "1 um",
        ),
    ] = None
    formats: Annotated[
        tuple[Annotated[str, Field(strict=True)], ...],
        says("of the part and its mould: stl, 3mf, obj", ["stl", "3mf"]),
    ] = ("stl",)

    @field_validator("formats")
    @classmethod
    def _known_formats(cls, formats: tuple[str, ...]) -> tuple[str, ...]:
        return PartOptions(formats=formats).formats

    def options(self) -> PartOptions:
        """Return the options of the part files."""
        return PartOptions(self.alignment_height, self.chord_error, self.formats)


class ChecksSection(Section):
    """``[checks]``."""

    hardness: Annotated[
        Annotated[float, measured("MPa", "10 MPa"), Field(gt=0.0)] | None,
        says("hardness of the softer material", "10 MPa"),
    ] = None


class Sections(Section):
    """The whole file."""

    target: Annotated[
        PointsSection | LinearSection | BilinearSection | SampledSection | PowerSection | MultilinearSection,
        Field(discriminator="kind", description="the target friction law, of one of these kinds"),
    ]
    material: Annotated[MaterialSection, says("the elastomer")]
    friction: Annotated[FrictionSection | None, says("needed for friction forces in N")] = None
    lattice: Annotated[LatticeSection, says("sites of asperities")]
    radii: Annotated[RadiiSection | None, says("radii to choose from, instead of lattice.radius")] = None
    block: Annotated[
        BlockSection | None, says("needed for the part files and the models layer and block")
    ] = None
    limits: Annotated[LimitsSection, says("manufacturing limits")]
    layout: Annotated[LayoutSection, says("assignment of heights to sites")] = LayoutSection()
    robust: Annotated[
        RobustSection | None, says("errors of the part, under which the expected misfit is least")
    ] = None
    model: Annotated[ModelSection, says("model under which the target is to be met")] = ModelSection()
    part: Annotated[PartSection, says("options of the part files")] = PartSection()
    checks: Annotated[ChecksSection, says("further checks")] = ChecksSection()

    def build(self) -> tuple[dict[str, Any], list[str]]:
        """Return target, template, limits, layout, radii, robust and part, and a list of problems."""
        problems: list[str] = []

        def made(section: str, kind: Any, values: dict[str, Any]) -> Any:
            try:
                with error_section(section):
                    return kind(**values)
            except InvalidInput as error:
                problems.append(f"{section}.{error}")
                return None

        material = made("material", self.material.material, {})
        friction = self.friction and made("friction", Friction, self.friction.model_dump())
        block = None if self.block is None else made("block", Block, self.block.model_dump())
        limits = made("limits", Limits, self.limits.model_dump())
        layout = made("layout", self.layout.layout, {})
        robust = self.robust and made("robust", self.robust.tolerances, {})
        # Placeholders, so that the other sections are checked even if one of these is wrong.
        top = limits.offset + limits.max_height if limits else 1.0
        stuff = material or Material(1.0)
        radius, radii, source = self._radius(problems)
        lost = self._lost_beside(radius, source, limits, block, problems)
        if self._too_many(problems) or lost:
            template = None
        else:
            others = {"material": stuff, "friction": friction, "block": block}
            lattice = {**self.lattice.model_dump(), "height": top, "radius": radius, **others}
            template = made("lattice", Surface.square_lattice, lattice)
        pair = friction or (Friction(1.0) if self.friction else None)
        target = made("target", self.target.target, {"material": stuff, "friction": pair})
        largest = radius if radii is None else radii.high if isinstance(radii, RadiusRange) else max(radii)
        if limits and block and not lost and top > largest:
            heights = f"limits.offset + limits.max_height = {formatted('limits.max_height', top)}"
            problems.append(
                f"{heights} exceed the radius of {formatted(source, largest)}: a cap cannot be "
                "higher than its radius; lower them, or omit [block] and with it the part files"
            )
        part = self.part.options()
        if template and radii is None and not problems:
            try:
                planned(template, template, part)
            except InvalidInput as error:
                heights = f"limits.offset + limits.max_height = {formatted('limits.max_height', top)}"
                problems.append(f"with summits of {heights}, {error}")
        parts = {"target": target, "template": template, "limits": limits, "layout": layout, "radii": radii}
        parts |= {"robust": robust, "part": part}
        return parts, problems

    def _radius(self, problems: list[str]) -> tuple[float, RadiusRange | tuple[float, ...] | None, str]:
        """Return the template's radius, the radii to choose from and their key; add problems to the list."""
        one = self.lattice.radius
        source, values = "lattice.radius", [one or 0.0]
        if self.radii is not None:
            source = "radii.tools" if self.radii.range is None else "radii.range"
            values = [*(self.radii.range or self.radii.tools or ())]
            if one is not None:
                problems.append("lattice.radius and [radii] both give radii; keep one")
        elif one is None:
            missing = 'write for example radius = "526 um", or a section [radii]'
            problems.append(f"lattice.radius is missing; {missing}")
            return 1.0, None, source
        try:
            values = [check.number(source, radius, above=0.0) for radius in values]
            check.proportion(source, max(values), source, min(values))
            given = None if self.radii is None else self.radii.radii()
        except InvalidInput as error:
            problems.append(str(error))
            return 1.0, None, source
        return min(values), given, source

    def _too_many(self, problems: list[str]) -> bool:
        """Return whether the lattice has too many sites, and add this to the problems."""
        rows, columns = self.lattice.shape
        try:
            refuse_too_many(max(0, rows) * max(0, columns))
        except InvalidInput as error:
            problems.append(f"lattice.shape = [{rows}, {columns}] {error}")
            return True
        return False

    def _lost_beside(
        self, radius: float, source: str, limits: Limits | None, block: Block | None, problems: list[str]
    ) -> bool:
        """Return whether lengths differ too much from the radius, and add them to the problems."""
        before = len(problems)
        heights = (
            {} if limits is None else {"limits.max_height": limits.max_height, "limits.offset": limits.offset}
        )
        sizes = {} if block is None else {f"block.{name}": size for name, size in asdict(block).items()}
        for name, size in {**heights, **sizes}.items():
            try:
                if radius > 0.0 and (size > radius or name in sizes):
                    check.proportion(name, size, source, radius)
            except InvalidInput as error:
                problems.append(str(error))
        return len(problems) > before
