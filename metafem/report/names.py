"""Models in the words of a user."""

from __future__ import annotations

from dataclasses import fields, is_dataclass


def model_name(value: object) -> str:
    """Return a model as a user would type it, without what is left at its default.

    Examples
    --------
    >>> from metafem import BondedLayer, Interacting
    >>> model_name(Interacting(order=3, substrate=BondedLayer()))
    'Interacting(substrate=BondedLayer())'
    """
    if not is_dataclass(value):
        return repr(value)
    given = []
    for field in fields(value):
        member = getattr(value, field.name)
        default = field.default_factory() if callable(field.default_factory) else field.default
        if member != default:
            given.append(f"{field.name}={model_name(member)}")
    return f"{type(value).__name__}({', '.join(given)})"
