"""Types of the keys of a specification: quantities with units, with meaning and example."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from metafem.errors import InvalidInput
from metafem.files.units import converted

# Sets of keys of which one is given.
Choices = tuple[tuple[str, ...], ...]


class Section(BaseModel):
    """A section in which every key is known."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    # Keys of which exactly one set must be given, and the least number of keys.
    choices: ClassVar[Choices] = ()
    fewest: ClassVar[int] = 0


@dataclass(frozen=True)
class Reader:
    """Reads a text with a unit of one of several dimensions, and where `pairs` is true a list of two."""

    read: Callable[[Any], Any]
    units: tuple[str, ...]
    pairs: bool = False

    def __call__(self, given: Any) -> Any:
        """Return the value of a text."""
        return self.read(given)


@dataclass(frozen=True)
class OneOf:
    """States the names that a text can have, for the JSON schema."""

    names: tuple[str, ...]


def measured(unit: str, example: str | None = None) -> BeforeValidator:
    """Read a text with a unit, such as "120 um"."""
    return BeforeValidator(Reader(lambda given: converted(given, unit, example), (unit,)))


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


def one_of_two(section: Section, first: str, second: str) -> None:
    """Refuse both and neither of two keys."""
    given = [getattr(section, key) is not None for key in (first, second)]
    if all(given):
        raise InvalidInput(f"has both {first} and {second}; keep one of them")
    if not any(given):
        raise InvalidInput(f"needs either {first} or {second}")
