"""Types of the keys of a specification, which are quantities with units, numbers or texts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, GetJsonSchemaHandler, WithJsonSchema
from pydantic import model_validator as validator

from metafem.errors import refuse_if
from metafem.files.units import UNITS, converted, pattern

# Bounds of values by their names in pydantic: the name in a JSON schema, and words.
BOUNDS = {
    "gt": ("exclusiveMinimum", "greater than"),
    "ge": ("minimum", "at least"),
    "lt": ("exclusiveMaximum", "less than"),
    "le": ("maximum", "at most"),
}

# Alternative sets of keys, of which one must be present.
Choices = tuple[tuple[str, ...], ...]


class Section(BaseModel):
    """A section, which refuses unknown keys; `makes` is called with its keys to build its value.

    Exactly one of the sets of keys in `choices` must be present.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    choices: ClassVar[Choices] = ()
    makes: ClassVar[Callable[..., Any] | None] = None

    @validator(mode="after")
    def _valid(self) -> Self:
        given = [key for key in dict.fromkeys(sum(self.choices, ())) if getattr(self, key) is not None]
        has = f"has {' and '.join(given)}; it " if given else ""
        needs = f"{has}needs either {' or '.join(map(' and '.join, self.choices))}"
        refuse_if(self.choices and set(given) not in map(set, self.choices), needs)
        self.value()
        return self

    def value(self) -> Any:
        """Return the value that the section describes, or None if it describes none by itself."""
        return None if self.makes is None else type(self).makes(**self.given())  # type: ignore[misc]

    def given(self) -> dict[str, Any]:
        """Return the values of the keys that have one, but those of the section itself."""
        own = {name: value for name, value in self if value is not None and name not in ("kind", "file")}
        return {name: value.value() if isinstance(value, Section) else value for name, value in own.items()}

    @classmethod
    def __get_pydantic_json_schema__(cls, core: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Return the JSON schema, to which the alternative sets are added."""
        found = handler.resolve_ref_schema(handler(core))
        every = set(sum(cls.choices, ()))
        if cls.choices:
            found["oneOf"] = [
                {"required": list(choice), "not": {"anyOf": [{"required": [key]} for key in rest]}}
                for choice in cls.choices
                if (rest := sorted(every - set(choice)))
            ]
        return {**found, "x-choices": [list(choice) for choice in cls.choices]}


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


def one_of(*names: str) -> Any:
    """Return the type of a text that is one of these."""
    return Literal[names]


Area, Force, Angle = map(measured, ("mm^2", "N", "rad"))
Length, PositiveLength, Energy = measured("mm", ge=0.0), measured("mm", gt=0.0), measured("N/mm", ge=0.0)
Stress = measured("MPa", gt=0.0)
Feed, Speed, Time = measured("mm/min", gt=0.0), measured("1/min", gt=0.0), measured("s", ge=0.0)
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
