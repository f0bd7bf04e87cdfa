"""The options ``--model`` and ``--contact``: models by name, contact laws in words."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from metafem._given import Names, printable
from metafem.contact import Contact
from metafem.errors import InvalidInput
from metafem.files.specification.manual import example, kind_of, models_of
from metafem.files.specification.models import model_named, suggestion
from metafem.files.specification.named_tables import in_folder, with_columns
from metafem.files.specification.problems import problem
from metafem.files.units import written_unit
from metafem.models import Model
from metafem.models.model import contact_of, with_contact

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic.fields import FieldInfo


def chosen_model(model: Model, name: str | None, contact: str | None) -> Model:
    """Return the model of the options ``--model`` and ``--contact``; what is not given is that of `model`."""
    law = contact_of(model) if contact is None else contact_named(contact)
    return with_contact(model, law) if name is None else model_named(name, law)


@cache
def contacts() -> dict[str, type[BaseModel]]:
    """Return the sections of contact laws by their kinds."""
    from metafem.files.specification.contacts import ContactSection

    return {kind_of(section): section for section in models_of(ContactSection)}


def contact_named(text: str) -> Contact:
    """Return the contact law in words: its kind and the values of its keys, in their order.

    Examples
    --------
    >>> contact_named("power 4 0.5")
    PowerCap(exponent=4.0, coefficient=0.5)
    """
    from pydantic import ValidationError

    from metafem.files.specification.contents import Sections

    table = section_named(text.split())
    kind = table["kind"]
    section: Any = contacts()[kind]
    units = {name: unit for name, value in table.items() if (unit := written_unit(value))}
    try:
        if "file" in table:
            table, _ = with_columns("contact", table, in_folder(Path()))
        if "file" in table.get("cap", {}):
            table["cap"], _ = with_columns("contact.cap", table["cap"], in_folder(Path()))
        law: Contact = section.model_validate(table).law()
        return law
    except ValidationError as error:
        detail = error.errors(include_url=False)[0]
        place = ("contact", kind, *detail["loc"])  # as in a specification
        reason = problem({**detail, "loc": place}, Sections)
    except InvalidInput as error:
        reason = error
    reason = reason.at(reason.key.removeprefix("contact").removeprefix("."))
    reason.names = Names(units=units)
    raise InvalidInput(f'contact law "{printable(text, 60)}": {reason} ({form(kind)})')


def form(kind: str) -> str:
    """Return the words of a kind of law; values that may be left out are in brackets.

    Examples
    --------
    >>> form("power")
    'power EXPONENT [COEFFICIENT]'
    """
    names = (
        name.upper() if field.is_required() or name == "file" else f"[{name.upper()}]"
        for name, field in _worded_keys(kind)
    )
    return " ".join([kind, *names])


def _worded_keys(kind: str) -> Iterator[tuple[str, FieldInfo]]:
    """Yield the keys whose values stand in words: all but lists."""
    for name, field in contacts()[kind].model_fields.items():
        if name != "kind" and not isinstance(example(field), list):
            yield name, field


def section_named(words: list[str]) -> dict[str, Any]:
    """Return the section of a specification that words stand for."""
    kind, rest = " ".join(words[:1]), words[1:]
    if kind not in contacts():
        raise InvalidInput(f'contact law "{printable(kind, 60)}" is unknown{suggestion(kind, contacts())}')
    section: dict[str, Any] = {"kind": kind}
    for name, field in _worded_keys(kind):
        if not rest:
            break
        shown = example(field)
        if isinstance(shown, float):
            section[name] = _number(rest.pop(0))
        elif isinstance(shown, dict):
            section[name], rest = section_named(rest), []
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
