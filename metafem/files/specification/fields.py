"""Types of the keys of a specification: quantities with units, with meaning and example."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from metafem.files.units import converted


class Section(BaseModel):
    """A section in which every key is known."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def measured(unit: str, example: str | None = None) -> BeforeValidator:
    """Read a text with a unit, such as "120 um"."""
    return BeforeValidator(lambda given: converted(given, unit, example))


def says(meaning: str, example: Any = None) -> Any:
    """State the meaning of a key and a valid value; errors and `metafem spec` print both."""
    return Field(description=meaning, examples=None if example is None else [example])


Length = Annotated[float, measured("mm")]
Area = Annotated[float, measured("mm^2")]
Force = Annotated[float, measured("N")]
Stress = Annotated[float, measured("MPa")]
Angle = Annotated[float, measured("rad")]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Whether = Annotated[bool, Field(strict=True)]
