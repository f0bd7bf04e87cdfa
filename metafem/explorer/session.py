"""The state of a page and its history, which the browser stores."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from metafem.errors import InvalidInput

# Largest number of states in the history. The browser stores them and allows a few megabytes for each page;
# each state needs a few kilobytes.
MOST_STATES = 200


@dataclass(frozen=True)
class State:
    """The complete input of a page.

    Attributes
    ----------
    text : str
        The text of the specification.
    tables : mapping of str to str
        Names and texts of the table files that the specification refers to.
    measured, measured_name : str
        Text and name of the table with a measured law; "" without such a table.
    newtons : bool
        Whether the axes are in newtons.
    models : tuple of str
        Names of further models whose laws are plotted with the law of the design.
    load : float or None
        Rescaled load at which the contacts are shown [mm^2]; None for the largest load of the law.
    pinned : str
        The state that is pinned as A for comparison, as JSON; "" without one.
    """

    text: str
    tables: Mapping[str, str] = field(default_factory=dict)
    measured: str = ""
    measured_name: str = ""
    newtons: bool = False
    models: tuple[str, ...] = ()
    load: float | None = None
    pinned: str = ""

    def designs_the_same(self, other: State) -> bool:
        """Return whether another state has the same specification and tables, and so the same design."""
        return self.text == other.text and self.tables == other.tables

    def to_json(self) -> str:
        """Return the state as JSON."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> State:
        """Return the state that a JSON text describes; raise InvalidInput if the text describes no state."""
        try:
            record = json.loads(text)
        except (ValueError, RecursionError):
            raise InvalidInput("the state of the page is damaged: it is not JSON") from None
        if not isinstance(record, dict) or not record.keys() <= {member.name for member in fields(cls)}:
            raise InvalidInput("the state of the page is damaged: it has other members")
        found = cls(**{**record, "models": _names(record.get("models", ()))}) if "text" in record else None
        if found is None or not found.valid():
            raise InvalidInput("the state of the page is damaged: a member is of another kind")
        return found

    def valid(self) -> bool:
        """Return whether every member has its type and the load is positive and finite."""
        texts: list[Any] = [self.text, self.measured, self.measured_name, self.pinned, *self.models]
        tables = isinstance(self.tables, dict)
        texts += [*self.tables, *self.tables.values()] if tables else []
        number = self.load is None or (isinstance(self.load, float) and 0.0 < self.load < float("inf"))
        return tables and number and isinstance(self.newtons, bool) and all(isinstance(t, str) for t in texts)


def _names(given: Any) -> tuple[Any, ...]:
    return tuple(given) if isinstance(given, (list, tuple)) else (given,)


class Session:
    """The history of a page: its states in order, and the index `at` of the current state.

    States are numbered from the start of the history; `first` is the number of the oldest state in the list.
    """

    def __init__(self, *states: State, at: int = 0, first: int = 0) -> None:
        self.states, self.at, self.first = list(states), at, first

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self.states[self.at]

    def commit(self, state: State) -> None:
        """Add a state after the current state, and drop the states that were undone."""
        if state == self.state:
            return
        states = [*self.states[: self.at + 1], state]
        self.first += max(0, len(states) - MOST_STATES)
        self.states = states[-MOST_STATES:]
        self.at = len(self.states) - 1

    def replace(self, state: State) -> None:
        """Replace the current state by a state that differs only in members that undo ignores."""
        self.states[self.at] = state

    def undo(self) -> bool:
        """Go back to the previous state; return whether there is a previous state."""
        return self._move(-1)

    def redo(self) -> bool:
        """Go forward to the state that was undone last; return whether there is such a state."""
        return self._move(1)

    def _move(self, step: int) -> bool:
        if not 0 <= self.at + step < len(self.states):
            return False
        self.at += step
        return True

    @classmethod
    def restored(cls, record: Any) -> Session | None:
        """Return the stored history, or None if none is stored; raise InvalidInput if it is damaged."""
        if not isinstance(record, dict) or not record.get("states"):
            return None
        states, first, at = record["states"], record.get("first"), record.get("at")
        if not (isinstance(states, list) and isinstance(first, int) and isinstance(at, int)):
            raise InvalidInput("the history that the browser kept is damaged; the page begins anew")
        if not 0 <= at - first < len(states) <= MOST_STATES:
            raise InvalidInput("the history that the browser kept is damaged; the page begins anew")
        return cls(*(State.from_json(str(state)) for state in states), at=at - first, first=first)
