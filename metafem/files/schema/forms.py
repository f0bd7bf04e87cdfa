"""Sections and keys of a specification as data, from the definitions that read them."""

from __future__ import annotations

import types
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

from metafem.files.schema.quantities import UNITS
from metafem.files.specification.fields import OneOf, Reader, Section
from metafem.files.specification.manual import default_of, example, kind_of, models_of

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

# What values without a unit are.
PLAIN = {float: "number", int: "integer", bool: "truth", str: "text"}


@dataclass(frozen=True)
class KeyForm:
    """A key of a section, and the form of its value.

    Attributes
    ----------
    name : str
    meaning : str
    example : object
        A valid value, as TOML has it.
    optional : bool
    default : object
        Of an optional key; None for none.
    value : str
        "quantity", "number", "integer", "truth", "text" or "section".
    units : tuple of str
        Usual units of a quantity.
    listed : bool
        Whether the value is a list of such values.
    pairs : bool
        Whether an entry of the list can be a list of two.
    names : tuple of str
        The texts that are allowed; empty for any.
    choice : int or None
        Number of the choice to which the key belongs: of a section's choices one is given.
    """

    name: str
    meaning: str
    example: Any
    optional: bool
    default: Any
    value: str
    units: tuple[str, ...] = ()
    listed: bool = False
    pairs: bool = False
    names: tuple[str, ...] = ()
    choice: int | None = None

    @property
    def needed(self) -> bool:
        """Whether a specification that follows the first choice of keys has this one."""
        return not self.optional or self.choice == 0


@dataclass(frozen=True)
class SectionForm:
    """A section of a specification.

    Attributes
    ----------
    name : str
    meaning : str
    optional : bool
    kinds : mapping of str to str
        What each kind is, in a sentence; empty for a section without kinds.
    keys : mapping of str to tuple of KeyForm
        Keys of each kind in the order of the manual, of "" for a section without kinds.
    """

    name: str
    meaning: str
    optional: bool
    kinds: dict[str, str]
    keys: dict[str, tuple[KeyForm, ...]]


@cache
def section_forms() -> tuple[SectionForm, ...]:
    """Return the sections of a specification in the order of the manual.

    A key whose value is a section again, ``contact.cap``, is followed by that section.

    Examples
    --------
    >>> forms = {form.name: form for form in section_forms()}
    >>> forms["limits"].keys[""][0].units[:3], forms["contact"].kinds["hertz"]
    (('nm', 'um', 'mm'), 'Elastic paraboloids.')
    """
    from metafem.files.specification.contents import Sections

    return tuple(
        form
        for name, field in Sections.model_fields.items()
        for form in _forms(name, field.description or "", not field.is_required(), field.annotation)
    )


def _forms(name: str, meaning: str, optional: bool, annotation: Any) -> Iterable[SectionForm]:
    models = models_of(annotation)
    kinds = {kind_of(model): (model.__doc__ or "").splitlines()[0] for model in models if kind_of(model)}
    keys = {kind_of(model): tuple(_keys(model)) for model in models}
    yield SectionForm(name, meaning, optional, kinds, keys)
    for model in models:
        for key, field in model.model_fields.items():
            if models_of(field.annotation):
                words = field.description or ""
                yield from _forms(f"{name}.{key}", words, not field.is_required(), field.annotation)


def _keys(model: Any) -> Iterable[KeyForm]:
    choices: dict[str, int] = {name: i for i, names in enumerate(model.choices) for name in names}
    for name, field in model.model_fields.items():
        if not kind_of(model) or name != "kind":
            yield _key(name, field, choices.get(name))


def _key(name: str, field: FieldInfo, choice: int | None) -> KeyForm:
    optional = not field.is_required()
    common = (name, field.description or "", example(field), optional, default_of(field))
    if models_of(field.annotation):
        return KeyForm(*common, "section", choice=choice)
    found = _value(field.annotation, field.metadata)
    return KeyForm(*common, **found, choice=choice)


def _value(annotation: Any, metadata: Iterable[Any]) -> dict[str, Any]:
    """Return the form of the values of a type with its annotations."""
    metadata = [part for item in metadata for part in getattr(item, "metadata", [item])]
    for item in metadata:
        reader = getattr(item, "func", None)
        if isinstance(reader, Reader):
            units = tuple(unit for dimension in reader.units for unit in _distinct(UNITS[dimension]))
            return {"value": "quantity", "units": units, "pairs": reader.pairs}
        if isinstance(item, OneOf):
            return {"value": "text", "names": item.names}
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _value(parts[0], [*parts[1:], *metadata])
    if origin in (Union, types.UnionType):
        return _value(next(part for part in parts if part is not type(None)), metadata)
    if origin is Literal:
        return {"value": "text", "names": parts}
    if origin in (list, tuple):
        return {**_value(parts[0], []), "listed": True}
    assert not (isinstance(annotation, type) and issubclass(annotation, Section))
    return {"value": PLAIN[annotation]}


def _distinct(units: tuple[str, ...]) -> tuple[str, ...]:
    """Return units without other spellings of micrometres, newtons and degrees."""
    return tuple(unit for unit in units if not unit.startswith(("µ", "μ", "°")))
