"""All sections of a specification, as pydantic models with the types and meanings of their keys."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, cast

from pydantic import Field

from metafem.caps import Paraboloid, Power, Profile, Sphere
from metafem.contact import JKR, Elastic, Hertz, JacksonGreen, KogutEtsion, TabulatedContact
from metafem.errors import InvalidInput, refuse_if
from metafem.files.part import DWELL, FEED, SAFE, SPINDLE, PartOptions
from metafem.files.specification.fields import (
    Angle,
    Area,
    Energy,
    Feed,
    Force,
    Length,
    Number,
    PositiveLength,
    Section,
    Speed,
    Stress,
    Time,
    key,
    one_of,
    optional,
)
from metafem.files.specification.models import AUTOMATIC, MODELS
from metafem.files.specification.targets import AnyTarget
from metafem.files.summits import cap_named
from metafem.inversion import Limits, PowerRange, RadiusRange, Tool
from metafem.surface import Block, Friction, Material

TWO, SOME = Field(min_length=2, max_length=2), Field(min_length=1)
Radii = Annotated[list[PositiveLength], SOME]
Caps = Annotated[list[Annotated[str, Field(strict=True)]], SOME]
Ends = Annotated[list[PositiveLength], TWO]
Powers = Annotated[list[Annotated[Number, Field(gt=1.0)]], TWO]

Site = Annotated[int, Field(strict=True, ge=0)]
Sites = tuple[Annotated[int, Field(strict=True, ge=1)], ...]


class MaterialSection(Section):
    """The section ``[material]``."""

    choices = (("composite_modulus",), ("young_modulus",))
    composite_modulus: Stress | None = optional("either: E* = E/(1 - nu^2)", "1.36 MPa")
    young_modulus: Stress | None = optional("or: E, Young's modulus", "1.02 MPa")
    poisson_ratio: Number = key("nu", 0.5, default=0.5, ge=0.0, le=0.5)

    def value(self) -> Material:
        """Return the material."""
        if self.composite_modulus is None:
            return Material.from_young(self.young_modulus or 0.0, self.poisson_ratio)
        return Material(self.composite_modulus, self.poisson_ratio)


class FrictionSection(Section):
    """The section ``[friction]``."""

    makes = Friction
    shear_strength: Stress = key("sigma: friction force per real contact area", "0.358 MPa")
    area_ratio: Number = key("B: sheared over initial real contact area", 0.85, default=1.0, gt=0.0)


class LatticeSection(Section):
    """The section ``[lattice]``."""

    shape: Annotated[list[Annotated[int, Field(strict=True, ge=1)]], TWO] = key("rows, columns", [8, 8])
    pitch: PositiveLength = key("distance between neighbours", "1.5 mm")
    radius: PositiveLength | None = optional("either: radius of curvature; or: radii in [tools]", "526 um")


class ToolsSection(Section):
    """The section ``[tools]``."""

    choices = (("radii",), ("radius_range",), ("exponent_range",))
    radii: Radii | None = optional("either: radii of the available tools", ["300 um", "526 um"])
    caps: Caps | None = optional("with radii: of each; default: section [cap]", ["sphere", "power 4 0.5"])
    radius_range: Ends | None = optional("or: smallest and largest radius", ["200 um", "800 um"])
    step: PositiveLength | None = optional("with radius_range: radii are its multiples", "10 um")
    exponent_range: Powers | None = optional("or: exponents of power caps of lattice.radius", [1.2, 6.0])
    exponent_step: Number | None = optional("with exponent_range: multiples; default: 0.1", 0.1, gt=0.0)
    coefficient: Number | None = optional("with exponent_range: of the power caps; default: 0.5", 0.5, gt=0.0)

    def value(self) -> RadiusRange | PowerRange | tuple[Tool | float, ...]:
        """Return the range of radii or exponents, or the tools or their radii [mm]."""
        of = {"step": "radius_range", "exponent_step": "exponent_range", "coefficient": "exponent_range"}
        for name, other in (of | {"caps": "radii"}).items():
            alone = getattr(self, name) is not None and getattr(self, other) is None
            refuse_if(alone, f"needs tools.{other}", key=name)
        for name, kind in (("radius_range", RadiusRange), ("exponent_range", PowerRange)):
            given = self.given()
            if name in given:
                ends = given.pop(name)
                options = {key.removeprefix("exponent_"): value for key, value in given.items()}
                found: RadiusRange | PowerRange = _of_key(name, kind, *ends, **options)
                return found
        radii, caps = self.radii or [], self.caps
        if caps is None:
            return tuple(radii)
        words = f"has {len(caps)} caps for {len(radii)} radii; give one for each"
        refuse_if(len(caps) != len(radii), words, key="caps")
        known = [_of_key(f"caps[{i}]", cap_named, text) for i, text in enumerate(caps)]
        return tuple(map(Tool, radii, known))


def _of_key(key: str, make: Callable[..., Any], *given: Any, **options: Any) -> Any:
    """Return what `make` returns; its errors are errors of the whole value of a key."""
    try:
        return make(*given, **options)
    except InvalidInput as error:
        raise InvalidInput(f"cannot be used: {error}", key=key) from None


class SitesSection(Section):
    """The section ``[sites]``."""

    empty: Sites = key("sites without an asperity, from 1 along x, then along y", [17], default=())
    pinned: Sites = key("sites whose heights are given", [9, 12], default=())
    heights: tuple[Length, ...] = key("of these, above the base plane", ["84 um", "120 um"], default=())

    def value(self) -> dict[int, float | None]:
        """Return the height of each pinned site [mm], None for an empty one, by its number from 0."""
        seen: set[int] = set()
        for i, site in enumerate((*self.empty, *self.pinned)):
            key = "empty" if i < len(self.empty) else "pinned"
            refuse_if(site in seen, f"gives site {site} twice; keep one", key=key)
            seen.add(site)
        many = f"has {len(self.heights)} entries and sites.pinned {len(self.pinned)}"
        wrong = len(self.pinned) != len(self.heights)
        refuse_if(wrong, f"{many}; give one height for each pinned site", key="heights")
        given = {**dict.fromkeys(self.empty), **dict(zip(self.pinned, self.heights, strict=True))}
        return {site - 1: height for site, height in given.items()}


class BlockSection(Section):
    """The section ``[block]``."""

    makes = Block
    width: PositiveLength = key("along x", "20 mm")
    length: PositiveLength = key("along y", "20 mm")
    thickness: PositiveLength = key("down to the rigid plate", "7.2 mm")


class CellSection(Section):
    """The section ``[cell]``."""

    width: PositiveLength | None = optional("along x; default: columns times pitch", "15 mm")
    length: PositiveLength | None = optional("along y; default: rows times pitch", "15 mm")


class LimitsSection(Section):
    """The section ``[limits]``."""

    makes = Limits
    max_height: PositiveLength = key("of the summits, above the offset", "120 um")
    min_height: Length = key("of the summits, above the offset", "10 um", default=0.0)
    offset: Length = key("added to all heights", "84 um", default=0.0)
    height_step: PositiveLength | None = optional("distance between levels; default: any height", "6 um")
    height_sd: Length | None = optional("standard deviation of the manufactured heights", "0.9 um")


class LayoutSection(Section):
    """The section ``[layout]``."""

    seed: Site = key("of the random assignment of heights to sites", 0, default=0)
    tilt: Angle | None = optional("exchange heights to reduce the effect of a tilt of this angle", "0.1 deg")


class ModelSection(Section):
    """The section ``[model]``."""

    kind: one_of(*MODELS) = key(  # type: ignore[valid-type]
        f"one of: {', '.join(MODELS)}", "layer", default=AUTOMATIC
    )


class PartSection(Section):
    """The section ``[part]``."""

    makes = PartOptions
    alignment_height: PositiveLength | None = optional("of four asperities to cut off after use", "400 um")
    chord_error: PositiveLength | None = optional("of the mesh below the caps; default: 4e-4 R", "1 um")
    feed: Feed = key("of the plunge, in mould.gcode", "20 mm/min", default=FEED)
    spindle: Speed = key("in mould.gcode", "8000 1/min", default=SPINDLE)
    dwell: Time = key("at the bottom of each hole, in mould.gcode", "0.5 s", default=DWELL)
    safe_height: PositiveLength = key("of the tool above the mould, in mould.gcode", "5 mm", default=SAFE)


class ChecksSection(Section):
    """The section ``[checks]``."""

    hardness: Stress | None = optional("H, which decides on a plastic law", "10 MPa")


RHO, DEPTHS = ["0 um", "200 um", "400 um", "600 um"], ["0 um", "39 um", "184 um", "600 um"]


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
    exponent: Number = key("2 is a paraboloid", 4.0, gt=1.0, le=32.0)
    coefficient: Number = key("of the profile", 0.5, default=0.5, gt=0.0)


class ProfileCap(Section):
    """Caps with one profile f(rho) from a table.

    Before the section is read, the columns of the table replace the key `file`.
    """

    makes = staticmethod(lambda rho, f: Profile(cast(Any, [rho, f])))
    kind: Literal["profile"]
    choices = (("rho", "f"), ("file",))
    rho: list[Length] | None = optional("either: distances from the axis, from 0", RHO)
    f: list[Length] | None = optional("with it: depths below the summit, from 0", DEPTHS)
    file: str | None = optional("or: a table with columns such as rho_mm,f_um", "cap.csv")


class HertzSection(Section):
    """Elastic paraboloids with the curvature of each summit."""

    makes = Hertz
    kind: Literal["hertz"]


class ElasticSection(Section):
    """Elastic caps of the shape in the section [cap]."""

    makes = Elastic
    kind: Literal["elastic"]


CapSection = HertzSection | ElasticSection
Under = Annotated[CapSection, Field(discriminator="kind")]
HERTZ = HertzSection(kind="hertz")


class JKRSection(Section):
    """Elastic caps with adhesion, from the theory of Johnson, Kendall and Roberts."""

    makes = JKR
    kind: Literal["jkr"]
    adhesion_energy: Energy = key("w", "9 mJ/m^2")
    cap: Under = key("one of the kinds above", {"kind": "elastic"}, default=HERTZ)


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
    file: str | None = optional("or: a table such as indentation_um,load_mN,area_mm2", "contact.csv")


ShapeSection = Annotated[SphereCap | ParaboloidCap | PowerLawCap | ProfileCap, Field(discriminator="kind")]
ContactSection = Annotated[
    CapSection | JKRSection | KogutEtsionSection | JacksonGreenSection | TabulatedSection,
    Field(discriminator="kind"),
]


class Sections(Section):
    """All sections of a specification."""

    target: AnyTarget = key("the target friction law, of one of these kinds")
    material: MaterialSection = key("the elastomer")
    friction: FrictionSection | None = optional("needed for friction forces in N")
    lattice: LatticeSection = key("sites of asperities")
    sites: SitesSection = key("empty sites, and sites with given heights", default=SitesSection())
    tools: ToolsSection | None = optional("to choose from, instead of lattice.radius")
    block: BlockSection | None = optional("needed for the part files and the models layer and block")
    cell: CellSection | None = optional("period of an infinite surface; default: no repetition")
    limits: LimitsSection = key("manufacturing limits")
    layout: LayoutSection = key("assignment of heights to sites", default=LayoutSection())
    model: ModelSection = key("model under which the target is to be met", default=ModelSection())
    cap: ShapeSection | None = optional("shape of the caps, of one of these kinds; default: spheres")
    contact: ContactSection = key("law of one contact, of one of these kinds; default: hertz", default=HERTZ)
    part: PartSection = key("options of the part files", default=PartSection())
    checks: ChecksSection = key("further checks", default=ChecksSection())
