"""The exceptions and the warning of the package."""

from __future__ import annotations

from typing import Any


class MetafemError(Exception):
    """Base of all errors that metafem raises for its users."""


class InvalidInput(MetafemError, ValueError):
    """An argument or a key has a value that cannot be used; the message says what is allowed.

    Attributes
    ----------
    problems : tuple of str
        Of a refused specification one line for each problem, which begins with the key; otherwise empty.
    """

    problems: tuple[str, ...]

    def __init__(self, *message: object, problems: tuple[str, ...] = ()) -> None:
        super().__init__(*message)
        self.problems = problems


class Infeasible(MetafemError):
    """A target that no surface within the limits can reach.

    Attributes
    ----------
    nearest : target or None
        The nearest target of the same kind that can be designed with the same template and
        limits, if one is known.
    by_search : bool
        Whether a search has found no surface although no bound excludes one. A longer search can find one.
    """

    def __init__(self, message: str, nearest: Any = None, by_search: bool = False) -> None:
        super().__init__(message)
        self.nearest = nearest
        self.by_search = by_search


class NotConverged(MetafemError):
    """A solver stopped before its residual was small.

    Attributes
    ----------
    state : object or None
        The solver's last state, with its status and residual.
    """

    def __init__(self, message: str, state: Any = None) -> None:
        super().__init__(message)
        self.state = state


class MetafemWarning(UserWarning):
    """A result was computed outside the range in which the model is valid."""
