"""The sections of a specification but its target, as pydantic models, and the types of their keys."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, Self, Union

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    WithJsonSchema,
    create_model,
)
from pydantic import model_validator as validator

import metafem as mf
from metafem.errors import refuse_if
from metafem.files.disk import RECORD
from metafem.files.specification import AUTOMATIC, MODELS
from metafem.files.units import UNITS, converted, pattern

# Largest number of sites, whose record can be read: that of a site has 250 bytes.
SITES = RECORD // 250

# Bounds of values by their names in pydantic: the name in a JSON schema, and words.
BOUNDS = {
    "gt": ("exclusiveMinimum", "greater than"),
    "ge": ("minimum", "at least"),
    "lt": ("exclusiveMaximum", "less than"),
    "le": ("maximum", "at most"),
}

# Alternative sets of keys, of which one must be present.
Choices = tuple[tuple[str, ...], ...]


def _with_choices(schema: dict[str, Any], section: Any) -> None:
    """Add the alternative sets of keys to a JSON schema, for `section_forms`."""
    schema["x-choices"] = [list(choice) for choice in section.choices]


class Section(BaseModel):
    """A section, which refuses unknown keys; `makes` is called with its keys to build its value.

    Exactly one of the sets of keys in `choices` must be present. The columns of the table that a key `file`
    names replace this key before the section is read.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, json_schema_extra=_with_choices)
    choices: ClassVar[Choices] = ()
    makes: ClassVar[Callable[..., Any] | None] = None

    @validator(mode="before")
    @classmethod
    def _with_columns(cls, given: Any, info: ValidationInfo) -> Any:
        """Return the section with the columns, which the function in the context of pydantic reads."""
        named = "file" in cls.model_fields and isinstance(given, dict) and isinstance(given.get("file"), str)
        if not named or info.context is None:
            return given
        columns = info.context(given["file"], given["kind"])
        twice = ", ".join(sorted(given.keys() & columns.keys()))
        refuse_if(twice, f"and {twice} both give the points; keep one", key="file")
        return {**given, "file": None, **{name: list(column) for name, column in columns.items()}}

    @validator(mode="after")
    def _valid(self) -> Any:
        """Return the value of the section, as which it is read."""
        given = [key for key in dict.fromkeys(sum(self.choices, ())) if getattr(self, key) is not None]
        has = f"has {' and '.join(given)}; it " if given else ""
        needs = f"{has}needs either {' or '.join(map(' and '.join, self.choices))}"
        refuse_if(self.choices and set(given) not in map(set, self.choices), needs)
        return self.value()

    def value(self) -> Any:
        """Return what the section describes, or the section itself."""
        return self if self.makes is None else type(self).makes(**self.given())  # type: ignore[misc]

    def given(self) -> dict[str, Any]:
        """Return the values of the keys that have one, but those of the section itself."""
        return {name: value for name, value in self if value is not None and name not in ("kind", "file")}


def key(meaning: str, example: Any = None, *, default: Any = ..., **bounds: Any) -> Any:
    """Return the field of a key with its meaning, an example and bounds; it is required without a default."""
    return Field(default, description=meaning, examples=None if example is None else [example], **bounds)


def optional(meaning: str, example: Any = None, **bounds: float) -> Any:
    """Return the field of a key that may be omitted, with its meaning, an example and bounds."""
    return key(meaning, example, default=None, **bounds)


def text_schema(*units: str) -> dict[str, Any]:
    """Return the JSON schema of a text that states a quantity in one of these dimensions."""
    shown = [name for unit in units for name in UNITS[unit] if name != "°"]
    return {"type": "string", "pattern": pattern(units), "x-units": shown}


def measured(unit: str, **bounds: float) -> Any:
    """Return the type of a text such as "120 um", whose value is a number in `unit` within the bounds."""

    def number(given: Any) -> float:
        """Return the number of a text; an entry of a table is one already."""
        return float(given) if isinstance(given, np.float64) else converted(given, unit)

    stated = {BOUNDS[name][0]: bound for name, bound in bounds.items()}
    schema: dict[str, Any] = text_schema(unit) | {"x-unit": unit} | stated
    known: Any = bounds
    return Annotated[float, Field(**known), BeforeValidator(number), WithJsonSchema(schema)]


Name: Any = Literal[tuple(MODELS)]
Area: Any = measured("mm^2")
Force: Any = measured("N")
Length: Any = measured("mm", ge=0.0)
PositiveLength: Any = measured("mm", gt=0.0)
Stress: Any = measured("MPa", gt=0.0)
Energy: Any = measured("N/mm", ge=0.0)
Angle: Any = measured("rad")
Feed: Any = measured("mm/min", gt=0.0)
Speed: Any = measured("1/min", gt=0.0)
Time: Any = measured("s", ge=0.0)
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0.0)]

