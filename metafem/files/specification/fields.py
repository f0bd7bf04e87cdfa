"""Types of the keys of a specification: quantities with units, with meaning and example."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core.core_schema import CoreSchema, no_info_before_validator_function

from metafem.errors import InvalidInput
from metafem.files.units import USUAL, converted, pattern

# Sets of keys; one set must be present.
Choices = tuple[tuple[str, ...], ...]


class Section(BaseModel):
    """A section in which every key is known."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    # Keys of which exactly one set must be given, and the least number of keys.
    choices: ClassVar[Choices] = ()
    fewest: ClassVar[int] = 0

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
        return no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(self, core: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the pattern of the text, and the usual units."""
        number = handler(core)
        words = pattern(self.units, positive="exclusiveMinimum" in number)
        shown = [unit for dimension in self.units for unit in USUAL[dimension] if unit[0] not in "µμ°"]
        text = {"type": "string", "pattern": words, "x-units": shown}
        pair = {"type": "array", "items": text, "minItems": 2, "maxItems": 2}
        return {"anyOf": [text, pair]} if self.pairs else text


def measured(unit: str, example: str | None = None) -> Quantity:
    """Read a text with a unit, such as "120 um"."""
    return Quantity(lambda given: converted(given, unit, example), (unit,))


def says(meaning: str, example: Any = None) -> Any:
    """Return the meaning of a key and a valid value; errors and `metafem spec` print both."""
    return Field(description=meaning, examples=None if example is None else [example])


def one_of(names: Iterable[str]) -> Any:
    """Return the allowed values of a text, for the JSON schema."""
    return Field(json_schema_extra={"enum": list(names)})


Length = Annotated[float, measured("mm")]
Area = Annotated[float, measured("mm^2")]
Force = Annotated[float, measured("N")]
Stress = Annotated[float, measured("MPa")]
Angle = Annotated[float, measured("rad")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whether = Annotated[bool, Field(strict=True)]


def one_of_two(section: Section, first: str, second: str) -> None:
    """Refuse both and neither of two keys."""
    given = [getattr(section, key) is not None for key in (first, second)]
    if all(given):
        raise InvalidInput(f"has both {first} and {second}; keep one of them")
    if not any(given):
        raise InvalidInput(f"needs either {first} or {second}")
