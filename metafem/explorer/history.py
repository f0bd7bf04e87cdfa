"""The state of a page, its history, and the link that holds a state."""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Any

from metafem.errors import InvalidInput, refuse_if
from metafem.explorer.table import Table, written
from metafem.files import toml_table

# Largest number of states in the history; each needs a few kilobytes.
MOST_STATES = 200


@dataclass(frozen=True)
class State:
    """The complete input of a page.

    Attributes
    ----------
    text : str
        The text of the specification: as the user has typed it or, after an edit, as its table is written.
    tables : mapping of str to str
        Names and texts of the table files that the specification refers to.
    measured, measured_name : str
        Text and name of the table with a measured law; "" without such a table.
    newtons : bool
        Whether the axes are in newtons, where the surface has a friction.
    load : float or None
        Rescaled load at which the contacts are shown [mm^2]; None for the largest load of the law.
    """

    text: str
    tables: Mapping[str, str] = field(default_factory=dict)
    measured: str = ""
    measured_name: str = ""
    newtons: bool = True
    load: float | None = None

    @cached_property
    def table(self) -> Table:
        """The table of the specification; raise InvalidInput if the text is not valid TOML."""
        return toml_table(self.text)

    @property
    def known(self) -> Table:
        """The table of the specification; an empty one if the text is not valid TOML."""
        with suppress(InvalidInput):
            return self.table
        return {}

    def edited(self, table: Table) -> State:
        """Return the state with another table; the same state, with its text, for an equal table."""
        # repr distinguishes 1, 1.0 and true, and nan equals nan
        if repr(table) == repr(self.table):
            return self
        state = replace(self, text=written(table))
        vars(state)["table"] = table
        return state

    def designs_the_same(self, other: State) -> bool:
        """Return whether another state has the same specification and tables, and so the same design."""
        return self.text == other.text and self.tables == other.tables

    def as_shown_in(self, other: State) -> State:
        """Return the state with the display settings of another state, which make no step of the history."""
        settings = {name: getattr(other, name) for name in ("newtons", "load")}
        return replace(self, **settings)

    @classmethod
    def from_json(cls, text: str) -> State:
        """Return the state that a JSON text describes; raise InvalidInput if the text describes no state."""
        try:
            state = cls(**json.loads(text))
        except (ValueError, TypeError, RecursionError):
            raise InvalidInput(
                "the state of the page is damaged: it is not the JSON of its members"
            ) from None
        refuse_if(not state.valid(), "the state of the page is damaged: a member is of another kind")
        return state

    def valid(self) -> bool:
        """Return whether every member has its type and the load is positive and finite."""
        if not isinstance(self.tables, dict):
            return False
        texts: list[Any] = [self.text, self.measured, self.measured_name, *self.tables, *self.tables.values()]
        number = self.load is None or (isinstance(self.load, float) and 0.0 < self.load < float("inf"))
        return number and isinstance(self.newtons, bool) and all(isinstance(each, str) for each in texts)


@dataclass(frozen=True)
class Session:
    """The history of a page: its states in order, and the index `at` of the current state."""

    states: tuple[State, ...]
    at: int = 0

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self.states[self.at]

    def after(self, state: State) -> Session:
        """Return the history with a further state after the current state, and without undone states.

        A state that differs from the current one only in its display settings replaces it.
        """
        if state.as_shown_in(self.state) == self.state:
            return replace(self, states=(*self.states[: self.at], state, *self.states[self.at + 1 :]))
        states = (*self.states[: self.at + 1], state)[-MOST_STATES:]
        return Session(states, len(states) - 1)

    def moved(self, steps: int) -> Session:
        """Return the history at the state so many steps later; the same history without such a state."""
        at = self.at + steps
        return replace(self, at=at) if 0 <= at < len(self.states) else self


# First characters of a link: the version of its format.
VERSION = "1."

# Longest link [characters], because NiceGUI drops messages of a megabyte, and largest state [bytes]. A state
# with a thousand measured points has 40 kB.
LONGEST, LARGEST = 900_000, 2**24


def to_link(state: State) -> str:
    """Return a state as a link of letters, digits, hyphens, underscores and a point; "" if it is too large.

    Examples
    --------
    >>> link = to_link(State("[layout]\\nseed = 3", newtons=False))
    >>> len(link) < 100, from_link(link).newtons
    (True, False)
    """
    usual, record = (asdict(each) for each in (State(""), state))
    record = {name: value for name, value in record.items() if name == "text" or value != usual[name]}
    plain = json.dumps(record, ensure_ascii=False, separators=(",", ":")).encode("utf-8", "surrogatepass")
    link = VERSION + base64.urlsafe_b64encode(zlib.compress(plain, 9)).decode("ascii").rstrip("=")
    return link if len(plain) <= LARGEST and len(link) <= LONGEST else ""


def from_link(link: str) -> State:
    """Return the state that a link contains; the link may begin with a number sign.

    Raises
    ------
    InvalidInput
        If the link is cut off, damaged, of another version or too long.

    Examples
    --------
    >>> from_link("#1.eJyr")
    Traceback (most recent call last):
        ...
    metafem.errors.InvalidInput: the link is cut off or damaged; copy the whole address again
    """
    link = link.strip().removeprefix("#")
    if len(link) > LONGEST:
        raise InvalidInput(f"the link has {len(link):,} characters; at most {LONGEST:,} are read")
    if not link.startswith(VERSION):
        raise InvalidInput("the link is not one of this version of the explorer")
    body, reader, plain = link.removeprefix(VERSION), zlib.decompressobj(), b""
    with suppress(InvalidInput, TypeError, ValueError, zlib.error):
        packed = base64.b64decode(body + "=" * (-len(body) % 4), b"-_", validate=True)
        plain = reader.decompress(packed, LARGEST + 1)
        if len(plain) <= LARGEST and reader.eof and not reader.unused_data:
            return State.from_json(plain.decode("utf-8", "surrogatepass"))
    if len(plain) > LARGEST:
        raise InvalidInput(f"the link holds more than {LARGEST / 2**20:g} MiB")
    raise InvalidInput("the link is cut off or damaged; copy the whole address again")
