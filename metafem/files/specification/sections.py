"""Sections of a specification but [target], as pydantic models with the types and meanings of their keys."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from metafem import _validate as check
from metafem._given import printable
from metafem.caps import Cap, Paraboloid, Power, Profile, Sphere
from metafem.caps.shapes import STEEPEST
from metafem.contact import JKR, Contact, Elastic, Hertz, JacksonGreen, KogutEtsion, TabulatedContact
from metafem.errors import InvalidInput, refuse_if
from metafem.files.caps import cap_named
from metafem.files.part.mould import DWELL, FEED, SAFE, SPINDLE
from metafem.files.part.plan import PartOptions
from metafem.files.specification.fields import (
    Angle,
    Area,
    Energy,
    Feed,
    Force,
    Length,
    Number,
    PositiveLength,
    PositiveStress,
    Section,
    Speed,
    Stress,
    Time,
    key,
    one_of,
    optional,
)
from metafem.files.specification.models import AUTOMATIC, MODELS, suggestion
from metafem.inversion import Limits, PowerRange, RadiusRange, Tool
from metafem.surface import Block, Friction, Material

Integer = Annotated[int, Field(strict=True)]
Site = Annotated[int, Field(strict=True, ge=0)]
TWO = Field(min_length=2, max_length=2)


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

    shape: Annotated[list[Integer], TWO] = key("rows, columns", [8, 8])
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
    radius_range: Annotated[list[PositiveLength], TWO] | None = optional(
        "or: smallest and largest radius", ["200 um", "800 um"]
    )
    step: PositiveLength | None = optional(
        "with radius_range: radii between are multiples of it; default: 10 um", "10 um"
    )
    exponent_range: Annotated[list[Number], TWO] | None = optional(
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
        low, high = self.radius_range
        words = f"must increase, but is [{low:g} mm, {high:g} mm]"
        refuse_if(low >= high, words, key="radius_range")
        return RadiusRange(*self.radius_range, *(() if self.step is None else (self.step,)))

    def _listed(self) -> tuple[Tool | float, ...]:
        """Return the radii of the tools [mm], or tools if they have caps of their own."""
        radii, tools = self.radii or [], []
        if self.caps is None:
            return tuple(radii)
        words = f"has {len(self.caps)} caps for {len(radii)} radii; give one for each"
        refuse_if(len(self.caps) != len(radii), words, key="caps")
        for i, (radius, text) in enumerate(zip(radii, self.caps, strict=True)):
            try:
                tools.append(Tool(radius, cap_named(text)))
            except InvalidInput as error:
                raise InvalidInput(f"is no cap: {error}", key=f"caps[{i}]", value=f'"{text}"') from None
        return tuple(tools)


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
        for i, height in enumerate(self.heights):
            place = {"key": f"heights[{i}]", "value": height}
            words = f"must be at most {limits.top:g} mm, limits.offset + limits.max_height"
            refuse_if(height > limits.top, words, **place)
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

    kind: Annotated[str, one_of(MODELS)] = key(f"one of: {', '.join(MODELS)}", "layer", default=AUTOMATIC)

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
    feed: Feed = key("of the plunge, in mould.gcode", "20 mm/min", default=FEED)
    spindle: Speed = key("in mould.gcode", "8000 1/min", default=SPINDLE)
    dwell: Time = key("at the bottom of each hole, in mould.gcode", "0.5 s", default=DWELL)
    safe_height: PositiveLength = key("of the tool above the mould, in mould.gcode", "5 mm", default=SAFE)


class ChecksSection(Section):
    """The section ``[checks]``."""

    hardness: PositiveStress | None = optional("H, which decides on a plastic law", "10 MPa")


class SphereCap(Section):
    """Spheres."""

    makes = Sphere
    kind: Literal["sphere"]


class ParaboloidCap(Section):
    """Paraboloids."""

    makes = Paraboloid
    kind: Literal["paraboloid"]


class PowerLawCap(Section):
    """Caps with the profile f = coefficient R (rho/R)^exponent."""

    makes = Power
    kind: Literal["power"]
    exponent: Number = key("greater than 1, at most 32; 2 is a paraboloid", 4.0)
    coefficient: Number = key("greater than 0", 0.5, default=0.5)


class ProfileCap(Section):
    """Caps with one profile f(rho) from a table.

    Before the section is read, the columns of the table replace the key `file`.
    """

    kind: Literal["profile"]
    choices = (("rho", "f"), ("file",))
    rho: list[Length] | None = optional(
        "either: distances from the axis, from 0", ["0 um", "200 um", "400 um", "600 um"]
    )
    f: list[Length] | None = optional(
        "with it: depths below the summit, from 0", ["0 um", "39 um", "184 um", "600 um"]
    )
    file: str | None = optional("or: a table with columns such as rho_mm,f_um", "cap.csv")

    def value(self) -> Cap:
        """Return the cap that the keys describe."""
        profile: Any = [self.rho, self.f]
        return Profile(profile)


ShapeSection = Annotated[
    SphereCap | ParaboloidCap | PowerLawCap | ProfileCap,
    Field(discriminator="kind"),
]


class HertzSection(Section):
    """Elastic paraboloids with the curvature of each summit."""

    makes = Hertz
    kind: Literal["hertz"]


class ElasticSection(Section):
    """Elastic caps of the shape in the section [cap]."""

    makes = Elastic
    kind: Literal["elastic"]


CapSection = HertzSection | ElasticSection


class JKRSection(Section):
    """Elastic caps with adhesion, from the theory of Johnson, Kendall and Roberts."""

    kind: Literal["jkr"]
    adhesion_energy: Energy = key("w, from 0", "9 mJ/m^2")
    cap: Annotated[CapSection, Field(discriminator="kind")] = key(
        "one of the kinds above", {"kind": "elastic"}, default=HertzSection(kind="hertz")
    )

    def value(self) -> Contact:
        """Return the contact law that the keys describe."""
        return JKR(self.adhesion_energy, self.cap.value())


class KogutEtsionSection(Section):
    """Elastic-plastic spheres, from the formulas of Kogut and Etsion."""

    makes = KogutEtsion
    kind: Literal["kogut-etsion"]
    hardness: Stress = key("H of the softer material", "10 MPa")


class JacksonGreenSection(Section):
    """Elastic-plastic spheres, from the formulas of Jackson and Green."""

    makes = JacksonGreen
    kind: Literal["jackson-green"]
    yield_strength: Stress = key("of the softer material", "4 MPa")


class TabulatedSection(Section):
    """Load and area of one asperity of any radius, from a table over its indentation.

    Before the section is read, the columns of the table replace the key `file`.
    """

    makes = TabulatedContact
    kind: Literal["tabulated"]
    choices = (("indentation", "load", "area"), ("file",))
    indentation: list[Length] | None = optional("either: d, increasing", ["5 um", "20 um", "90 um"])
    load: list[Force] | None = optional("with it: P at these", ["0.46 mN", "3.7 mN", "35 mN"])
    area: list[Area] | None = optional("with it: A at these", ["0.0083 mm^2", "0.033 mm^2", "0.15 mm^2"])
    file: str | None = optional(
        "or: a table with columns such as indentation_um,load_mN,area_mm2", "contact.csv"
    )


ContactSection = Annotated[
    CapSection | JKRSection | KogutEtsionSection | JacksonGreenSection | TabulatedSection,
    Field(discriminator="kind"),
]
