"""``[contact]`` of each kind, as pydantic models, and contact laws in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, Field, ValidationError, model_validator
from pydantic.fields import FieldInfo

from metafem._given import ErrorNames, error_names, printable
from metafem.contact import AxisymmetricCap, Contact, Hertz, PowerCap, SphericalCap
from metafem.errors import InvalidInput
from metafem.files.specification.fields import Length, Number, Section, says
from metafem.files.specification.manual import example, kind_of, models_of
from metafem.files.specification.models import suggestion
from metafem.files.specification.named_tables import with_columns
from metafem.files.specification.words import worded
from metafem.files.units import written_units


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
    rho: Annotated[
        list[Length] | None,
        says("either: distances from the axis, from 0", ["0 um", "100 um", "200 um", "300 um"]),
    ] = None
    f: Annotated[
        list[Length] | None,
        says("with it: depths below the summit, from 0", ["0 um", "10 um", "42 um", "105 um"]),
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


ContactSection = HertzSection | SphereSection | PowerCapSection | ProfileSection

# The section of each kind.
CONTACTS: Mapping[str, type[BaseModel]] = {kind_of(each): each for each in models_of(ContactSection)}


class _Words(Section):
    """A law in words, read as the section of a specification."""

    contact: Annotated[ContactSection, Field(discriminator="kind")]


def contact_named(text: str) -> Contact:
    """Return the contact law in words: its kind and the values of its keys, in their order.

    Examples
    --------
    >>> contact_named("power 4 0.5")
    PowerCap(exponent=4.0, coefficient=0.5)
    """
    section = _section(text.split())
    with error_names(ErrorNames(section="contact", units=written_units({"contact": section}))):
        try:
            if "file" in section:
                section, _ = with_columns("contact", section, Path())
            return _Words.model_validate({"contact": section}).contact.law()
        except ValidationError as error:
            reason = (
                worded(error.errors(include_url=False)[0], _Words)
                .replace("contact.", "")
                .removeprefix("contact ")
            )
        except InvalidInput as error:
            reason = str(error)
    raise InvalidInput(f'contact law "{printable(text, 60)}": {reason} ({form(section["kind"])})')


def form(kind: str) -> str:
    """Return the words of a kind of law; values that may be left out are in brackets.

    Examples
    --------
    >>> form("power")
    'power EXPONENT [COEFFICIENT]'
    """
    needed = {"profile": ("file",)}.get(kind, ())
    names = (
        name.upper() if field.is_required() or name in needed else f"[{name.upper()}]"
        for name, field in _worded_keys(kind)
    )
    return " ".join([kind, *names])


def _worded_keys(kind: str) -> Iterator[tuple[str, FieldInfo]]:
    """Yield the keys whose values stand in words: all but lists."""
    for name, field in CONTACTS[kind].model_fields.items():
        if name != "kind" and not isinstance(example(field), list):
            yield name, field


def _section(words: list[str]) -> dict[str, Any]:
    """Return the section that words stand for."""
    kind, rest = " ".join(words[:1]), words[1:]
    if kind not in CONTACTS:
        raise InvalidInput(f'contact law "{printable(kind, 60)}" is unknown{suggestion(kind, CONTACTS)}')
    section: dict[str, Any] = {"kind": kind}
    for name, field in _worded_keys(kind):
        if not rest:
            break
        shown = example(field)
        if isinstance(shown, float):
            section[name] = _number(rest.pop(0))
        elif name == "file":
            section[name], rest = " ".join(rest), []
        else:  # a quantity, whose unit may be a word of its own
            apart = isinstance(_number(rest[0]), float)
            section[name], rest = " ".join(rest[: 1 + apart]), rest[1 + apart :]
    if rest:
        raise InvalidInput(
            f'contact law "{kind}": {printable(" ".join(rest), 60)} is not one of its values ({form(kind)})'
        )
    return section


def _number(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word
