"""Sections of a specification as pydantic models: known keys, their units, their types, their meaning."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, field_validator, model_validator

from metafem._given import Given, printable
from metafem.errors import InvalidInput
from metafem.files.part.plan import FORMATS, PartOptions
from metafem.files.specification.fields import (
    Angle,
    Length,
    Number,
    Section,
    Stress,
    Whether,
    measured,
    one_of,
    one_of_two,
    says,
)
from metafem.files.specification.models import MODELS, suggestion
from metafem.inversion import Layout, Limits, RadiusRange
from metafem.prediction import Tolerances
from metafem.surface import Material

Integer = Annotated[int, Field(strict=True)]
Radius = Annotated[float, Field(gt=0.0), measured("mm")]
Site = Annotated[int, Field(strict=True, ge=0)]


class MaterialSection(Section):
    """``[material]``."""

    choices = (("composite_modulus",), ("young_modulus",))

    composite_modulus: Annotated[Stress | None, says("either: E* = E/(1 - nu^2)", "1.36 MPa")] = None
    young_modulus: Annotated[Stress | None, says("or: E, Young's modulus", "1.02 MPa")] = None
    poisson_ratio: Annotated[Number, says("nu, from 0 to 0.5", 0.5)] = 0.5

    @model_validator(mode="after")
    def _one_of_two(self) -> MaterialSection:
        one_of_two(self, "composite_modulus", "young_modulus")
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

    choices = (("tools",), ("range",))

    tools: Annotated[
        Annotated[list[Radius], Field(min_length=1)] | None,
        says("either: radii of the available tools", ["300 um", "526 um"]),
    ] = None
    range: Annotated[
        tuple[Radius, Radius] | None, says("or: smallest and largest radius", ["200 um", "800 um"])
    ] = None
    step: Annotated[
        Radius | None, says("with range: radii between are multiples of it; default: 10 um", "10 um")
    ] = None
    mixed: Annotated[Whether, says("a radius for each asperity instead of one for all", True)] = False

    @field_validator("range")
    @classmethod
    def _increasing(cls, given: tuple[float, float] | None) -> tuple[float, float] | None:
        if given is not None and not given[0] < given[1]:
            ends = (Given("radii.range", radius) for radius in given)
            raise InvalidInput("must increase, but is [{.number}, {.number}]", *ends)
        return given

    @model_validator(mode="after")
    def _one_of_two(self) -> RadiiSection:
        one_of_two(self, "tools", "range")
        return self

    def radii(self) -> RadiusRange | tuple[float, ...]:
        """Return the range, or the tools."""
        if self.range is None:
            if self.step is not None:
                raise InvalidInput("needs radii.range: tools are used as they are", key="step")
            return tuple(self.tools or ())
        return RadiusRange(*self.range, *(() if self.step is None else (self.step,)))


class SitesSection(Section):
    """``[sites]``."""

    empty: Annotated[
        tuple[Site, ...],
        says("sites without an asperity, from 0 along x, then row by row along y", [17]),
    ] = ()
    pinned: Annotated[tuple[Site, ...], says("sites whose heights are given", [9, 12])] = ()
    heights: Annotated[
        tuple[Length, ...], says("of the summits at these sites, above the base plane", ["84 um", "120 um"])
    ] = ()

    def heights_by_site(
        self, count: int, limits: Limits, part: bool, problems: list[InvalidInput]
    ) -> dict[int, float | None]:
        """Return the height of each pinned site, None for an empty one; add problems to the list."""
        found: dict[int, float | None] = {}
        for key, given in (("empty", self.empty), ("pinned", self.pinned)):
            for i, site in enumerate(given):
                words = ""
                if site >= count:
                    words = f"is not a site: the lattice has the sites 0 to {count - 1}"
                elif site in found:
                    words = "is given twice" if site in given[:i] else "is also in sites.empty; keep one"
                if words:
                    problems.append(InvalidInput(words, key=f"sites.{key}[{i}]", value=str(site)))
                found[site] = None
        if len(self.pinned) != len(self.heights):
            many = f"has {len(self.heights)} entries and sites.pinned {len(self.pinned)}"
            words = f"{many}; give one height for each pinned site"
            problems.append(InvalidInput(words, key="sites.heights"))
        if len(set(self.empty)) == count:
            words = f"holds all {count} sites; leave out at least one"
            problems.append(InvalidInput(words, key="sites.empty"))
        top = limits.offset + limits.max_height
        for i, (site, height) in enumerate(zip(self.pinned, self.heights, strict=False)):
            bound = ""
            if height > top:
                bound = "at most {.number}, limits.offset + limits.max_height"
            elif height < 0.0:
                bound = "at least 0"
            elif height == 0.0 and part:
                bound = "greater than 0 in a part; list a site without an asperity in sites.empty"
            if bound:
                most, key = Given("sites.heights", top), f"sites.heights[{i}]"
                problems.append(InvalidInput(f"must be {bound}", most, key=key, value=height))
            found[site] = height
        return found


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
            raise InvalidInput("needs tilt", key="tilt_weight", example='tilt = "0.1 deg"')
        if self.tilt is None and not self.follow_law:
            return None
        return Layout(
            self.follow_law is not False, self.tilt, 1.0 if self.tilt_weight is None else self.tilt_weight
        )


class RobustSection(Section):
    """``[robust]``."""

    fewest = 1

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

    kind: Annotated[str, one_of(MODELS), says(f"one of: {', '.join(MODELS)}", "layer")] = "independent"

    @field_validator("kind")
    @classmethod
    def _known(cls, kind: str) -> str:
        if kind not in MODELS:
            raise InvalidInput(f"is unknown{suggestion(kind, MODELS)}", value=f'"{printable(kind, 60)}"')
        return kind


class PartSection(Section):
    """``[part]``."""

    alignment_height: Annotated[
        Annotated[float, Field(gt=0.0), measured("mm", "400 um")] | None,
        says("of four alignment asperities outside the corners; cut them off after use", "400 um"),
    ] = None
    chord_error: Annotated[
        Annotated[float, Field(gt=0.0), measured("mm", "1 um")] | None,
        says(
            "largest distance of the mesh from the caps; default: 4e-4 R, at most 2 million triangles",
            "1 um",
        ),
    ] = None
    formats: Annotated[
        tuple[Annotated[str, Field(strict=True), one_of(FORMATS)], ...],
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
        Annotated[float, Field(gt=0.0), measured("MPa", "10 MPa")] | None,
        says("H, which decides on a plastic law", "10 MPa"),
    ] = None
