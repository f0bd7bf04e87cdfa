"""Errors of calls that do not fit a function's signature, as `InvalidInput`."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from difflib import get_close_matches
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from metafem.errors import InvalidInput

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")


def checked_call(function: Callable[P, R]) -> Callable[P, R]:
    """Raise InvalidInput, not TypeError, for a call with too many, unknown or missing arguments.

    Examples
    --------
    >>> @checked_call
    ... def press(surface, model=None, *, load=None): ...
    >>> press(1, [0.1], model=2)
    Traceback (most recent call last):
        ...
    metafem.errors.InvalidInput: press: model is given twice; call press(surface, model, load=...)
    """

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            if error.__traceback__ is not None and error.__traceback__.tb_next is not None:
                raise  # raised inside the function
            raise InvalidInput(_fault(function, args, kwargs)) from None

    return call


def checked_class(cls: type[T]) -> type[T]:
    """Raise InvalidInput, not TypeError, for a constructor's call that does not fit."""
    cls.__init__ = checked_call(cls.__init__)  # type: ignore[method-assign]
    return cls


def _fault(function: Callable[..., Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> str:
    """Return what is wrong with a call, and the correct form."""
    parameters = inspect.signature(function).parameters
    hidden = [name for name in parameters if name in ("self", "cls")]
    name = function.__qualname__.removesuffix(".__init__")
    by_place = [p.name for p in parameters.values() if p.kind is not p.KEYWORD_ONLY and p.name not in hidden]
    by_name = [p.name for p in parameters.values() if p.kind is p.KEYWORD_ONLY]
    call = f"call {name}({', '.join([*by_place, *(f'{key}=...' for key in by_name)])})"
    unknown = [key for key in kwargs if key not in parameters]
    twice = [key for key in by_place[: len(args) - len(hidden)] if key in kwargs]
    if unknown:
        other = _maker(type(args[0]), unknown[0]) if "self" in hidden else None
        if other is not None:
            return f"{name} has no argument {unknown[0]}; call {name}.{other}({unknown[0]}=..., ...)"
        near = get_close_matches(unknown[0], list(parameters), 1)
        meant = f"; did you mean {near[0]}?" if near else ""
        return f"{name} has no argument {unknown[0]}{meant}; {call}"
    if twice:
        return f"{name}: {twice[0]} is given twice; {call}"
    if len(args) - len(hidden) > len(by_place):
        return f"{name} is given {len(args) - len(hidden)} arguments by position; {call}"
    given = {*by_place[: len(args) - len(hidden)], *kwargs, *hidden}
    missing = [p.name for p in parameters.values() if p.default is p.empty and p.name not in given]
    return f"{name}: {', '.join(missing)} must be given; {call}"


def _maker(kind: type, key: str) -> str | None:
    """Return the other constructor of a class that has an argument `key`, if any."""
    makers = inspect.getmembers(kind, inspect.ismethod)
    return next((name for name, made in makers if key in inspect.signature(made).parameters), None)
