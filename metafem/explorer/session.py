"""The state of a page and its history."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from metafem.errors import InvalidInput

# Largest number of states in the history; each needs a few kilobytes.
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
        Whether the axes are in newtons, where the surface has a friction.
    models : tuple of str
        Names of further models whose laws are plotted with the law of the design.
    load : float or None
        Rescaled load at which the contacts are shown [mm^2]; None for the largest load of the law.
    """

    text: str
    tables: Mapping[str, str] = field(default_factory=dict)
    measured: str = ""
    measured_name: str = ""
    newtons: bool = True
    models: tuple[str, ...] = ()
    load: float | None = None

    def designs_the_same(self, other: State) -> bool:
        """Return whether another state has the same specification and tables, and so the same design."""
        return self.text == other.text and self.tables == other.tables

    def as_shown_in(self, other: State) -> State:
        """Return the state with the display settings of another state, which make no step of the history."""
        settings = {name: getattr(other, name) for name in ("newtons", "models", "load")}
        return replace(self, **settings)

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
        texts: list[Any] = [self.text, self.measured, self.measured_name, *self.models]
        tables = isinstance(self.tables, dict)
        texts += [*self.tables, *self.tables.values()] if tables else []
        number = self.load is None or (isinstance(self.load, float) and 0.0 < self.load < float("inf"))
        return tables and number and isinstance(self.newtons, bool) and all(isinstance(t, str) for t in texts)


def _names(given: Any) -> tuple[Any, ...]:
    return tuple(given) if isinstance(given, (list, tuple)) else (given,)


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