TWO, SOME = Field(min_length=2, max_length=2), Field(min_length=1)
Radii = Annotated[list[PositiveLength], SOME]
Ends = Annotated[list[PositiveLength], TWO]

Site = Annotated[int, Field(strict=True, ge=0)]
Sites = tuple[Annotated[int, Field(strict=True, ge=1)], ...]


class MaterialSection(Section):
    """The section ``[material]``."""

    choices = (("composite_modulus",), ("young_modulus",))
    composite_modulus: Stress | None = optional("either: E* = E/(1 - nu^2)", "1.36 MPa")
    young_modulus: Stress | None = optional("or: E, Young's modulus", "1.02 MPa")
    poisson_ratio: Number = key("nu", 0.5, default=0.5, ge=0.0, le=0.5)

    def value(self) -> mf.Material:
        """Return the material."""
        if self.composite_modulus is None:
            return mf.Material.from_young(self.young_modulus or 0.0, self.poisson_ratio)
        return mf.Material(self.composite_modulus, self.poisson_ratio)


class FrictionSection(Section):
    """The section ``[friction]``."""

    makes = mf.Friction
    shear_strength: Stress = key("sigma: friction force per real contact area", "0.358 MPa")
    area_ratio: Number = key("B: sheared over initial real contact area", 0.85, default=1.0, gt=0.0)


class LatticeSection(Section):
    """The section ``[lattice]``."""

    shape: Annotated[list[Annotated[int, Field(strict=True, ge=1)]], TWO] = key("rows, columns", [8, 8])
    pitch: PositiveLength = key("distance between neighbours", "1.5 mm")
    radius: PositiveLength | None = optional("either: radius of curvature; or: radii in [tools]", "526 um")

    def value(self) -> Self:
        """Refuse more sites than the record of a result can hold."""
        count, words = self.shape[0] * self.shape[1], "are allowed, so that the result can be read"
        refuse_if(count > SITES, f"has {count:,} sites; at most {SITES:,} {words}", key="shape")
        return self


class ToolsSection(Section):
    """The section ``[tools]``."""

    choices = (("radii",), ("radius_range",))
    radii: Radii | None = optional("either: radii of the available tools", ["300 um", "526 um"])
    radius_range: Ends | None = optional("or: smallest and largest radius", ["200 um", "800 um"])
    step: PositiveLength | None = optional("with radius_range: radii are its multiples", "10 um")

    def value(self) -> mf.RadiusRange | tuple[float, ...]:
        """Return the radii [mm] or their range."""
        refuse_if(self.radii and self.step, "needs tools.radius_range", key="step")
        if self.radius_range is None:
            return tuple(self.radii or ())
        low, high = self.radius_range
        refuse_if(low >= high, "must increase", key="radius_range", value=low)
        return mf.RadiusRange(low, high, self.step)


class SitesSection(Section):
    """The section ``[sites]``."""

    empty: Sites = key("sites without an asperity, from 1 along x, then along y", [17], default=())
    pinned: Sites = key("sites whose heights are given", [9, 12], default=())
    heights: tuple[Length, ...] = key("of these, above the base plane", ["84 um", "120 um"], default=())

    def value(self) -> dict[int, float | None]:
        """Return the height of each pinned site [mm], None for an empty one, by its number from 0."""
        for site, count in Counter([*self.empty, *self.pinned]).items():
            key = "pinned" if site in self.pinned else "empty"
            refuse_if(count > 1, f"gives site {site} twice; keep one", key=key)
        many = f"has {len(self.heights)} entries and sites.pinned {len(self.pinned)}"
        wrong = len(self.pinned) != len(self.heights)
        refuse_if(wrong, f"{many}; give one height for each pinned site", key="heights")
        given = {**dict.fromkeys(self.empty), **dict(zip(self.pinned, self.heights, strict=True))}
        return {site - 1: height for site, height in given.items()}


class BlockSection(Section):
    """The section ``[block]``."""

    makes = mf.Block
    width: PositiveLength = key("along x", "20 mm")
    length: PositiveLength = key("along y", "20 mm")
    thickness: PositiveLength = key("down to the rigid plate", "7.2 mm")


class CellSection(Section):
    """The section ``[cell]``."""

    width: PositiveLength | None = optional("along x; default: columns times pitch", "15 mm")
    length: PositiveLength | None = optional("along y; default: rows times pitch", "15 mm")


