"""Manual of the sections and keys of a specification, generated from their definitions."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, get_args

if TYPE_CHECKING:
    from pydantic import BaseModel
    from pydantic.fields import FieldInfo

HEAD = """\
# Every section and key of a specification for `metafem design`, each with an example value. This is a list,
# not a file to read: a specification has one kind of target, and one of the keys marked either and or.
# Sections and keys are required unless they are marked optional. Lengths, areas, forces, stresses and
# angles are written with their unit. `metafem demo linear` writes a whole example file.
# `metafem spec --schema` prints the JSON schema, by which an editor completes keys and marks errors.
# The misfit of a design is the rms of the relative difference between the law and the target or, if larger,
# the largest relative error of a fitted slope. For operating points, and for linear and bilinear laws with a
# load_range, it is the largest relative error. Above 1 % (and the errors of samples) the target is missed.
# Linear and bilinear laws without a load_range are compared with the law of their height density: above 1 %
# a note says so, above 10 % the target is missed.
"""

# Column of the comments, past most examples.
COLUMN = 48

# First words of a meaning where one key, or one pair of keys, of several is required.
CHOICES = ("either: ", "or: ", "with it: ")


@dataclass(frozen=True)
class Key:
    """A key of a section, for sections with kinds of one of these, with an example and its default."""

    section: str
    kind: str | None
    name: str
    example: Any
    meaning: str
    optional: bool
    default: Any


def all_keys() -> tuple[Key, ...]:
    """Return every key of a specification."""
    from metafem.files.specification.contents import Sections

    return tuple(
        key
        for name, field in Sections.model_fields.items()
        for model in models_of(field.annotation)
        for key in _keys(name, model)
    )


def manual() -> str:
    """Return the text that `metafem spec` prints.

    Examples
    --------
    >>> text = manual()
    >>> print(text[text.index("[checks]") :], end="")
    [checks]                                        # optional: further checks
    hardness = "10 MPa"                             # optional: H, which decides on a plastic law
    """
    from metafem.files.specification.contents import Sections

    lines = [HEAD]
    for name, field in Sections.model_fields.items():
        lines.append(_line(f"[{name}]", field.description or "", not field.is_required(), None))
        for model in models_of(field.annotation):
            if kind_of(model):
                words = (model.__doc__ or "").splitlines()[0]
                lines += ["", _line(f'kind = "{kind_of(model)}"', words, False, None)]
            lines += [
                _line(f"{key.name} = {as_toml(key.example)}", key.meaning, key.optional, key.default)
                for key in _keys(name, model)
            ]
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def as_toml(value: Any) -> str:
    """Return an example as it is written in a file."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key} = {as_toml(member)}' for key, member in value.items())}}}"
    return json.dumps(value)


def remark(meaning: str, optional: bool, default: Any) -> str:
    """Return the meaning of a key or section, with its default if it is optional."""
    told = "optional: " if optional and not meaning.startswith(CHOICES) else ""
    if default is not None:
        told = f"optional, default {f'{default:g}' if isinstance(default, float) else as_toml(default)}: "
    return f"{told}{meaning}"


def default_of(field: FieldInfo) -> Any:
    """Return the default of an optional key as it is printed, None if there is none or an empty list."""
    default: Any = None if field.is_required() or field.default == () else field.default
    return default.model_dump() if hasattr(default, "model_dump") else default  # of a section


def example(field: FieldInfo) -> Any:
    """Return the valid value of a key that `says` states."""
    return (field.examples or [None])[0]


def models_of(annotation: Any) -> tuple[type[BaseModel], ...]:
    """Return the sections of an annotation: one for each kind, or one."""
    parts = get_args(annotation) or (annotation,)
    return tuple(part for part in parts if hasattr(part, "model_fields"))


def kind_of(section: type[BaseModel]) -> str:
    """Return the kind that a section reads, empty for a section without kinds."""
    kind = section.model_fields.get("kind")
    words = () if kind is None else get_args(kind.annotation)
    return str(words[0]) if words else ""


def _keys(section: str, model: type[BaseModel]) -> Iterator[Key]:
    kind = kind_of(model) or None
    for name, field in model.model_fields.items():
        if kind is None or name != "kind":
            words, optional = field.description or "", not field.is_required()
            yield Key(section, kind, name, example(field), words, optional, default_of(field))


def _line(start: str, meaning: str, optional: bool, default: Any) -> str:
    return f"{start:<{COLUMN - 1}} # {remark(meaning, optional, default)}"
