"""Exceptions and warnings of the package, and the words of their messages."""

from __future__ import annotations

import re
from importlib.util import find_spec
from typing import Any

# Arguments with an entry for each of some sites, which keep their numbers.
BY_SITE = ("pinned",)


class MetafemError(Exception):
    """Base class of all errors that metafem raises; a message is one sentence."""


class InvalidInput(MetafemError, ValueError):
    """An argument or a key has an invalid value.

    Attributes
    ----------
    must : str
        The problem or the allowed values, such as "must be greater than 0"; the complete message if there is
        no key.
    key : str
        The argument, an entry such as "radius[3]", or a key of a file such as "limits.max_height"; "" if the
        error does not concern a single argument. The message says "entry 4 of radius".
    value : float, str or None
        The invalid number, in the package's unit, or text; None if the error does not state the value.
    example : str
        A valid value or line, which ends the message; "" for no example.
    problems : tuple of InvalidInput
        All problems of a refused specification, whose name is then the message; empty for other errors.
    """

    def __init__(
        self,
        must: str = "",
        *,
        key: str = "",
        value: float | str | None = None,
        example: str = "",
        problems: tuple[InvalidInput, ...] = (),
    ) -> None:
        super().__init__(must)
        self.key, self.value, self.example, self.problems = key, value, example, problems

    @property
    def must(self) -> str:
        """Problem without the key and its value."""
        words = super().__str__()
        return f"{words}; write for example {self.example}" if self.example else words

    def __str__(self) -> str:
        if self.problems:
            return "\n".join(f"{self.must}: {problem}" for problem in self.problems)
        if not self.key:
            return self.must
        number = self.value if isinstance(self.value, (str, type(None))) else f"{self.value:g}"
        name = spoken(self.key)
        return f"{name} {self.must}" if number is None else f"{name} = {number} {self.must}"

    def at(self, key: str) -> InvalidInput:
        """Return the error of a value as an error of `key`."""
        return InvalidInput(*self.args, key=key, value=self.value, example=self.example)

    def within(self, section: str) -> InvalidInput:
        """Return the error of an argument as an error of a key in `section`."""
        if not self.key:
            return InvalidInput(f"cannot be used: {self}", key=section)
        return self.at(f"{section}.{self.key}")


def refuse_if(wrong: Any, must: str, **attributes: Any) -> None:
    """Raise `InvalidInput` with these arguments if `wrong` is true."""
    if wrong:
        raise InvalidInput(must, **attributes)


class Infeasible(MetafemError):
    """No surface within the limits can reach the target.

    The message states loads and frictions in the units of the target.

    Attributes
    ----------
    nearest : target or None
        The nearest target of the same kind that the same template and limits can reach; None if it is not
        known.
    by_search : bool
        Whether a search found no surface although no bound excludes the target; a longer search may then find
        a surface.
    """

    def __init__(self, message: str, nearest: Any = None, by_search: bool = False) -> None:
        super().__init__(message)
        self.nearest = nearest
        self.by_search = by_search


class NotConverged(MetafemError):
    """A solver stopped before its residual reached the tolerance.

    Attributes
    ----------
    state : object or None
        The solver's last state, with its status and residual.
    """

    def __init__(self, message: str, state: Any = None) -> None:
        super().__init__(message)
        self.state = state


class MetafemWarning(UserWarning):
    """Warning that a result lies outside the range in which the model is valid."""


def refuse_missing(package: str, extra: str, purpose: str) -> None:
    """Raise InvalidInput, naming the extra and its purpose, if a package of the extra is not installed."""
    refuse_if(
        find_spec(package) is None, f"{purpose} needs the extra {extra}: pip install 'metafem[{extra}]'"
    )


def spoken(name: str) -> str:
    """Return the name of an argument in words: entries count from 1, as those of a table do.

    Examples
    --------
    >>> spoken("limits.offset"), spoken("radius[3]"), spoken("target.crossover_loads[0][1]")
    ('limits.offset', 'entry 4 of radius', 'entry (1, 2) of target.crossover_loads')
    """
    found = re.fullmatch(r"([^][]+)((?:\[\d+(?:, \d+)*\])+)", name)
    if found is None or found[1] in BY_SITE:
        return name
    places = [str(int(place) + 1) for place in re.findall(r"\d+", found[2])]
    place = places[0] if len(places) == 1 else f"({', '.join(places)})"
    return f"entry {place} of {found[1]}"


def shown(value: Any, most: int = 60) -> str:
    """Return any value as one line of text, for an error message."""
    if isinstance(value, (str, bytes)):
        value = value[: 2 * most]
    try:
        text = repr(value)
    except Exception:  # an object of another library, or an integer with too many digits
        text = f"{'an' if type(value).__name__[0] in 'aeiou' else 'a'} {type(value).__name__}"
    return printable(" ".join(text.split()), most)


def printable(text: str, most: int = 200) -> str:
    """Return text as one line: unprintable characters are escaped, and long texts are cut."""
    cut = text if len(text) <= most else text[: most - 1] + "…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in cut)
