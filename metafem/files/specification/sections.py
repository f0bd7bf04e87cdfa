"""Sections of a specification as pydantic models, with the types, units and meanings of their keys."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, field_validator

from metafem import _validate as check
from metafem._given import Given, printable
from metafem.caps import Cap
from metafem.caps.shapes import STEEPEST
from metafem.errors import InvalidInput, refuse_if
from metafem.files.caps import cap_named
from metafem.files.part.plan import PartOptions
from metafem.files.specification.fields import (
    Angle,
    Length,
    Number,
    PositiveLength,
    PositiveStress,
    Section,
    Stress,
    key,
    one_of,
    optional,
)
from metafem.files.specification.models import MODELS, suggestion
from metafem.inversion import Limits, PowerRange, RadiusRange, Tool
from metafem.surface import Block, Friction, Material

Integer = Annotated[int, Field(strict=True)]
Site = Annotated[int, Field(strict=True, ge=0)]


class MaterialSection(Section):
    """The section ``[material]``."""

    choices = (("composite_modulus",), ("young_modulus",))

    composite_modulus: Stress | None = optional("either: E* = E/(1 - nu^2)", "1.36 MPa")
    young_modulus: Stress | None = optional("or: E, Young's modulus", "1.02 MPa")
    poisson_ratio: Number = key("nu, from 0 to 0.5", 0.5, default=0.5)

    def value(self) -> Material:
        """Return the material."""
        if self.young_modulus is not None:
            return Material.from_young(self.young_modulus, self.poisson_ratio)
        assert self.composite_modulus is not None
        return Material(self.composite_modulus, self.poisson_ratio)


class FrictionSection(Section):
    """The section ``[friction]``."""

    makes = Friction
    shear_strength: Stress = key("sigma: friction force per real contact area", "0.358 MPa")
    area_ratio: Number = key("B: sheared over initial real contact area", 0.85, default=1.0)


class LatticeSection(Section):
    """The section ``[lattice]``."""

    shape: tuple[Integer, Integer] = key("rows, columns", [8, 8])
    pitch: Length = key("distance between neighbours", "1.5 mm")
    radius: Length | None = optional(
        "either: radius of curvature of the summits; or: radii in a section [tools]", "526 um"
    )


class ToolsSection(Section):
    """The section ``[tools]``."""

    choices = (("radii",), ("radius_range",), ("exponent_range",))

    radii: Annotated[list[PositiveLength], Field(min_length=1)] | None = optional(
        "either: radii of the available tools", ["300 um", "526 um"]
    )
    caps: Annotated[list[Annotated[str, Field(strict=True)]], Field(min_length=1)] | None = optional(
        "with radii: sphere, paraboloid or power EXPONENT COEFFICIENT of each; default: section [cap]",
        ["sphere", "power 4 0.5"],
    )
    radius_range: tuple[PositiveLength, PositiveLength] | None = optional(
        "or: smallest and largest radius", ["200 um", "800 um"]
    )
    step: PositiveLength | None = optional(
        "with radius_range: radii between are multiples of it; default: 10 um", "10 um"
    )
    exponent_range: tuple[Number, Number] | None = optional(
        "or: smallest and largest exponent of power caps of lattice.radius", [1.2, 6.0]
    )
    exponent_step: Number | None = optional(
        "with exponent_range: exponents between are multiples of it; default: 0.1", 0.1
    )
    coefficient: Number | None = optional("with exponent_range: of the power caps; default: 0.5", 0.5)

    def value(self) -> RadiusRange | PowerRange | tuple[Tool | float, ...]:
        """Return the range of radii or exponents, or the tools."""
        for name, other, words in (
            ("step", "radius_range", "tools are used as they are"),
            ("exponent_step", "exponent_range", "it is the step of exponents"),
            ("coefficient", "exponent_range", "caps state their own"),
            ("caps", "radii", "one cap for each radius"),
        ):
            alone = getattr(self, name) is not None and getattr(self, other) is None
            refuse_if(alone, f"needs tools.{other}: {words}", key=name)
        if self.exponent_range is not None:
            low, high = self.exponent_range
            words = f"must increase, from above 1 to at most {STEEPEST:g}, but is [{low:g}, {high:g}]"
            refuse_if(not 1.0 < low < high <= STEEPEST, words, key="exponent_range")
            given = {"step": self.exponent_step, "coefficient": self.coefficient}
            return PowerRange(*self.exponent_range, **{k: v for k, v in given.items() if v is not None})
        if self.radius_range is None:
            return self._listed()
        ends = (Given("radius_range", radius) for radius in self.radius_range)
        falling = self.radius_range[0] >= self.radius_range[1]
        refuse_if(falling, "must increase, but is [{.number}, {.number}]", *ends, key="radius_range")
        return RadiusRange(*self.radius_range, *(() if self.step is None else (self.step,)))

    def _listed(self) -> tuple[Tool | float, ...]:
        """Return the radii of the tools [mm], or tools if they have caps of their own."""
        radii = self.radii or []
        if self.caps is None:
            return tuple(radii)
        words = f"has {len(self.caps)} caps for {len(radii)} radii; give one for each"
        refuse_if(len(self.caps) != len(radii), words, key="caps")
        return tuple(map(Tool, radii, [self._cap(i) for i in range(len(radii))]))

    def _cap(self, i: int) -> Cap:
        assert self.caps is not None
        try:
            return cap_named(self.caps[i])
        except InvalidInput as error:
            value = f'"{printable(self.caps[i], 60)}"'
            must = error.must if error.key == "cap" else f"is no cap: {error}"
            raise InvalidInput(must, key=f"caps[{i}]", value=value) from None


class SitesSection(Section):
    """The section ``[sites]``."""

    empty: tuple[Site, ...] = key(
        "sites without an asperity, from 0 along x, then row by row along y", [17], default=()
    )
    pinned: tuple[Site, ...] = key("sites whose heights are given", [9, 12], default=())
    heights: tuple[Length, ...] = key(
        "of the summits at these sites, above the base plane", ["84 um", "120 um"], default=()
    )

    def heights_by_site(self, count: int, limits: Limits, part: bool) -> dict[int, float | None]:
        """Return the height of each pinned site [mm], or None for a site that stays empty."""
        for name, sites, before in (("empty", self.empty, ()), ("pinned", self.pinned, self.empty)):
            for i, site in enumerate(sites):
                place: dict[str, Any] = {"key": f"{name}[{i}]", "value": str(site)}
                lattice = f"is not a site: the lattice has the sites 0 to {count - 1}"
                refuse_if(site >= count, lattice, **place)
                refuse_if(site in (*before, *sites[:i]), "is given twice; keep one", **place)
        words = f"holds all {count} sites; leave out at least one"
        refuse_if(len(self.empty) == count, words, key="empty")
        many = f"has {len(self.heights)} entries and sites.pinned {len(self.pinned)}"
        words = f"{many}; give one height for each pinned site"
        refuse_if(len(self.pinned) != len(self.heights), words, key="heights")
        top = limits.offset + limits.max_height
        for i, height in enumerate(self.heights):
            place = {"key": f"heights[{i}]", "value": height}
            words = "must be at most {.number}, limits.offset + limits.max_height"
            refuse_if(height > top, words, Given("heights", top), **place)
            check.number(f"heights[{i}]", height, at_least=0.0)
            words = "must be greater than 0 in a part; list a site without an asperity in sites.empty"
            refuse_if(height == 0.0 and part, words, **place)
        return {**dict.fromkeys(self.empty), **dict(zip(self.pinned, self.heights, strict=True))}


class BlockSection(Section):
    """The section ``[block]``."""

    makes = Block
    width: Length = key("along x", "20 mm")
    length: Length = key("along y", "20 mm")
    thickness: Length = key("down to the rigid plate", "7.2 mm")


class CellSection(Section):
    """The section ``[cell]``."""

    width: PositiveLength | None = optional("along x; default: columns times pitch", "15 mm")
    length: PositiveLength | None = optional("along y; default: rows times pitch", "15 mm")


class LimitsSection(Section):
    """The section ``[limits]``."""

    makes = Limits
    max_height: Length = key("of the summits, above the offset", "120 um")
    min_height: Length = key("of the summits, above the offset", "10 um", default=0.0)
    offset: Length = key("added to all heights", "84 um", default=0.0)
    height_step: Length | None = optional(
        "distance between levels, the middles of steps from the lowest height; default: any height", "6 um"
    )
    height_sd: Length | None = optional("standard deviation of the manufactured heights", "0.9 um")


class LayoutSection(Section):
    """The section ``[layout]``."""

    seed: Annotated[int, Field(strict=True, ge=0)] = key(
        "of the random assignment of heights to sites", 0, default=0
    )
    tilt: Angle | None = optional("exchange heights to reduce the effect of a tilt of this angle", "0.1 deg")


class ModelSection(Section):
    """The section ``[model]``."""

    kind: Annotated[str, one_of(MODELS)] = key(f"one of: {', '.join(MODELS)}", "layer", default="independent")

    @field_validator("kind")
    @classmethod
    def _known(cls, kind: str) -> str:
        if kind not in MODELS:
            raise InvalidInput(f"is unknown{suggestion(kind, MODELS)}", value=f'"{printable(kind, 60)}"')
        return kind


class PartSection(Section):
    """The section ``[part]``."""

    makes = PartOptions
    alignment_height: PositiveLength | None = optional(
        "of four alignment asperities outside the corners; cut them off after use", "400 um"
    )
    chord_error: PositiveLength | None = optional(
        "largest distance of the mesh from the caps; default: 4e-4 R, at most 2 million triangles", "1 um"
    )


class ChecksSection(Section):
    """The section ``[checks]``."""

    hardness: PositiveStress | None = optional("H, which decides on a plastic law", "10 MPa")
