"""Types of the keys of a specification: quantities with units, with meaning and example."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    model_validator,
)
from pydantic_core.core_schema import CoreSchema, no_info_before_validator_function

from metafem.errors import InvalidInput
from metafem.files.units import USUAL, converted, pattern

# Sets of keys; one set must be present.
Choices = tuple[tuple[str, ...], ...]


class Section(BaseModel):
    """A section in which every key is known, with the class of the value that has the same keys."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    # Keys of which exactly one set must be given, further valid sets, and the least number of keys.
    choices: ClassVar[Choices] = ()
    also: ClassVar[Choices] = ()
    fewest: ClassVar[int] = 0
    makes: ClassVar[Callable[..., Any]]

    @model_validator(mode="after")
    def _one_choice(self) -> Self:
        keys = [key for choice in self.choices for key in choice]
        given = [key for key in keys if getattr(self, key) is not None]
        if self.choices and set(given) not in map(set, (*self.choices, *self.also)):
            has = f"has {' and '.join(given)}; it " if given else ""
            raise InvalidInput(f"{has}needs either {' or '.join(map(' and '.join, self.choices))}")
        return self

    def value(self) -> Any:
        """Return the value that the section describes."""
        return self.makes(**self.model_dump(exclude={"kind", "file"}))

    @classmethod
    def __get_pydantic_json_schema__(cls, core: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Add the choices of keys to the JSON schema, and the least number of keys."""
        found = {**handler.resolve_ref_schema(handler(core)), "x-choices": cls.choices}
        return {**found, "minProperties": cls.fewest} if cls.fewest else found


@dataclass(frozen=True)
class Quantity:
    """Reads a text with a unit of one of several dimensions, and where `pairs` is true a list of two."""

    read: Callable[[Any], Any]
    units: tuple[str, ...]
    pairs: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the validation of the number that is read."""
        return no_info_before_validator_function(self._number, handler(source))

    def _number(self, given: Any) -> Any:
        """Read a text; an entry of a table is a number already."""
        return float(given) if isinstance(given, np.float64) else self.read(given)

    def __get_pydantic_json_schema__(self, core: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the pattern of the text, and the usual units."""
        number = handler(core)
        words = pattern(self.units, positive="exclusiveMinimum" in number)
        shown = [unit for dimension in self.units for unit in USUAL[dimension] if unit[0] not in "µμ°"]
        text = {"type": "string", "pattern": words, "x-units": shown}
        pair = {"type": "array", "items": text, "minItems": 2, "maxItems": 2}
        return {"anyOf": [text, pair]} if self.pairs else text


def measured(unit: str) -> Quantity:
    """Read a text with a unit, such as "120 um"."""
    return Quantity(lambda given: converted(given, unit), (unit,))


def key(meaning: str, example: Any = None, *, default: Any = ...) -> Any:
    """Return a key with its meaning and a valid value for `metafem spec`; required without a default."""
    return Field(default, description=meaning, examples=None if example is None else [example])


def optional(meaning: str, example: Any = None) -> Any:
    """Return a key that may be omitted, with its meaning and a valid value."""
    return key(meaning, example, default=None)


def one_of(names: Iterable[str]) -> Any:
    """Return the allowed values of a text, for the JSON schema."""
    return Field(json_schema_extra={"enum": list(names)})


Length = Annotated[float, measured("mm")]
Area = Annotated[float, measured("mm^2")]
Force = Annotated[float, measured("N")]
Stress = Annotated[float, measured("MPa")]
Energy = Annotated[float, measured("N/mm")]
Angle = Annotated[float, measured("rad")]
PositiveLength = Annotated[float, Field(gt=0.0), measured("mm")]
PositiveStress = Annotated[float, Field(gt=0.0), measured("MPa")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whether = Annotated[bool, Field(strict=True)]
