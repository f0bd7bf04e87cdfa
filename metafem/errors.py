"""The exceptions and the warning of the package."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from copyreg import __newobj__  # type: ignore[attr-defined]
from typing import Any

from metafem._given import AS_IN_PYTHON, Given, Names


class MetafemError(Exception):
    """Base of all errors that metafem raises for its users.

    A message about arguments is a template with a field for each of them. `str` fills it with their names and
    values as the reader knows them: those of Python, unless `named` sets others.
    """

    names: Names = AS_IN_PYTHON

    def __init__(self, message: str = "", *about: Given) -> None:
        super().__init__(message, *about)

    def __str__(self) -> str:
        return self.names.filled(*self.args)

    def __reduce__(self) -> Any:
        return __newobj__, (type(self), *self.args), self.__dict__


class InvalidInput(MetafemError, ValueError):
    """An argument or a key has an invalid value.

    Attributes
    ----------
    must : str
        The problem or the allowed values: "must be greater than 0". Without a key it is the whole message.
    key : str
        The argument, an entry such as "radius[3]", or the key of a file such as "limits.max_height"; "" if
        there is no single one.
    value : float, str or None
        The number, in the package's unit, or the text; None if the error does not state it.
    example : str
        A valid value or line, stated at the end; "" for none.
    problems : tuple of InvalidInput
        The problems of a refused specification; its name is then the message. Otherwise empty.
    """

    def __init__(
        self,
        must: str = "",
        *about: Given,
        key: str = "",
        value: float | str | None = None,
        example: str = "",
        problems: tuple[InvalidInput, ...] = (),
    ) -> None:
        super().__init__(must, *about)
        self.key, self.value, self.example, self.problems = key, value, example, problems

    @property
    def must(self) -> str:
        """The problem, without the key and its value."""
        words = super().__str__()
        return f"{words}; write for example {self.example}" if self.example else words

    def __str__(self) -> str:
        if self.problems:
            return "\n".join(f"{self.must}: {problem}" for problem in self.problems)
        if not self.key:
            return self.must
        said = self.names.said(Given(self.key, self.value))
        return f"{said.name if self.value is None else said} {self.must}"

    def at(self, key: str) -> InvalidInput:
        """Return the error of a value as that of a key."""
        return InvalidInput(*self.args, key=key, value=self.value, example=self.example)

    def within(self, section: str) -> InvalidInput:
        """Return the error of an argument as that of a key in a section."""
        if not self.key:
            return InvalidInput(f"cannot be used: {self}", key=section)
        message, *about = self.args
        moved = (Given(f"{section}.{other.name}", other.value) for other in about)
        key = f"{section}.{self.key}"
        return InvalidInput(message, *moved, key=key, value=self.value, example=self.example)


def refuse_if(
    wrong: Any,
    must: str,
    *about: Given,
    key: str = "",
    value: float | str | None = None,
    example: str = "",
) -> None:
    """Raise `InvalidInput` with these data if `wrong`."""
    if wrong:
        raise InvalidInput(must, *about, key=key, value=value, example=example)


class Infeasible(MetafemError):
    """A target that no surface within the limits can reach.

    The message states loads and frictions in the units of the target; `in_units` converts it to others.

    Attributes
    ----------
    nearest : target or None
        The nearest target of the same kind that can be designed with the same template and
        limits, if one is known.
    by_search : bool
        Whether a search has found no surface although no bound excludes one. A longer search may find one.
    """

    def __init__(self, message: Any, nearest: Any = None, by_search: bool = False) -> None:
        super().__init__(message)
        self.message = message
        self.nearest = nearest
        self.by_search = by_search

    def __str__(self) -> str:
        return str(self.message)

    def in_units(self, wording: Any) -> str:
        """Return the message with its loads and frictions in the units of a target's wording."""
        return self.message if isinstance(self.message, str) else str(self.message.worded(wording))


class NotConverged(MetafemError):
    """A solver stopped before its residual was small.

    Attributes
    ----------
    state : object or None
        The solver's last state, with its status and residual.
    """

    def __init__(self, message: str, state: Any = None, *about: Given) -> None:
        super().__init__(message, *about)
        self.state = state


class MetafemWarning(UserWarning):
    """A result was computed outside the range in which the model is valid."""


@contextmanager
def named(names: Names) -> Iterator[None]:
    """Make errors of the body use the names of arguments and the units of a file or a command.

    Names that were set within the body remain.
    """
    try:
        yield
    except MetafemError as error:
        error.names = names.under(error.names)
        raise