class LimitsSection(Section):
    """The section ``[limits]``."""

    makes = mf.Limits
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

    kind: Name = key(f"one of: {', '.join(MODELS)}", "layer", default=AUTOMATIC)


class PartSection(Section):
    """The section ``[part]``: options of the files to make a part.

    The chord error is the largest depth of the faces of the mesh below the true caps [mm]. It acts like an
    error of the height: at a given separation, the contact area of an asperity changes by at most ``pi R``
    times the chord error. Most of this change equals that of a common shift of all caps, which does not
    affect A0(P). By default it is larger where a solid would have over about two million triangles. The
    defaults of the drilling program are for small carbide ball-end mills in aluminium or brass.
    """

    alignment_height: PositiveLength | None = optional("of four asperities to cut off after use", "400 um")
    chord_error: PositiveLength | None = optional("of the mesh below the caps; default: 4e-4 R", "1 um")
    feed: Feed = key("of the plunge, in mould.gcode", "20 mm/min", default=20.0)
    spindle: Speed = key("in mould.gcode", "8000 1/min", default=8000.0)
    dwell: Time = key("at the bottom of each hole, in mould.gcode", "0.5 s", default=0.5)
    safe_height: PositiveLength = key("of the tool above the mould, in mould.gcode", "5 mm", default=5.0)


class ChecksSection(Section):
    """The section ``[checks]``."""

    hardness: Stress | None = optional("H, which decides on a plastic law", "10 MPa")


def kind(name: str, makes: Callable[..., Any], choices: Choices = (), **keys: tuple[Any, Any]) -> Any:
    """Return the section of one kind, from the types and fields of its keys; `makes` describes it."""
    words = (makes.__doc__ or "").splitlines()[0].replace("`", "")
    fields: Any = {"kind": (Literal[name], ...), **keys}
    found = create_model(makes.__name__, __base__=Section, __doc__=words, **fields)
    found.makes, found.choices = makes, choices
    return found


def one_of(*kinds: Any) -> Any:
    """Return the type of a section of one of these kinds."""
    return Annotated[Union[kinds], Field(discriminator="kind")]  # noqa: UP007


def profile(**columns: Any) -> mf.Profile:
    """Caps with one profile f(rho) from a table."""
    return mf.Profile(np.array([*columns.values()]))


RHO, DEPTHS = ["0 um", "200 um", "400 um", "600 um"], ["0 um", "39 um", "184 um", "600 um"]
INDENTATIONS, FORCES = ["5 um", "20 um", "90 um"], ["0.46 mN", "3.7 mN", "35 mN"]
AREAS = ["0.0083 mm^2", "0.033 mm^2", "0.15 mm^2"]

AnyCap: Any = one_of(
    kind("sphere", mf.Sphere),
    kind("paraboloid", mf.Paraboloid),
    kind(
        "power",
        mf.Power,
        exponent=(Number, key("n; 2 is a paraboloid", 4.0, gt=1.0, le=32.0)),
        coefficient=(Number, key("c", 0.5, default=0.5, gt=0.0)),
    ),
    kind(
        "profile",
        profile,
        (("rho", "f"), ("file",)),
        rho=(list[Length] | None, optional("either: distances from the axis, from 0", RHO)),
        f=(list[Length] | None, optional("with it: depths below the summit, from 0", DEPTHS)),
        file=(str | None, optional("or: a table with columns such as rho_mm,f_um", "cap.csv")),
    ),
)

Hertz, Elastic = kind("hertz", mf.Hertz), kind("elastic", mf.Elastic)
ELASTIC = {"kind": "elastic"}
AnyContact: Any = one_of(
    Hertz,
    Elastic,
    kind(
        "jkr",
        mf.JKR,
        adhesion_energy=(Energy, key("w", "9 mJ/m^2")),
        cap=(
            one_of(Hertz, Elastic),
            key("one of the kinds above", ELASTIC, default=mf.Hertz()),
        ),
    ),
    kind("kogut-etsion", mf.KogutEtsion, hardness=(Stress, key("H of the softer material", "10 MPa"))),
    kind("jackson-green", mf.JacksonGreen, yield_strength=(Stress, key("of the softer material", "4 MPa"))),
    kind(
        "tabulated",
        mf.TabulatedContact,
        (("indentation", "load", "area"), ("file",)),
        indentation=(list[Length] | None, optional("either: d, increasing", INDENTATIONS)),
        load=(list[Force] | None, optional("with it: P at these", FORCES)),
        area=(list[Area] | None, optional("with it: A at these", AREAS)),
        file=(str | None, optional("or: a table such as indentation_um,load_mN,area_mm2", "contact.csv")),
    ),
)
