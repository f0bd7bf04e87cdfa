"""The options ``--model`` and ``--contact``: a model and a contact law such as "jkr 9 mJ/m^2"."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from metafem._given import printable
from metafem.contact import Contact
from metafem.errors import InvalidInput, refuse_if
from metafem.files.specification.forms import Form, section_forms
from metafem.files.specification.models import model_named, suggestion
from metafem.files.specification.read import fill, problem
from metafem.files.specification.sections import ContactSection
from metafem.material import Block
from metafem.models import Model
from metafem.models.model import contact_of, with_contact


def chosen_model(model: Model, name: str | None, contact: str | None, block: Block | None = None) -> Model:
    """Return the model that ``--model`` and ``--contact`` state; defaults: `model` and its contact law."""
    law = contact_of(model) if contact is None else contact_named(contact)
    return with_contact(model, law) if name is None else model_named(name, law, block)


def contacts() -> dict[str, list[Form]]:
    """Return the keys that ``--contact`` accepts, by kind of contact law: all keys but lists."""
    keys: dict[str, list[Form]] = section_forms()["contact"]["keys"]
    return {kind: [key for key in keys[kind] if not key["listed"]] for kind in keys}


def contact_named(text: str) -> Contact:
    """Return the contact law that a text states: its kind, then the values of its keys in their order.

    Examples
    --------
    >>> contact_named("jkr 9 mJ/m^2 elastic")
    JKR(adhesion_energy=9e-06, cap=Elastic())
    """
    table = section_named(text.split())
    try:
        fill({"contact": table}, Path())
        law: Contact = TypeAdapter(ContactSection).validate_python(table).value()
        return law
    except ValidationError as error:
        detail = error.errors(include_url=False)[0]  # as if it were in a specification
        reason = problem({**detail, "loc": ("contact", *detail["loc"])}, {"contact": table})
    except InvalidInput as error:
        reason = error
    raise InvalidInput(f'contact law "{printable(text, 60)}": {reason} ({_form(table["kind"])})')


def _form(kind: str) -> str:
    """Return how ``--contact`` states a kind of contact law, such as "jkr ADHESION_ENERGY [CAP]"."""
    names = (
        f"[{key['name'].upper()}]" if key["optional"] and key["name"] != "file" else key["name"].upper()
        for key in contacts()[kind]
    )
    return " ".join([kind, *names])


def section_named(words: list[str]) -> dict[str, Any]:
    """Return the section ``[contact]`` that the words of the option ``--contact`` describe."""
    kind, rest = " ".join(words[:1]), words[1:]
    unknown = f'contact law "{printable(kind, 60)}" is unknown{suggestion(kind, contacts())}'
    refuse_if(kind not in contacts(), unknown)
    section: dict[str, Any] = {"kind": kind}
    for key in contacts()[kind]:
        if not rest:
            break
        name, count = key["name"], len(rest)
        if key["value"] == "quantity":  # its unit may be a separate word
            count = 1 if rest[0][-1].isalpha() or rest[0][-1] in "²2" else 2
        words, rest = rest[:count], rest[count:]
        section[name] = section_named(words) if key["value"] == "section" else " ".join(words)
    left = printable(" ".join(rest), 60)
    refuse_if(rest, f'contact law "{kind}": {left} is not one of its values ({_form(kind)})')
    return section
