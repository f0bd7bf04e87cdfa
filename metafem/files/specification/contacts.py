"""The sections ``[cap]`` and ``[contact]``: a pydantic model for each kind of cap and of contact law."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from metafem.caps import Cap, Paraboloid, Power, Profile, Sphere
from metafem.contact import (
    JKR,
    Contact,
    Elastic,
    Hertz,
    JacksonGreen,
    KogutEtsion,
    TabulatedContact,
)
from metafem.files.specification.fields import (
    Area,
    Energy,
    Force,
    Length,
    Number,
    Section,
    Stress,
    key,
    optional,
)


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
