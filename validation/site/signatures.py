"""Signatures as readers know them: parameters and types as they are written in the source."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import fields
from enum import Enum
from typing import Any

# Types in annotations, and the words that readers know.
SHORT = {
    r"\b(Float|Int|Bool)Array\b": "ndarray",
    r"\bNDArray\[[^\]]*\]": "ndarray",
    r"\bValues\b": "float | ndarray",
    r"\bnp\.": "numpy.",
    r"\bxr\.": "xarray.",
    r"\bProfile\b": "Callable",
}

# Largest number of digits of a default value.
DIGITS = 6


def signature(value: Callable[..., Any]) -> list[str]:
    """Return the parameters of a function or a class as they are written; of a class, those it explains."""
    shown: list[str] = []
    named = False  # whether the next ones can be given by name alone
    for each in inspect.signature(value).parameters.values():
        if each.name in ("self", "cls") or (
            inspect.isclass(value) and each.name not in (value.__doc__ or "")
        ):
            continue
        if each.kind is each.KEYWORD_ONLY and not named:
            shown.append("*")
        named = named or each.kind in (each.KEYWORD_ONLY, each.VAR_POSITIONAL)
        text = {each.VAR_POSITIONAL: "*", each.VAR_KEYWORD: "**"}.get(each.kind, "") + each.name
        if each.annotation is not each.empty:
            text += f": {type_words(each.annotation)}"
        if each.default is not each.empty:
            text += f" = {_default(value, each)}"
        shown.append(text)
    return shown


def result(value: Callable[..., Any]) -> str:
    """Return the type of what a function returns, or nothing."""
    annotation = inspect.signature(value).return_annotation
    return "" if inspect.isclass(value) or annotation is inspect.Signature.empty else type_words(annotation)


def type_words(annotation: Any) -> str:
    """Return an annotation as it is written, with the usual names of arrays."""
    text = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    for internal, usual in SHORT.items():
        text = re.sub(internal, usual, text)
    return text


def _default(value: Any, parameter: inspect.Parameter) -> str:
    """Return a default value without addresses of memory and superfluous digits."""
    default = parameter.default
    if repr(default) == "<factory>":
        default = next(each for each in fields(value) if each.name == parameter.name).default_factory()
    if isinstance(default, Enum):
        return str(default)
    if isinstance(default, float):
        return repr(default) if len(repr(default)) <= DIGITS else f"{default:.{DIGITS}g}"
    return re.sub(r" at 0x[0-9a-f]+", "", repr(default))
