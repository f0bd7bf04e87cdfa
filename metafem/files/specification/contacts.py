"""``[contact]`` of each kind, as pydantic models."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from metafem.contact import (
    JKR,
    AxisymmetricCap,
    Contact,
    Hertz,
    JacksonGreen,
    KogutEtsion,
    PowerCap,
    SphericalCap,
    TabulatedContact,
)
from metafem.errors import InvalidInput
from metafem.files.specification.fields import Area, Force, Length, Number, Section, measured, says


class HertzSection(Section):
    """Elastic paraboloids."""

    kind: Literal["hertz"]

    def law(self) -> Contact:
        """Return the law of these keys."""
        return Hertz()


class SphereSection(Section):
    """Elastic spheres."""

    kind: Literal["sphere"]

    def law(self) -> Contact:
        """Return the law of these keys."""
        return SphericalCap()


class PowerCapSection(Section):
    """Elastic caps with the profile f = coefficient R (rho/R)^exponent."""

    kind: Literal["power"]
    exponent: Annotated[Number, says("from 1 to 32; 2 is a paraboloid", 4.0)]
    coefficient: Annotated[Number, says("greater than 0", 0.5)] = 0.5

    def law(self) -> Contact:
        """Return the law of these keys."""
        return PowerCap(self.exponent, self.coefficient)


class ProfileSection(Section):
    """Elastic caps with the profile f(rho) of a table, whatever their radius.

    A `file` is replaced by its content before the section is read.
    """

    kind: Literal["profile"]
    choices = (("rho", "f"), ("file",))
    rho: Annotated[
        list[Length] | None,
        says("either: distances from the axis, from 0", ["0 um", "200 um", "400 um", "600 um"]),
    ] = None
    f: Annotated[
        list[Length] | None,
        says("with it: depths below the summit, from 0", ["0 um", "39 um", "184 um", "600 um"]),
    ] = None
    file: Annotated[str | None, says("or: a table with columns such as rho_mm,f_um", "cap.csv")] = None

    @model_validator(mode="after")
    def _pairs(self) -> Self:
        if self.rho is None or self.f is None:
            raise InvalidInput("needs rho and f, or file")
        if len(self.rho) != len(self.f):
            raise InvalidInput(
                f"has {len(self.rho)} entries of rho and {len(self.f)} of f; give as many of both"
            )
        return self

    def law(self) -> Contact:
        """Return the law of these keys."""
        return AxisymmetricCap(np.array([self.rho, self.f]))


CapSection = HertzSection | SphereSection | PowerCapSection | ProfileSection


class JKRSection(Section):
    """Elastic caps with adhesion, by the theory of Johnson, Kendall and Roberts."""

    kind: Literal["jkr"]
    adhesion_energy: Annotated[float, measured("N/mm"), says("w, from 0", "9 mJ/m^2")]
    cap: Annotated[
        CapSection,
        Field(discriminator="kind"),
        says("one of the kinds above, with its keys", {"kind": "sphere"}),
    ] = HertzSection(kind="hertz")

    def law(self) -> Contact:
        """Return the law of these keys."""
        return JKR(self.adhesion_energy, self.cap.law())


class KogutEtsionSection(Section):
    """Elastic-plastic spheres, by the formulas of Kogut and Etsion."""

    kind: Literal["kogut-etsion"]
    hardness: Annotated[float, measured("MPa", "10 MPa"), says("H of the softer material", "10 MPa")]

    def law(self) -> Contact:
        """Return the law of these keys."""
        return KogutEtsion(self.hardness)


class JacksonGreenSection(Section):
    """Elastic-plastic spheres, by the formulas of Jackson and Green."""

    kind: Literal["jackson-green"]
    yield_strength: Annotated[float, measured("MPa", "4 MPa"), says("of the softer material", "4 MPa")]

    def law(self) -> Contact:
        """Return the law of these keys."""
        return JacksonGreen(self.yield_strength)


class TabulatedSection(Section):
    """A table of load and area over the indentation of one asperity, whatever its radius.

    A `file` is replaced by its content before the section is read.
    """

    kind: Literal["tabulated"]
    choices = (("indentation", "load", "area"), ("file",))
    indentation: Annotated[list[Length] | None, says("either: d, increasing", ["5 um", "20 um", "90 um"])] = (
        None
    )
    load: Annotated[list[Force] | None, says("with it: P at these", ["0.46 mN", "3.7 mN", "35 mN"])] = None
    area: Annotated[
        list[Area] | None, says("with it: A at these", ["0.0083 mm^2", "0.033 mm^2", "0.15 mm^2"])
    ] = None
    file: Annotated[
        str | None, says("or: a table with columns such as indentation_um,load_mN,area_mm2", "contact.csv")
    ] = None

    @model_validator(mode="after")
    def _all(self) -> Self:
        if self.indentation is None or self.load is None or self.area is None:
            raise InvalidInput("needs indentation, load and area, or file")
        count = {len(self.indentation), len(self.load), len(self.area)}
        if len(count) > 1:
            raise InvalidInput(
                f"has {sorted(count)} entries of indentation, load and area; give as many of all"
            )
        return self

    def law(self) -> Contact:
        """Return the law of these keys."""
        return TabulatedContact(self.indentation or [], self.load or [], self.area or [])


ContactSection = Annotated[
    CapSection | JKRSection | KogutEtsionSection | JacksonGreenSection | TabulatedSection,
    Field(discriminator="kind"),
]
