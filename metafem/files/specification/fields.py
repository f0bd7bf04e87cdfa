"""Types of the keys of a specification, which are quantities with units, numbers or texts."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core.core_schema import CoreSchema, no_info_before_validator_function

from metafem.errors import InvalidInput
from metafem.files.units import UNITS, converted, pattern

# Alternative sets of keys, of which one must be present.
Choices = tuple[tuple[str, ...], ...]


class Section(BaseModel):
    """A section, which refuses unknown keys; `makes` is called with its keys to build its value.

    Exactly one of the sets of keys in `choices` must be present, or one of those in `also`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    choices: ClassVar[Choices] = ()
    also: ClassVar[Choices] = ()
    makes: ClassVar[Callable[..., Any]]

    @model_validator(mode="after")
    def _valid(self) -> Self:
        keys = [key for choice in self.choices for key in choice]
        given = [key for key in keys if getattr(self, key) is not None]
        if self.choices and set(given) not in map(set, (*self.choices, *self.also)):
            has = f"has {' and '.join(given)}; it " if given else ""
            raise InvalidInput(f"{has}needs either {' or '.join(map(' and '.join, self.choices))}")
        self.value()
        return self

    def value(self) -> Any:
        """Return the value that the section describes, or None if it describes none by itself."""
        made = getattr(type(self), "makes", None)
        return None if made is None else made(**self.model_dump(exclude={"kind", "file"}))

    @classmethod
    def __get_pydantic_json_schema__(cls, core: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the JSON schema, to which the alternative sets are added."""
        found = handler.resolve_ref_schema(handler(core))
        if cls.choices:
            every = {key for choice in cls.choices for key in choice}
            found["oneOf"] = [
                {"required": list(choice), "not": {"anyOf": [{"required": [key]} for key in rest]}}
                for choice in (*cls.choices, *cls.also)
                if (rest := sorted(every - set(choice)))
            ]
        return {**found, "x-choices": [list(choice) for choice in cls.choices]}


@dataclass(frozen=True)
class Quantity:
    """A validator that reads a text with a unit; with `pairs` it also reads a list of two texts.

    `units` holds the package's unit of each dimension that the text may have.
    """

    read: Callable[[Any], Any]
    units: tuple[str, ...]
    pairs: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema by which pydantic reads the text and then validates the number."""
        return no_info_before_validator_function(self._number, handler(source))

    def _number(self, given: Any) -> Any:
        """Return the number of a text; an entry of a table is already a number."""
        return float(given) if isinstance(given, np.float64) else self.read(given)

    def __get_pydantic_json_schema__(self, core: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the JSON schema of the text: its pattern and the usual units."""
        words = pattern(self.units, positive="exclusiveMinimum" in handler(core))
        shown = [unit for dimension in self.units for unit in UNITS[dimension] if unit != "°"]
        text = {"type": "string", "pattern": words, "x-units": shown}
        pair = {"type": "array", "items": text, "minItems": 2, "maxItems": 2}
        return {"anyOf": [text, pair]} if self.pairs else text


def measured(unit: str) -> Quantity:
    """Return the validator of a text such as "120 um", whose result is a number in `unit`."""
    return Quantity(lambda given: converted(given, unit), (unit,))


def key(meaning: str, example: Any = None, *, default: Any = ...) -> Any:
    """Return the field of a key; `metafem spec` prints its meaning and example.

    A key without a default is required.
    """
    return Field(default, description=meaning, examples=None if example is None else [example])


def optional(meaning: str, example: Any = None) -> Any:
    """Return the field of a key that may be omitted, with its meaning and an example."""
    return key(meaning, example, default=None)


def one_of(names: Iterable[str]) -> Any:
    """Return a field whose JSON schema lists the allowed texts."""
    return Field(json_schema_extra={"enum": list(names)})


Length = Annotated[float, measured("mm")]
Area = Annotated[float, measured("mm^2")]
Force = Annotated[float, measured("N")]
Stress = Annotated[float, measured("MPa")]
Energy = Annotated[float, measured("N/mm")]
Angle = Annotated[float, measured("rad")]
PositiveLength = Annotated[float, Field(gt=0.0), measured("mm")]
PositiveStress = Annotated[float, Field(gt=0.0), measured("MPa")]
Feed = Annotated[float, Field(gt=0.0), measured("mm/min")]
Speed = Annotated[float, Field(gt=0.0), measured("1/min")]
Time = Annotated[float, Field(ge=0.0), measured("s")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
